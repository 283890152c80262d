// The prediction of a new vertex from its star, in integers: the middle of its neighbours, moved into their mean plane
// along the axis closest to its normal once the other two coordinates are known; texture coordinates by the linear map
// that fits the star best. All of it is moved by a share of the way from the two neighbours beside the parent to the
// parent, from which the new vertex is mostly less far than from others: the shares are those that leave the least of
// the armadillo, the dragon and a statue. All of it is exact in double, so that every reader predicts the same.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/mesh/attributes.h"
#include "core/progressive/mesh/split_mesh.h"

namespace lodestone::progressive {

// The values of vertices as integers, by group or by wedge; empty if the mesh has none.
struct LatticeValues {
  std::vector<std::array<std::int32_t, 3>> positions;
  std::vector<std::uint16_t> errors;  // the upper half of a float, rounded up
  std::vector<std::array<std::int32_t, 2>> uv;
  std::vector<Rgba8> colours;
  std::vector<std::uint32_t> materials;  // index, or no_material
};

// A star before its vertex has a position: sums over its neighbours.
struct StarFit {
  std::array<std::size_t, 3> axis{};  // two along the surface, then the one closest to its normal
  std::array<double, 3> middle{}, normal{};
  std::array<double, 3> bend{};            // from the mean of the parent's two neighbours to it; of closed stars
  std::array<std::int32_t, 3> position{};  // of the vertex, once it is known
  std::uint32_t scale = 0;                 // bits of the largest distance of a neighbour from the first one
};

[[nodiscard]] inline StarFit fit_star(const SplitMesh::Star& star,
                                      const std::vector<std::array<std::int32_t, 3>>& positions) {
  StarFit f;
  const auto at = [&](std::size_t k) -> const std::array<std::int32_t, 3>& { return positions[star.spokes[k].vertex]; };
  const std::size_t n = star.spokes.size();
  std::int32_t far = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t m = (k + 1) % n;
    double d[3], e[3];
    for (std::size_t i = 0; i < 3; ++i) {
      f.middle[i] += at(k)[i];
      d[i] = at(k)[i] - at(0)[i];
      e[i] = at(m)[i] - at(0)[i];
      far = std::max(far, std::abs(at(k)[i] - at(0)[i]));
    }
    for (std::size_t i = 0; i < 3; ++i)
      f.normal[i] += d[(i + 1) % 3] * e[(i + 2) % 3] - d[(i + 2) % 3] * e[(i + 1) % 3];
  }
  for (double& x : f.middle) x /= static_cast<double>(n);
  if (!star.open)
    for (std::size_t i = 0; i < 3; ++i) f.bend[i] = at(0)[i] - 0.5 * (at(1)[i] + at(n - 1)[i]);
  const auto size = [&](std::size_t i) { return std::abs(f.normal[i]); };
  f.axis[2] = size(0) >= size(1) && size(0) >= size(2) ? 0 : size(1) >= size(2) ? 1 : 2;
  f.axis[0] = (f.axis[2] + 1) % 3;
  f.axis[1] = (f.axis[2] + 2) % 3;
  while (far >> f.scale != 0) ++f.scale;
  return f;
}

// A corner of a neighbour in a sector of the new vertex.
struct StarCorner {
  std::uint32_t vertex, wedge;
};

// whole: the corners are those of all sectors, beginning with the parent's.
enum class StarCover : std::uint8_t { part, whole };

// By the linear map from the two coordinates along the surface to the texture that fits the corners best (least
// squares); the coordinates of the parent's wedge if there are no corners.
[[nodiscard]] inline std::array<double, 2> guess_uv(const StarFit& f, const std::vector<StarCorner>& corners,
                                                    const LatticeValues& values, std::uint32_t parent,
                                                    StarCover cover) {
  if (corners.empty()) return {double(values.uv[parent][0]), double(values.uv[parent][1])};
  const double n = static_cast<double>(corners.size());
  double mx = 0, my = 0, mu = 0, mv = 0;
  for (const StarCorner& c : corners) {
    mx += values.positions[c.vertex][f.axis[0]], my += values.positions[c.vertex][f.axis[1]];
    mu += values.uv[c.wedge][0], mv += values.uv[c.wedge][1];
  }
  mx /= n, my /= n, mu /= n, mv /= n;
  double xx = 0, xy = 0, yy = 0, xu = 0, yu = 0, xv = 0, yv = 0;
  for (const StarCorner& c : corners) {
    const double x = values.positions[c.vertex][f.axis[0]] - mx, y = values.positions[c.vertex][f.axis[1]] - my;
    const double u = values.uv[c.wedge][0] - mu, v = values.uv[c.wedge][1] - mv;
    xx += x * x, xy += x * y, yy += y * y, xu += x * u, yu += y * u, xv += x * v, yv += y * v;
  }
  const double det = xx * yy - xy * xy;
  if (!(det > 1e-3 * (xx * yy))) return {mu, mv};
  // The vertex deviates from the fit by about half as much as the way to the parent does.
  double x = f.position[f.axis[0]] - mx, y = f.position[f.axis[1]] - my;
  if (cover == StarCover::whole) {
    const auto way = [&](std::size_t i) {
      const auto uv = [&](std::size_t k) { return values.uv[corners[k].wedge][i]; };
      return 0.5 * (uv(0) - 0.5 * (uv(1) + uv(corners.size() - 2)));
    };
    mu += way(0), mv += way(1);
    x -= 0.5 * f.bend[f.axis[0]], y -= 0.5 * f.bend[f.axis[1]];
  }
  return {mu + (x * (xu * yy - yu * xy) + y * (yu * xx - xu * xy)) / det,
          mv + (x * (xv * yy - yv * xy) + y * (yv * xx - xv * xy)) / det};
}

}  // namespace lodestone::progressive
