#include "core/spherical/octahedron/rough_square.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace lodestone::spherical {
namespace {

// The inverse of the map in an octant, between points of a grid over the shares of a direction's components.
class RoughSquare {
 public:
  RoughSquare() {
    for (std::size_t j = 0; j <= cells; ++j)
      for (std::size_t i = 0; i <= cells; ++i) {
        // Beyond the octant, a continuation by its mirror image, as a cell on the border has one corner there.
        const double x = static_cast<double>(i) / cells, y = static_cast<double>(j) / cells;
        const bool beyond = x + y > 1;
        const Vec3d d = beyond ? Vec3d{1 - y, 1 - x, x + y - 1} : Vec3d{x, y, 1 - (x + y)};
        const SquarePoint p = square_point(d, {1, 1, 1});
        const double u = 2 * p.s - 1, v = 1 - 2 * p.t;
        grid_[j * row + i] = beyond ? SquarePoint{1 - v, 1 - u} : SquarePoint{u, v};
      }
  }
  [[nodiscard]] SquarePoint operator()(Vec3d d, const Octant& octant) const {
    const double scale = cells / ((std::abs(d.x) + std::abs(d.y)) + std::abs(d.z));
    const double x = scale * std::abs(d.x), y = scale * std::abs(d.y);
    const auto i = std::min(static_cast<std::size_t>(x), cells - 1),
               j = std::min(static_cast<std::size_t>(y), cells - 1);
    const SquarePoint *const upper = &grid_[j * row + i], *const lower = upper + row;
    const double across = x - static_cast<double>(i), down = y - static_cast<double>(j);
    const auto between = [&](double SquarePoint::*c) {
      const double a = upper[0].*c + across * (upper[1].*c - upper[0].*c);
      return a + down * (lower[0].*c + across * (lower[1].*c - lower[0].*c) - a);
    };
    double u = between(&SquarePoint::s), v = between(&SquarePoint::t);
    if (octant.z < 0) {
      const double reflected = 1 - v;
      v = 1 - u, u = reflected;
    }
    return {0.5 + octant.x * (0.5 * u), 0.5 - octant.y * (0.5 * v)};
  }

 private:
  static constexpr std::size_t cells = 32, row = cells + 1;
  std::array<SquarePoint, row * row> grid_;
};

}  // namespace

SquarePoint rough_square_point(Vec3d d, const Octant& octant) {
  static const RoughSquare square;
  return square(d, octant);
}

}  // namespace lodestone::spherical
