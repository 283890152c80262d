#include "render/reconstruct/choose_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/position_map/rasterize_map.h"
#include "render/position_map/resolve_pixel.h"

namespace lodestone {
namespace {

struct SurfacePoint {
  Vec3d point;
  Vec3f normal;
  std::uint32_t triangle = 0;
};

// Spread over the area: every sample stands for the same share of it.
std::vector<SurfacePoint> sample_surface(const IndexedMesh& mesh, std::uint64_t count) {
  std::vector<double> up_to;
  up_to.reserve(mesh.triangles.size());
  double area = 0;
  const auto corner = [&](const Triangle& t, std::size_t k) { return to_double(mesh.positions[t.v[k]]); };
  for (const Triangle& t : mesh.triangles) {
    area += length(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
    up_to.push_back(area);
  }
  std::vector<SurfacePoint> points;
  if (!(area > 0)) return points;
  for (std::uint64_t k = 0; k < count; ++k) {
    const double wanted = (static_cast<double>(k) + 0.5) / static_cast<double>(count) * area;
    const auto t = static_cast<std::size_t>(std::upper_bound(up_to.begin(), up_to.end(), wanted) - up_to.begin());
    if (t == mesh.triangles.size()) break;
    // A point of the R2 sequence, folded into the triangle.
    double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(k), 1.0),
           v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(k), 1.0);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Triangle& triangle = mesh.triangles[t];
    const Vec3d a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
    points.push_back({a + u * (b - a) + v * (c - a), unit_normal_of(a, b, c), static_cast<std::uint32_t>(t)});
  }
  return points;
}

// How well a map sees a point: the cosine between surface and view; 0 when it does not.
float cosine_in(const PositionMap& map, const SurfacePoint& sample) {
  const WindowPoint w = project(map.view, sample.point);
  if (!(w.x >= 0) || !(w.y >= 0) || !(w.x < map.view.width) || !(w.y < map.view.height)) return 0;
  const std::size_t i =
      static_cast<std::size_t>(w.y) * static_cast<std::size_t>(map.view.width) + static_cast<std::size_t>(w.x);
  if (!map.sees(i)) return 0;
  const auto cosine = static_cast<float>(std::abs(dot(to_double(sample.normal), map.view.forward)));
  const double behind = w.depth - double{map.depth[i]};
  const bool seen = map.triangle[i] == sample.triangle || behind * std::max(double{cosine}, 0.1) < 0.7 * map.view.pixel;
  return seen ? cosine : 0;
}

using Cosines = std::vector<float>;  // one per sample

std::vector<Cosines> look(const IndexedMesh& mesh, const std::vector<SurfacePoint>& samples,
                          const std::vector<Vec3d>& directions, int resolution, Scheduler& scheduler) {
  Box3f box;
  for (const Vec3f& p : mesh.positions) box.extend(p);
  std::vector<Cosines> seen(directions.size());
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const PositionMap map =
        rasterize_map(mesh, orthographic_view(box, directions[k], 1.0 / resolution), {.surface = false}, scheduler);
    seen[k].resize(samples.size());
    scheduler.for_chunks(samples.size(), 4096, [&](ChunkRange range) {
      for (std::size_t s = range.begin; s < range.end; ++s) seen[k][s] = cosine_in(map, samples[s]);
    });
  }
  return seen;
}

}  // namespace

std::vector<Vec3d> face_directions() { return {{0, 0, -1}, {0, 0, 1}, {0, -1, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0}}; }

std::vector<Vec3d> sphere_directions(int count) {
  std::vector<Vec3d> directions;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int k = 0; k < count; ++k) {
    const double z = 1 - (2 * k + 1.0) / count, r = std::sqrt(1 - z * z);
    directions.push_back({r * std::cos(golden * k), r * std::sin(golden * k), z});
  }
  return directions;
}

ChosenViews choose_views(const IndexedMesh& mesh, const ViewChoice& choice, Scheduler& scheduler) {
  std::vector<Vec3d> directions = face_directions();
  for (const Vec3d& d : sphere_directions(choice.candidates)) directions.push_back(d);
  const std::vector<SurfacePoint> samples = sample_surface(mesh, choice.samples);
  const std::vector<Cosines> seen = look(mesh, samples, directions, choice.resolution, scheduler);

  const double whole = std::max<double>(1, static_cast<double>(samples.size()));
  ChosenViews chosen;
  std::size_t visible = 0, coverable = 0;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    float best = 0;
    for (const Cosines& c : seen) best = std::max(best, c[s]);
    if (best > 0) chosen.visible_points.push_back(samples[s].point);
    visible += best > 0, coverable += best >= choice.least_cosine;
  }

  std::vector<std::uint8_t> covered(samples.size(), 0), taken(directions.size(), 0);
  std::size_t count = 0;
  const auto take = [&](std::size_t k) {
    taken[k] = 1;
    chosen.directions.push_back(directions[k]);
    for (std::size_t s = 0; s < samples.size(); ++s)
      if (!covered[s] && seen[k][s] >= choice.least_cosine) covered[s] = 1, ++count;
  };
  if (choice.least >= 6)
    for (std::size_t k = 0; k < 6; ++k) take(k);
  while (static_cast<int>(chosen.directions.size()) < choice.most &&
         (static_cast<int>(chosen.directions.size()) < choice.least ||
          static_cast<double>(count) < choice.coverage * static_cast<double>(coverable))) {
    std::vector<std::size_t> gain(directions.size(), 0);
    scheduler.for_chunks(directions.size(), 4, [&](ChunkRange range) {
      for (std::size_t k = range.begin; k < range.end; ++k)
        for (std::size_t s = 0; s < samples.size() && !taken[k]; ++s)
          gain[k] += !covered[s] && seen[k][s] >= choice.least_cosine;
    });
    std::size_t best = directions.size(), most = 0;
    for (std::size_t k = 0; k < directions.size(); ++k)
      if (gain[k] > most) most = gain[k], best = k;
    if (best == directions.size() || (static_cast<double>(most) < choice.least_gain * whole &&
                                      static_cast<int>(chosen.directions.size()) >= choice.least))
      break;
    take(best);
  }
  chosen.visible = static_cast<double>(visible) / whole;
  chosen.coverable = static_cast<double>(coverable) / whole;
  chosen.covered = static_cast<double>(count) / whole;
  return chosen;
}

}  // namespace lodestone
