#include "core/mesh/solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <random>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/mesh/clean.h"

namespace lodestone {
namespace {

using FourCorners = std::array<std::uint32_t, 4>;

// The surface of the part of the unit cube where a field is below 0: each of n^3 cubes is six tetrahedra.
class MarchingTetrahedra {
 public:
  MarchingTetrahedra(std::uint32_t n, const std::function<double(Vec3d)>& field) : n_(n) {
    values_.resize((n + 1) * (n + 1) * (n + 1));
    for (std::uint32_t i = 0; i < values_.size(); ++i) values_[i] = field((1.0 / n) * point(i));
    for (std::uint32_t z = 0; z < n; ++z)
      for (std::uint32_t y = 0; y < n; ++y)
        for (std::uint32_t x = 0; x < n; ++x) add_cube(x + (n + 1) * (y + (n + 1) * z));
  }

  [[nodiscard]] IndexedMesh mesh() const {
    Repairs repairs;
    return clean_mesh(raw_, repairs);
  }

 private:
  [[nodiscard]] Vec3d point(std::uint32_t i) const {
    const std::uint32_t side = n_ + 1;
    return {double(i % side), double(i / side % side), double(i / side / side)};
  }

  // All around the diagonal from corner `first`, and all of one orientation.
  void add_cube(std::uint32_t first) {
    constexpr std::array<std::array<std::uint32_t, 3>, 6> orders{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}}};  // three even, three odd ones
    const std::array<std::uint32_t, 3> steps{1, n_ + 1, (n_ + 1) * (n_ + 1)};
    for (std::size_t order = 0; order < 6; ++order) {
      FourCorners corners{first};
      for (std::size_t k = 0; k < 3; ++k) corners[k + 1] = corners[k] + steps[orders[order][k]];
      if (order >= 3) std::swap(corners[2], corners[3]);
      add_tetrahedron(corners);
    }
  }

  void add_tetrahedron(FourCorners c) {
    // Those inside come first, by an even number of swaps.
    bool odd = false;
    for (int round = 0; round < 3; ++round)
      for (std::size_t k = 0; k < 3; ++k)
        if (values_[c[k]] >= 0 && values_[c[k + 1]] < 0) std::swap(c[k], c[k + 1]), odd = !odd;
    const auto inside = std::count_if(c.begin(), c.end(), [&](std::uint32_t i) { return values_[i] < 0; });
    if (odd) inside > 1 ? std::swap(c[0], c[1]) : std::swap(c[2], c[3]);
    const auto cut = [&](std::size_t a, std::size_t b) { return crossing(c[a], c[b]); };
    std::vector<Triangle>& triangles = raw_.triangles;
    if (inside == 1) triangles.push_back({{cut(0, 1), cut(0, 2), cut(0, 3)}});
    if (inside == 3) triangles.push_back({{cut(0, 3), cut(1, 3), cut(2, 3)}});
    if (inside != 2) return;
    triangles.push_back({{cut(0, 2), cut(0, 3), cut(1, 3)}});
    triangles.push_back({{cut(0, 2), cut(1, 3), cut(1, 2)}});
  }

  // The vertex between two corners, away from both.
  std::uint32_t crossing(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax(a, b);
    const auto next = static_cast<std::uint32_t>(raw_.positions.size());
    const auto [at, is_new] = crossings_.try_emplace(std::uint64_t{low} << 32 | high, next);
    if (is_new) {
      const double share = std::clamp(values_[low] / (values_[low] - values_[high]), 0.1, 0.9);
      raw_.positions.push_back(point(low) + share * (point(high) - point(low)));
    }
    return at->second;
  }

  std::uint32_t n_;
  std::vector<double> values_;
  RawMesh raw_;
  std::unordered_map<std::uint64_t, std::uint32_t> crossings_;
};

// A smooth random field of about [-1, 1]: waves in all directions.
class Waves {
 public:
  explicit Waves(double frequency) {
    std::mt19937 random;
    const auto number = [&] { return 2 * (double(random()) / 4294967295.0) - 1; };
    for (Wave& wave : waves_) {
      do wave.direction = {number(), number(), number()};
      while (length(wave.direction) < 0.1 || length(wave.direction) > 1);
      wave.direction = (6.283185307179586 * frequency / length(wave.direction)) * wave.direction;
      wave.phase = 3 * number();
    }
  }
  double operator()(Vec3d p) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(dot(wave.direction, p) + wave.phase);
    return sum / std::sqrt(double(waves_.size()));
  }

 private:
  struct Wave {
    Vec3d direction;
    double phase = 0;
  };
  std::array<Wave, 24> waves_;
};

}  // namespace

IndexedMesh five_rings(std::uint32_t n) {
  const Waves bumps(25);
  const auto field = [&](Vec3d p) {
    double nearest = 1;
    for (const auto& [x, y] : {std::pair(0.5, 0.5), {0.3, 0.3}, {0.3, 0.7}, {0.7, 0.3}, {0.7, 0.7}})
      nearest = std::min(nearest, std::hypot(std::hypot(p.x - x, p.y - y) - 0.17, p.z - 0.5));
    return nearest - 0.09 - 0.005 * bumps(p);
  };
  return MarchingTetrahedra(n, field).mesh();
}

IndexedMesh truss(std::uint32_t n, std::uint32_t k) {
  const Waves bumps(7);
  const auto in_cells = [k](double x) { return (x - 0.2) / 0.6 * k; };
  // From the nearest beam, and from the nearest point within the frame.
  const auto off = [&](double x) { return in_cells(x) - std::clamp(std::round(in_cells(x)), 0.0, double(k)); };
  const auto beyond = [&](double x) { return in_cells(x) - std::clamp(in_cells(x), 0.0, double(k)); };
  const auto field = [&](Vec3d p) {
    const Vec3d o{off(p.x), off(p.y), off(p.z)};
    const double nearest = std::min({length(Vec3d{o.x, o.y, beyond(p.z)}), length(Vec3d{beyond(p.x), o.y, o.z}),
                                     length(Vec3d{o.x, beyond(p.y), o.z})});
    return nearest - 0.17 - 0.01 * bumps(p);
  };
  return MarchingTetrahedra(n, field).mesh();
}

IndexedMesh foam(std::uint32_t n, const FoamConfig& config) {
  const Waves matter(config.frequency);
  const auto field = [&](Vec3d p) {
    const double outside = length(p - Vec3d{0.5, 0.5, 0.5}) - 0.47;
    return std::max(matter(p) - config.level, 3 * config.frequency * outside);
  };
  return MarchingTetrahedra(n, field).mesh();
}

}  // namespace lodestone
