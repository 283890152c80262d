#include "experiments/studies/flight_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "experiments/metrics/pictures/flip.h"
#include "experiments/metrics/pictures/heat_map.h"
#include "experiments/studies/film.h"

namespace lodestone {
namespace {

constexpr std::size_t most_in_strip = 8;
constexpr int film_milliseconds = 125;  // a picture: eight a second

ImageSize small_size(ImageSize size) {
  const double share = std::min(1.0, double{FlightPictures::small_width} / size.width);
  return {std::max(1, static_cast<int>(std::lround(share * size.width))),
          std::max(1, static_cast<int>(std::lround(share * size.height)))};
}

// One after the other in time, at equal distances, the first and the last among them.
std::vector<ErrorMap> chosen(std::span<const ErrorMap> maps) {
  const std::size_t count = std::min(maps.size(), most_in_strip);
  std::vector<ErrorMap> some;
  for (std::size_t k = 0; k < count; ++k) some.push_back(maps[k * (maps.size() - 1) / (count - 1)]);
  return some;
}

// Side by side, from left to right.
ErrorMap strip(std::span<const ErrorMap> maps) {
  const ImageSize size = maps.front().size;
  ErrorMap joined{{size.width * static_cast<int>(maps.size()), size.height}, {}};
  for (std::ptrdiff_t y = 0; y < size.height; ++y)
    for (const ErrorMap& map : maps) {
      const auto row = map.value.begin() + y * size.width;
      joined.value.insert(joined.value.end(), row, row + size.width);
    }
  return joined;
}

}  // namespace

void FlightPictures::offer(const Image& picture, const Image& full, double flip) {
  const ImageSize size = small_size(picture.size);
  small_.push_back(downscale(picture, size));
  differences_.push_back(absolute_error(downscale(full, size), small_.back()));
  if (flip <= worst_flip_) return;
  worst_flip_ = flip, worst_ = picture, worst_full_ = full;
}

void FlightPictures::write(const std::string& directory, Scheduler& scheduler) const {
  if (small_.empty()) return;
  write_png(directory + "/worst-drawn.png", worst_);
  write_png(directory + "/worst-full.png", worst_full_);
  write_png(directory + "/worst-flip.png", heat_map(flip_error(worst_full_, worst_, scheduler)));
  if (small_.size() < 2) return;
  const double top = heat_map_top(strip(differences_));
  write_png(directory + "/differences.png", heat_map(strip(chosen(differences_)), top));
  const ContactSheetConfig beside{.columns = 2, .width = 2 * small_.front().size.width, .gap = 0};
  std::vector<Image> film;
  for (std::size_t i = 0; i < small_.size(); ++i)
    film.push_back(contact_sheet(std::array{small_[i], heat_colours(differences_[i], top)}, beside));
  write_film(directory + "/flight.webp", film, film_milliseconds);
}

}  // namespace lodestone
