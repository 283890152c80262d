// The shell of what can be seen from outside: closed, manifold, near the visible surface, whatever the parts do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/spatial/mesh_distance.h"
#include "experiments/metrics/geometry/mesh_quality.h"
#include "experiments/metrics/geometry/surface_coverage.h"
#include "render/reconstruct/outside/shell.h"
#include "render/reconstruct/outside/shell_grid.h"
#include "render/reconstruct/reconstruct.h"
#include "render/reconstruct/views/choose_views.h"
#include "tests/render/reconstruct/obvious_map.h"

namespace lodestone::test {
namespace {

ReconstructConfig shell_config(double resolution) {
  ReconstructConfig config;
  config.merge = MergeKind::shell;
  config.resolution = resolution;
  return config;
}

struct TiltedBox {
  Vec3d centre, half, axes[3];
};

// Boxes at random in a ball, so large that they overlap.
std::vector<TiltedBox> tilted_boxes(int count, double side) {
  std::mt19937 random(5);
  const auto uniform = [&](double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(random()) / 4294967296.0;
  };
  std::vector<TiltedBox> boxes;
  while (static_cast<int>(boxes.size()) < count) {
    TiltedBox box;
    box.centre = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    if (length(box.centre) > 1) continue;
    box.half = {uniform(0.4, 1) * side, uniform(0.4, 1) * side, uniform(0.4, 1) * side};
    Vec3d x{uniform(-1, 1), uniform(-1, 1), 1.5}, y{1.5, uniform(-1, 1), uniform(-1, 1)};
    x = (1 / length(x)) * x;
    y = y - dot(x, y) * x;
    y = (1 / length(y)) * y;
    box.axes[0] = x, box.axes[1] = y, box.axes[2] = cross(x, y);
    boxes.push_back(box);
  }
  return boxes;
}

IndexedMesh mesh_of(const std::vector<TiltedBox>& boxes) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  for (const TiltedBox& box : boxes) {
    const std::size_t first = positions.size();
    add_box({-1, -1, -1}, {1, 1, 1}, 1, positions, triangles);
    for (std::size_t v = first; v < positions.size(); ++v) {
      const Vec3d p = positions[v];
      positions[v] = box.centre + (p.x * box.half.x) * box.axes[0] + (p.y * box.half.y) * box.axes[1] +
                     (p.z * box.half.z) * box.axes[2];
    }
  }
  return clean(positions, triangles);
}

// Depth of a point inside a box; negative outside.
double depth_in(const TiltedBox& box, Vec3d p) {
  const Vec3d d = p - box.centre;
  return std::min({box.half.x - std::abs(dot(d, box.axes[0])), box.half.y - std::abs(dot(d, box.axes[1])),
                   box.half.z - std::abs(dot(d, box.axes[2]))});
}

double distance_from(const TiltedBox& box, Vec3d p) {
  const Vec3d d = p - box.centre;
  const auto beyond = [&](double half, Vec3d axis) { return std::max(std::abs(dot(d, axis)) - half, 0.0); };
  return length(
      Vec3d{beyond(box.half.x, box.axes[0]), beyond(box.half.y, box.axes[1]), beyond(box.half.z, box.axes[2])});
}

Vec3d outward_normal(const TiltedBox& box, Vec3d p) {
  const Vec3d d = p - box.centre;
  const double below[] = {box.half.x - std::abs(dot(d, box.axes[0])), box.half.y - std::abs(dot(d, box.axes[1])),
                          box.half.z - std::abs(dot(d, box.axes[2]))};
  const Vec3d axis = box.axes[std::min_element(below, below + 3) - below];
  return (dot(d, axis) < 0 ? -1.0 : 1.0) * axis;
}

// True unless a point of the boxes' surface lies in a slit: a ball that touches it meets no box.
bool has_room(const std::vector<TiltedBox>& boxes, Vec3d p, double radius) {
  const auto own = std::ranges::min_element(boxes, {}, [&](const TiltedBox& b) { return std::abs(depth_in(b, p)); });
  const Vec3d centre = p + radius * outward_normal(*own, p);
  return std::ranges::all_of(boxes, [&](const TiltedBox& b) { return distance_from(b, centre) > 0.999 * radius; });
}

MeshQuality quality_of(const Reconstruction& r) { return measure_quality(r.mesh.positions, r.mesh.triangles); }

std::vector<Vec3d> visible_points(const IndexedMesh& mesh, Scheduler& scheduler) {
  ViewChoice choice;
  choice.samples = 4000, choice.candidates = 60;
  return choose_views(mesh, choice, scheduler).visible_points;
}

double coverage_of(const Reconstruction& r, const IndexedMesh& mesh, std::span<const Vec3d> points,
                   Scheduler& scheduler) {
  return measure_coverage(points, r.mesh, mesh.transform, r.report.spacing, scheduler).share;
}

double coverage_of(const Reconstruction& r, const IndexedMesh& mesh, Scheduler& scheduler) {
  return coverage_of(r, mesh, visible_points(mesh, scheduler), scheduler);
}

TEST(Outside, OverlappingBoxesGetOneClosedShell) {
  const auto scheduler = make_tbb_scheduler(2);
  const std::vector<TiltedBox> boxes = tilted_boxes(300, 0.25);
  const IndexedMesh mesh = mesh_of(boxes);
  const Reconstruction result = reconstruct(mesh, shell_config(48), *scheduler);
  const MeshQuality quality = quality_of(result);
  EXPECT_TRUE(quality.closed() && quality.manifold());
  EXPECT_EQ(quality.inconsistent_edges, 0u);
  EXPECT_EQ(quality.components, 1u);
  const double spacing = result.report.spacing * mesh.transform.scale;
  std::vector<Vec3d> points = visible_points(mesh, *scheduler);
  EXPECT_GT(coverage_of(result, mesh, points, *scheduler), 0.97);
  // The rest is in slits narrower than the spacing: they are closed over, although some ray finds its way in.
  const std::size_t visible = points.size();
  std::erase_if(points, [&](Vec3d p) { return !has_room(boxes, mesh.transform.to_model(to_float(p)), spacing / 2); });
  EXPECT_GT(points.size(), visible / 2);
  EXPECT_GT(coverage_of(result, mesh, points, *scheduler), 0.99);
  double deepest = 0;
  for (const Vec3d& p : result.mesh.positions)
    for (const TiltedBox& box : boxes) deepest = std::max(deepest, depth_in(box, p));
  EXPECT_LT(deepest, spacing);
}

TEST(Outside, IsNearTheSurfaceAndSharp) {
  const auto scheduler = make_tbb_scheduler(2);
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  add_box({0, 0, 0}, {3, 2, 1}, 3, positions, triangles);
  const Reconstruction box = reconstruct(clean(positions, triangles), shell_config(37), *scheduler);
  RawMesh original;
  original.positions = positions, original.triangles = triangles;
  const MeshDistance d = compare_meshes(original, box.mesh);
  EXPECT_LT(std::max(d.forward.rms, d.backward.rms) / d.diagonal, 1e-4);
  EXPECT_EQ(quality_of(box).euler, 2);

  const IndexedMesh torus = torus_mesh(80, 40);
  const Reconstruction ring = reconstruct(torus, shell_config(48), *scheduler);
  EXPECT_TRUE(quality_of(ring).closed() && quality_of(ring).manifold());
  EXPECT_EQ(quality_of(ring).euler, 0);
  EXPECT_GT(coverage_of(ring, torus, *scheduler), 0.999);
}

TEST(Outside, LeavesOutWhatIsInside) {
  const auto serial = make_serial_scheduler();
  const IndexedMesh ball = sphere_mesh(4, 0);
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  for (const double radius : {1.0, 0.6, 0.2}) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const Vec3f& p : ball.positions) positions.push_back(radius * (to_double(p) - Vec3d{0.5, 0.5, 0.5}));
    for (const Triangle& t : ball.triangles) triangles.push_back({{t.v[0] + first, t.v[1] + first, t.v[2] + first}});
  }
  const Reconstruction result = reconstruct(clean(positions, triangles), shell_config(32), *serial);
  EXPECT_EQ(quality_of(result).components, 1u);
  EXPECT_EQ(quality_of(result).euler, 2);
  for (const Vec3d& p : result.mesh.positions) EXPECT_GT(length(p), 0.45);
}

// A solid with a hole is closed there; a sheet gets a shell around both of its sides.
TEST(Outside, ClosesHolesAndSheets) {
  const auto scheduler = make_tbb_scheduler(2);
  IndexedMesh open = sphere_mesh(5, 0);
  std::erase_if(open.triangles, [&](const Triangle& t) { return open.positions[t.v[0]].z > 0.95f; });
  const Reconstruction ball = reconstruct(open, shell_config(40), *scheduler);
  EXPECT_TRUE(quality_of(ball).closed() && quality_of(ball).manifold());
  EXPECT_EQ(quality_of(ball).components, 1u);
  EXPECT_EQ(quality_of(ball).euler, 2);

  const IndexedMesh terrain = terrain_mesh(40, 0.2);
  const Reconstruction sheet = reconstruct(terrain, shell_config(50), *scheduler);
  EXPECT_TRUE(quality_of(sheet).closed() && quality_of(sheet).manifold());
  EXPECT_EQ(quality_of(sheet).components, 1u);
  EXPECT_EQ(quality_of(sheet).euler, 2);
  EXPECT_GT(sheet.report.shell.sheet_points, 1000u);
  EXPECT_GT(coverage_of(sheet, terrain, *scheduler), 0.99);
}

// A part that is turned inside out is a part like any other: what is in front of it stays free.
TEST(Outside, WrapsPartsThatAreInsideOut) {
  const auto scheduler = make_tbb_scheduler(2);
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  add_box({0, 0, 0}, {1, 1, 1}, 4, positions, triangles);
  add_box({1.2, 0.4, 0.4}, {1.4, 0.6, 0.6}, 2, positions, triangles);
  for (Triangle& t : triangles)
    if (positions[t.v[0]].x > 1.1) std::swap(t.v[1], t.v[2]);
  const IndexedMesh mesh = clean(positions, triangles);
  const Reconstruction result = reconstruct(mesh, shell_config(40), *scheduler);
  EXPECT_TRUE(quality_of(result).closed() && quality_of(result).manifold());
  EXPECT_EQ(quality_of(result).components, 2u);
  RawMesh original;
  original.positions = positions, original.triangles = triangles;
  const MeshDistance d = compare_meshes(original, result.mesh);
  EXPECT_LT(d.backward.max, 0.5 * result.report.spacing * mesh.transform.scale);
}

TEST(Outside, IsTheSameForAnyNumberOfThreads) {
  const IndexedMesh mesh = mesh_of(tilted_boxes(40, 0.4));
  const RawMesh expected = reconstruct(mesh, shell_config(40), *make_serial_scheduler()).mesh;
  for (const int threads : {1, 3}) {
    const RawMesh other = reconstruct(mesh, shell_config(40), *make_tbb_scheduler(threads)).mesh;
    EXPECT_EQ(expected.positions, other.positions);
    EXPECT_EQ(expected.triangles, other.triangles);
  }
}

TEST(Outside, ReachesARequestedNumberOfTriangles) {
  const auto scheduler = make_tbb_scheduler(2);
  const Reconstruction result =
      reconstruct_to_triangles(mesh_of(tilted_boxes(60, 0.4)), shell_config(0), 3000, *scheduler);
  EXPECT_NEAR(static_cast<double>(result.mesh.triangles.size()), 3000, 150);
  EXPECT_TRUE(quality_of(result).closed() && quality_of(result).manifold());
}

// The twin: every point of the grid by every view, without blocks.
TEST(Outside, BlocksSayWhatTheirPointsSay) {
  const auto serial = make_serial_scheduler();
  const IndexedMesh mesh = mesh_of(tilted_boxes(40, 0.4));
  std::vector<PositionMap> maps;
  for (const Vec3d& direction : even_directions(9))
    maps.push_back(rasterize_map(mesh, orthographic_view(box_of(mesh), direction, 1.0 / 60), {}, *serial));
  maps.push_back(rasterize_map(mesh, perspective_view(box_of(mesh), {2.5, 2, 1.5}, 1.0 / 60), {}, *serial));
  const double spacing = 1.0 / 30;
  const FreeSpace space(maps, 1.5 * spacing, *serial);
  const ShellGrid grid(space, box_of(mesh), spacing, *serial);
  std::vector<ViewNumber> all(maps.size());
  std::iota(all.begin(), all.end(), ViewNumber{0});
  std::size_t solid = 0;
  for (std::size_t b = 0; b < grid.blocks(); ++b)
    for (std::size_t place = 0; place < ShellGrid::block_points; ++place) {
      const GridPoint p = grid.point_at(b, place);
      ASSERT_EQ(grid.block_of(p), b);
      ASSERT_EQ(ShellGrid::place_in_block(p), place);
      const bool is_free = space.distance(grid.position(p), all) > 0;
      if (grid.is_solid(p)) {
        EXPECT_TRUE(!is_free || grid.sheet_at(p));
        ++solid;
      }
      // Only the outermost layer is free without any view's word.
      const bool inner = p.x > 0 && p.y > 0 && p.z > 0;
      EXPECT_TRUE(is_free || grid.is_solid(p) || !inner);
    }
  EXPECT_GT(solid, 1000u);
}

TEST(Outside, NothingSeenGivesNothing) {
  PositionMap map;
  map.view = orthographic_view(Box3f{{0, 0, 0}, {1, 1, 1}}, {0, 0, -1}, 0.25);
  const std::size_t n = map.view.pixels();
  map.position.resize(n), map.normal.resize(n), map.depth.resize(n), map.triangle.assign(n, no_triangle);
  ShellReport report;
  EXPECT_TRUE(make_shell(std::vector<PositionMap>{map}, 0.1, report, *make_serial_scheduler()).triangles.empty());
}

}  // namespace
}  // namespace lodestone::test
