#include "render/camera/placement.h"

#include <cmath>
#include <numbers>

namespace lodestone {
namespace {

using Rotation = std::array<Vec3d, 3>;

Rotation product(const Rotation& a, const Rotation& b) {
  Rotation c;
  for (std::size_t row = 0; row < 3; ++row) c[row] = a[row].x * b[0] + (a[row].y * b[1] + a[row].z * b[2]);
  return c;
}

// Sine and cosine; exact at multiples of a right angle, so that boxes remain boxes.
struct Turn {
  double sine, cosine;
  explicit Turn(double degrees) {
    const double quarters = degrees / 90, whole = std::round(quarters);
    const double rest = (quarters - whole) * std::numbers::pi / 2;
    const double s = std::sin(rest), c = std::cos(rest);
    switch (static_cast<int>(std::fmod(std::fmod(whole, 4) + 4, 4))) {
      case 0:
        sine = s, cosine = c;
        break;
      case 1:
        sine = c, cosine = -s;
        break;
      case 2:
        sine = -s, cosine = -c;
        break;
      default:
        sine = -c, cosine = s;
    }
  }
};

}  // namespace

Similarity operator*(const Similarity& outer, const Similarity& inner) {
  return {product(outer.rotation, inner.rotation), outer.scale * inner.scale, outer(inner.translation)};
}

std::array<Vec3d, 3> rotation_about_axes(Vec3d degrees) {
  const Turn x(degrees.x), y(degrees.y), z(degrees.z);
  const Rotation about_x{{{1, 0, 0}, {0, x.cosine, -x.sine}, {0, x.sine, x.cosine}}};
  const Rotation about_y{{{y.cosine, 0, y.sine}, {0, 1, 0}, {-y.sine, 0, y.cosine}}};
  const Rotation about_z{{{z.cosine, -z.sine, 0}, {z.sine, z.cosine, 0}, {0, 0, 1}}};
  return product(about_z, product(about_y, about_x));
}

}  // namespace lodestone
