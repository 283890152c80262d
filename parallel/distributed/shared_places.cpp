#include "parallel/distributed/shared_places.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "parallel/distributed/messages/slices.h"

namespace lodestone {
namespace {

// A sphere in the unit cube has vertices in a quarter of as many cells as there are places.
constexpr double places_in_square = 20;
constexpr std::uint64_t most_places = std::uint64_t{1} << 26;

}  // namespace

SharedPlaces::SharedPlaces(std::span<const Vec3f> positions, std::span<const VertexState> states,
                           std::uint64_t all_vertices, Ranks& ranks)
    : places_(std::clamp<std::uint64_t>(all_vertices, 1, most_places)),
      side_(static_cast<float>(std::sqrt(static_cast<double>(places_) / places_in_square))) {
  if (ranks.count() == 1) return;
  BitSet own(places_);
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (states[i] == VertexState::used) own.set(place(positions[i]));
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t p = 0; p < places_; ++p)
    if (own[p]) numbers.push_back(p);
  const std::vector<std::uint8_t> others = asked_by_others(Slices(places_, ranks.count()), numbers, ranks);
  shared_.emplace(places_);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (others[i]) shared_->set(numbers[i]);
}

std::uint64_t SharedPlaces::place(const Vec3f& p) const {
  const Vec3f cell{std::floor(p.x * side_), std::floor(p.y * side_), std::floor(p.z * side_)};
  return ((hash_of(cell) >> 32) * places_) >> 32;
}

}  // namespace lodestone
