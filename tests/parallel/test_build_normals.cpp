// Normals of coarse levels: near the surface that is left, one for a vertex, creases kept.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "core/hierarchy/verify/verify.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

Hierarchy build(RawMesh raw, int finest_level = 4) {
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  BuildConfig config;
  config.finest_level = finest_level;
  return build_hierarchy(prepare_mesh(std::move(raw), repairs, *scheduler), config, *scheduler);
}

using Key = std::array<std::int64_t, 5>;
Key key_of(const Cell& cell, std::uint32_t v) {
  const auto lattice = [](float x) { return static_cast<std::int64_t>(std::ldexp(double{x}, 40)); };
  const Vec3f p = cell.positions[v];
  return {lattice(p.x), lattice(p.y), lattice(p.z), cell.normals[v].u, cell.normals[v].v};
}

double degrees(Vec3d a, Vec3d b) { return 57.29578 * std::atan2(length(cross(a, b)), dot(a, b)); }

Vec3d cross_product(const Cell& cell, const Triangle& t) {
  const Vec3d a = to_double(cell.positions[t.v[0]]);
  return cross(to_double(cell.positions[t.v[1]]) - a, to_double(cell.positions[t.v[2]]) - a);
}

// The angle between each vertex's normal and the mean of the triangles around it, of those that have that normal; on
// the root, none of whose vertices another block locks. In degrees, the largest. Vertices with a triangle that 20
// degrees more could take 60 degrees off are left out: their normals need not be near the mean.
double largest_angle(const Hierarchy& h) {
  const Cell& root = h.cells[0];
  std::map<Key, std::vector<Vec3d>> stars;
  for (const Triangle& t : root.triangles)
    for (const std::uint32_t v : t.v) stars[key_of(root, v)].push_back(cross_product(root, t));
  double largest = 0;
  std::size_t compared = 0;
  for (std::uint32_t v = 0; v < root.positions.size(); ++v) {
    const std::vector<Vec3d>& star = stars[key_of(root, v)];
    Vec3d mean{};
    for (const Vec3d& t : star) mean = mean + t;
    if (!(length(mean) > 0)) continue;
    if (std::ranges::any_of(star, [&](Vec3d t) { return degrees(t, mean) > 39.9; })) continue;
    ++compared;
    largest = std::max(largest, degrees(to_double(unpack_normal(root.normals[v])), mean));
  }
  EXPECT_GT(2 * compared, root.positions.size());
  return largest;
}

// Share of the root's area with a corner normal more than 60 degrees off the triangle's.
double share_off(const Hierarchy& h) {
  const Cell& root = h.cells[0];
  double off = 0, all = 0;
  for (const Triangle& t : root.triangles) {
    const Vec3d n = cross_product(root, t);
    all += length(n);
    if (std::ranges::any_of(
            t.v, [&](std::uint32_t v) { return degrees(to_double(unpack_normal(root.normals[v])), n) > 60.01; }))
      off += length(n);
  }
  return off / all;
}

template <class Height>
RawMesh surface_of(const Height& height, bool charts) {
  RawMesh raw;
  test::add_grid(
      100, 100, false,
      [&](double x, double y) {
        return Vec3d{x, y, height(x, y)};
      },
      raw.positions, raw.triangles);
  if (!charts) return raw;
  std::uint32_t wedge = 0;
  for (const Triangle& t : raw.triangles) {  // two charts of texture coordinates
    double x = 0;
    for (const std::uint32_t v : t.v) x += raw.positions[v].x / 3;
    raw.wedges.corners.push_back({{wedge, wedge + 1, wedge + 2}});
    wedge += 3;
    for (const std::uint32_t v : t.v)
      raw.wedges.uv.push_back({static_cast<float>(raw.positions[v].x + (x > 0.5 ? 10 : 0)), 0});
  }
  return raw;
}

// A plane with waves too narrow for the root, as steep as walls where they are 0.02 high.
RawMesh rough(double height, bool charts) {
  return surface_of([=](double x, double y) { return height * std::sin(150 * x) * std::cos(130 * y); }, charts);
}

TEST(BuildNormals, FollowTheSurfaceThatIsLeft) {
  for (const bool charts : {false, true}) {
    const Hierarchy h = build(rough(0.02, charts));
    EXPECT_EQ(h.attributes.wedges, charts);
    EXPECT_GT(h.cells[0].triangles.size(), 20u);
    EXPECT_LE(largest_angle(h), 20.1);
  }
}

// The finest level's normals come from all its triangles, so that some of the first coarse level's are out of date.
TEST(BuildNormals, FollowTheSurfaceOnTheFirstCoarseLevelToo) {
  for (const bool charts : {false, true}) EXPECT_LE(largest_angle(build(rough(0.006, charts), 1)), 20.1);
}

// A sheet in folds as narrow as the root's triangles: normals face the triangles at them, not only their mean.
TEST(BuildNormals, FaceTheTrianglesOfNarrowFolds) {
  const auto folded = [](double x, double y) { return 0.03 * std::sin(90 * x) * std::cos(70 * y); };
  for (const bool charts : {false, true}) {
    const Hierarchy h = build(surface_of(folded, charts));
    EXPECT_LE(share_off(h), 0.05);
    EXPECT_TRUE(verify_hierarchy(h).valid()) << "copies with one normal";
  }
}

// At seams of texture coordinates alone a vertex has one normal on every level, as on the finest.
TEST(BuildNormals, SeamsDoNotShow) {
  const Hierarchy h = build(surface_of([](double, double y) { return 0.004 * std::cos(130 * y); }, true));
  for (const Cell& cell : h.cells) {
    std::map<std::array<float, 3>, PackedNormal> normals;
    std::size_t copies = 0;
    for (std::uint32_t v = 0; v < cell.positions.size(); ++v) {
      const Vec3f p = cell.positions[v];
      const auto [at, is_new] = normals.try_emplace({p.x, p.y, p.z}, cell.normals[v]);
      copies += !is_new;
      ASSERT_TRUE(at->second == cell.normals[v]) << "position " << p.x << ' ' << p.y;
    }
    if (&cell == h.cells.data()) {
      EXPECT_GT(copies, 0u);
    }
  }
}

// Where the surface folds at a seam, one normal would be wrong on both sides. No vertex of the root is locked.
TEST(BuildNormals, FoldsAtSeamsShow) {
  const Hierarchy h = build(surface_of([](double x, double) { return -3 * std::abs(x - 0.5); }, true));
  const Cell& root = h.cells[0];
  EXPECT_GT(root.triangles.size(), 5u);
  for (const Triangle& t : root.triangles) {
    const Vec3d a = to_double(root.positions[t.v[0]]);
    const Vec3d n = cross(to_double(root.positions[t.v[1]]) - a, to_double(root.positions[t.v[2]]) - a);
    for (const std::uint32_t v : t.v) EXPECT_GT(dot(n, to_double(unpack_normal(root.normals[v]))), 0.93 * length(n));
  }
}

// A cube whose sides have normals of their own.
TEST(BuildNormals, CreasesStay) {
  RawMesh raw;
  test::add_cube(
      24, [](Vec3d p) { return p; }, raw.positions, raw.triangles);
  std::uint32_t wedge = 0;
  for (const Triangle& t : raw.triangles) {
    raw.wedges.corners.push_back({{wedge, wedge + 1, wedge + 2}});
    wedge += 3;
    const Vec3d n = cross(raw.positions[t.v[1]] - raw.positions[t.v[0]], raw.positions[t.v[2]] - raw.positions[t.v[0]]);
    for (int k = 0; k < 3; ++k) raw.wedges.normal.push_back(to_float((1 / length(n)) * n));
  }
  const Hierarchy h = build(raw);
  const Cell& root = h.cells[0];
  for (const Triangle& t : root.triangles) {
    const Vec3d a = to_double(root.positions[t.v[0]]);
    const Vec3d n = cross(to_double(root.positions[t.v[1]]) - a, to_double(root.positions[t.v[2]]) - a);
    for (const std::uint32_t v : t.v) EXPECT_GT(dot(n, to_double(unpack_normal(root.normals[v]))), 0.999 * length(n));
  }
}

}  // namespace
}  // namespace lodestone
