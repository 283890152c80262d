#include "render/camera/eye.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodestone {
namespace {

using Row = std::array<double, 4>;

Row row_of(const ViewProjection& vp, std::size_t r) {
  return {vp.m[4 * r], vp.m[4 * r + 1], vp.m[4 * r + 2], vp.m[4 * r + 3]};
}

double dot(const Row& a, const Row& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

// Orthogonal to all three.
Row cross(const Row& a, const Row& b, const Row& c) {
  Row out;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t i = (k + 1) % 4, j = (k + 2) % 4, l = (k + 3) % 4;
    const double minor =
        a[i] * (b[j] * c[l] - b[l] * c[j]) - a[j] * (b[i] * c[l] - b[l] * c[i]) + a[l] * (b[i] * c[j] - b[j] * c[i]);
    out[k] = k % 2 == 0 ? minor : -minor;
  }
  return out;
}

}  // namespace

// All rays through the eye project to a point each: x, y and w of the eye are 0. Its z tells the two sides of an eye
// that is infinitely far away apart: less is nearer.
Eye eye_of(const ViewProjection& projection) {
  Row e = cross(row_of(projection, 0), row_of(projection, 1), row_of(projection, 3));
  double scale = std::max({std::abs(e[0]), std::abs(e[1]), std::abs(e[2]), std::abs(e[3])});
  if (!(scale > 0) || !std::isfinite(scale)) return {};
  if (dot(row_of(projection, 2), e) > 0) scale = -scale;
  // Farther away than this it might as well be infinitely far.
  constexpr double least_w = 1e-9;
  if (std::abs(e[3] / scale) > least_w) scale = e[3];
  const auto part = [&](std::size_t k) { return static_cast<float>(e[k] / scale); };
  return {{part(0), part(1), part(2)}, scale == e[3] ? 1.0f : 0.0f};
}

}  // namespace lodestone
