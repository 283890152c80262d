#include "render/camera/projection.h"

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

Plane normalised_plane(double a, double b, double c, double d) {
  const double norm = std::sqrt(a * a + b * b + c * c);
  if (!(norm > 0)) return {{0, 0, 0}, 1};  // a degenerate matrix culls nothing
  // Widened by more than the rounding of a float evaluation in and around the unit cube: culling remains conservative.
  const double widened = d / norm + 2e-6 * (1 + std::abs(d / norm));
  return {to_float(Vec3d{a / norm, b / norm, c / norm}), static_cast<float>(widened)};
}

}  // namespace

// Clip space is -w <= x, y, z <= w: each plane is a sum or difference of the last row and another (Gribb and Hartmann
// 2001).
Frustum frustum_of(const ViewProjection& vp) {
  Frustum planes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t side = 0; side < 2; ++side) {
      const double sign = side == 0 ? 1 : -1;
      std::array<double, 4> sum{};
      for (std::size_t k = 0; k < 4; ++k) sum[k] = double{vp.m[12 + k]} + sign * double{vp.m[4 * axis + k]};
      planes[2 * axis + side] = normalised_plane(sum[0], sum[1], sum[2], sum[3]);
    }
  }
  return planes;
}

int side_of(const Plane& plane, const Box3f& box) {
  const auto corner = [&](bool farthest) {
    const auto pick = [farthest](float n, float lo, float hi) { return (n > 0) == farthest ? hi : lo; };
    return Vec3f{pick(plane.n.x, box.lo.x, box.hi.x), pick(plane.n.y, box.lo.y, box.hi.y),
                 pick(plane.n.z, box.lo.z, box.hi.z)};
  };
  if (distance_from(plane, corner(true)) < 0) return -1;
  return distance_from(plane, corner(false)) > 0 ? 1 : 0;
}

// Projections of coplanar points are coplanar: z = a x + b y + c w for one point of the plane and for two directions in
// it, which are points infinitely far away.
std::optional<DepthOfPlane> depth_of_plane(const ViewProjection& vp, const Plane& plane, ImageSize size) {
  const Vec3d n = to_double(plane.n);
  const double norm2 = dot(n, n);
  if (!(norm2 > 0)) return {};
  const Vec3d foot = (-plane.d / norm2) * n;
  const Vec3d aside = std::abs(n.x) < std::abs(n.y) ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = cross(n, aside), v = cross(n, u);
  const std::array<Row, 3> points{{{foot.x, foot.y, foot.z, 1}, {u.x, u.y, u.z, 0}, {v.x, v.y, v.z, 0}}};
  std::array<Vec3d, 3> sides;  // x, y and w of each
  std::array<double, 3> z{};
  for (std::size_t k = 0; k < 3; ++k) {
    sides[k] = {dot(row_of(vp, 0), points[k]), dot(row_of(vp, 1), points[k]), dot(row_of(vp, 3), points[k])};
    z[k] = dot(row_of(vp, 2), points[k]);
  }
  const Vec3d bc = cross(sides[1], sides[2]), ca = cross(sides[2], sides[0]), ab = cross(sides[0], sides[1]);
  const double determinant = dot(sides[0], bc);
  const Vec3d of_clip = (1 / determinant) * (z[0] * bc + z[1] * ca + z[2] * ab);
  if (!is_finite(of_clip)) return {};
  return DepthOfPlane{of_clip.x / size.width, -of_clip.y / size.height,
                      0.5 + 0.5 * (of_clip.y - of_clip.x + of_clip.z)};
}

bool is_outside(const Frustum& frustum, const Box3f& box, float margin) {
  for (const Plane& plane : frustum) {
    // The corner farthest along the plane's normal.
    const Vec3f corner{plane.n.x >= 0 ? box.hi.x + margin : box.lo.x - margin,
                       plane.n.y >= 0 ? box.hi.y + margin : box.lo.y - margin,
                       plane.n.z >= 0 ? box.hi.z + margin : box.lo.z - margin};
    if (dot(plane.n, corner) + plane.d < 0) return true;
  }
  return false;
}

// Each ray through the eye projects to a point: x, y and w of the eye are 0. Its z tells the two sides of an eye at
// infinity apart: smaller is nearer.
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
