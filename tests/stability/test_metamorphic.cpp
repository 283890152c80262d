// A model is moved, scaled, turned, mirrored, renumbered, cut in two and taken apart, and what is made of it remains the
// same: over the catalogue of hard surfaces and two generated shapes, in every part of the program that makes surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/edge_census.h"
#include "core/progressive/mesh/level.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/mesh/compare.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/spherical/make_spherical.h"
#include "render/reconstruct/reconstruct.h"
#include "tests/hierarchy_bytes.h"
#include "tests/stability/metamorphic.h"

namespace lodestone::test {
namespace {

constexpr std::uint64_t small = 400;  // triangles of a case, about

// A change that keeps every difference of coordinates, or doubles it so many times: all that is made of the model is
// normalised, and has the same bytes.
struct Harmless {
  std::string name;
  std::function<RawMesh(const RawMesh&)> apply;
  double scale = 1;
  Vec3d shift{};
  int threads = 0;  // 0: the serial scheduler
};

constexpr Vec3d far_off{3 * 0x1p20, -5 * 0x1p20, 7 * 0x1p10};

std::vector<Harmless> harmless() {
  const auto same = [](const RawMesh& mesh) { return mesh; };
  const auto scaled = [](double s) { return [s](const RawMesh& mesh) { return mapped(mesh, scaling(s)); }; };
  return {{"one thread", same, 1, {}, 1},
          {"two threads", same, 1, {}, 2},
          {"four threads", same, 1, {}, 4},
          {"scaled up", scaled(0x1p40), 0x1p40},
          {"scaled down", scaled(0x1p-40), 0x1p-40},
          {"moved", [](const RawMesh& mesh) { return mapped(mesh, moving(far_off)); }, 1, far_off},
          {"unwelded", unwelded},
          {"in two parts", in_two_parts}};
}

std::unique_ptr<Scheduler> scheduler_of(int threads) {
  return threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
}

IndexedMesh prepared(const RawMesh& mesh, Scheduler& scheduler) {
  Repairs repairs;
  return prepare_mesh(RawMesh(mesh), repairs, scheduler);
}

// Cells of some forty triangles, so that small surfaces have several levels.
Hierarchy built(const RawMesh& mesh, Scheduler& scheduler) {
  BuildConfig config;
  config.cell_triangles = 40;
  config.sigma0 = 1;
  Hierarchy h = build_hierarchy(prepared(mesh, scheduler), config, scheduler);
  measure_errors(h, {}, scheduler);
  return h;
}

std::string progressive_bytes(const ProgressiveMesh& mesh) {
  std::string out;
  append_bytes(out, mesh.positions);
  append_bytes(out, mesh.parents);
  append_bytes(out, mesh.errors);
  append_bytes(out, mesh.triangles);
  append_bytes(out, mesh.wedges.uv);
  append_bytes(out, std::array{mesh.finest_error, static_cast<double>(mesh.base_vertices)});
  for (const Texture& texture : mesh.wedges.textures) append_bytes(out, texture.bytes);
  return out;
}

ProgressiveMesh progressive(const RawMesh& mesh, Scheduler& scheduler) {
  ProgressiveReport report;
  return make_progressive(prepared(mesh, scheduler), {}, scheduler, report);
}

void expect_transform(const Transform& transform, const Transform& base, const Harmless& change) {
  EXPECT_EQ(transform.scale, change.scale * base.scale);
  EXPECT_EQ(transform.origin, change.scale * base.origin + change.shift);
}

TEST(Metamorphic, HierarchiesOfMovedAndScaledModelsHaveTheSameBytes) {
  for (const Surface& surface : surfaces(small)) {
    const auto serial = make_serial_scheduler();
    const Hierarchy base = built(surface.mesh, *serial);
    const std::string expected = hierarchy_bytes(base);
    EXPECT_TRUE(verify_hierarchy(base).valid()) << surface.name;
    for (const Harmless& change : harmless()) {
      SCOPED_TRACE(surface.name + ", " + change.name);
      const Hierarchy h = built(change.apply(surface.mesh), *scheduler_of(change.threads));
      EXPECT_TRUE(hierarchy_bytes(h) == expected);
      expect_transform(h.transform, base.transform, change);
    }
  }
}

TEST(Metamorphic, ProgressiveMeshesOfMovedAndScaledModelsHaveTheSameBytes) {
  for (const Surface& surface : surfaces(small)) {
    const auto serial = make_serial_scheduler();
    const ProgressiveMesh base = progressive(surface.mesh, *serial);
    for (const Harmless& change : harmless()) {
      SCOPED_TRACE(surface.name + ", " + change.name);
      const ProgressiveMesh mesh = progressive(change.apply(surface.mesh), *scheduler_of(change.threads));
      EXPECT_TRUE(progressive_bytes(mesh) == progressive_bytes(base));
      expect_transform(mesh.transform, base.transform, change);
    }
  }
}

// Holes, handles, one side only, vertices of several fans; the images are made of the surface, too.
TEST(Metamorphic, SpheresOfMovedAndScaledModelsHaveTheSameBytes) {
  SphericalConfig config;
  config.texture = 16;
  config.media_type = "image/png";
  config.error_points = 1000;
  config.maps.geometry = true;
  config.map.effort = SphereEffort::fast;
  for (const char* name : {"klein", "holes", "bow-ties", "cylinder"}) {
    const Surface surface = surface_named(name, 200);
    const auto made = [&](const RawMesh& mesh, Scheduler& scheduler) {
      SphericalReport report;
      return make_spherical(prepared(mesh, scheduler), config, scheduler, report);
    };
    const auto serial = make_serial_scheduler();
    const std::string expected = progressive_bytes(made(surface.mesh, *serial));
    for (const Harmless& change : harmless())
      EXPECT_TRUE(expected == progressive_bytes(made(change.apply(surface.mesh), *scheduler_of(change.threads))))
          << name << ", " << change.name;
  }
}

// Vertices return to the space of the model, where a coordinate below 2^23 is rounded to 2^-30.
TEST(Metamorphic, ReconstructionsMoveWithTheirModels) {
  ReconstructConfig config;
  config.resolution = 24;
  config.views.candidates = 12;
  config.views.samples = 500;
  config.views.resolution = 32;
  for (const char* name : {"crossing", "crease", "fins"}) {
    const Surface surface = surface_named(name, small);
    const auto serial = make_serial_scheduler();
    const RawMesh base = reconstruct(prepared(surface.mesh, *serial), config, *serial).mesh;
    EXPECT_GE(base.triangles.size(), 50u) << name;
    for (const Harmless& change : harmless()) {
      SCOPED_TRACE(surface.name + ", " + change.name);
      const auto scheduler = scheduler_of(change.threads);
      const RawMesh mesh = reconstruct(prepared(change.apply(surface.mesh), *scheduler), config, *scheduler).mesh;
      EXPECT_TRUE(same_bytes(mesh.triangles, base.triangles));
      ASSERT_EQ(mesh.positions.size(), base.positions.size());
      const double tolerance = length(change.shift) > 0 ? 0x1p-30 : 0;
      for (std::size_t v = 0; v < base.positions.size(); ++v) {
        const Vec3d off = mesh.positions[v] - (change.scale * base.positions[v] + change.shift);
        EXPECT_LE(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}), tolerance);
      }
    }
  }
}

// Changes after which the same surface is another list of numbers: other cells, another order, other roundings.
struct Change {
  std::string name;
  std::function<RawMesh(const RawMesh&)> apply;
  bool exact;  // coordinates are multiples of the step still
};

constexpr Affine3d axes_turned{{Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{1, 0, 0}}, {}};
constexpr Affine3d quarter_turn{{Vec3d{0, 1, 0}, Vec3d{-1, 0, 0}, Vec3d{0, 0, 1}}, {}};
constexpr Affine3d mirror{{Vec3d{-1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}, {}};

std::vector<Change> changes() {
  const auto by = [](const Affine3d& map) { return [map](const RawMesh& mesh) { return mapped(mesh, map); }; };
  return {{"renumbered", permuted, true},
          {"axes turned", by(axes_turned), true},
          {"turned by 90 degrees", by(quarter_turn), true},
          {"mirrored", by(mirror), true},
          {"turned by one radian", by(turning(1)), false}};
}

struct Topology {
  EdgeCensus edges;
  std::int64_t euler = 0;
  friend bool operator==(const Topology&, const Topology&) = default;
};

// Vertices that no triangle uses do not count.
Topology topology_of(const RawMesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t.v) used[v] = 1;
  Topology result{count_edges(mesh.triangles, mesh.positions.size()), 0};
  result.euler = std::count(used.begin(), used.end(), 1) - static_cast<std::int64_t>(result.edges.edges) +
                 static_cast<std::int64_t>(mesh.triangles.size());
  return result;
}

bool is_closed_manifold(const RawMesh& mesh) {
  const EdgeCensus edges = topology_of(mesh).edges;
  return edges.border == 0 && edges.non_manifold == 0 && edges.inconsistent == 0;
}

TEST(Metamorphic, HierarchiesOfTheSameSurfaceAgree) {
  const auto serial = make_serial_scheduler();
  for (const Surface& surface : surfaces(small)) {
    const Hierarchy base = built(surface.mesh, *serial);
    const Topology finest = topology_of(level_mesh(base, base.finest()));
    for (const Change& change : changes()) {
      SCOPED_TRACE(surface.name + ", " + change.name);
      const RawMesh input = change.apply(surface.mesh);
      const Hierarchy h = built(input, *serial);
      // Stored errors are those of the normalised model. A coordinate of that is off by half a unit of float32's last
      // place below 1, and the distance by the root of 3 of it.
      const double rounding = change.exact ? 0 : std::sqrt(3.0) * 0x1p-25 * h.transform.scale;
      EXPECT_TRUE(verify_hierarchy(h).valid());
      // Vertices are at least a step apart, 16 times the rounding of a float.
      EXPECT_EQ(topology_of(level_mesh(h, h.finest())), finest);
      if (change.name == "renumbered") {
        EXPECT_EQ(h.provenance.fingerprint, base.provenance.fingerprint);
        ASSERT_EQ(h.levels.size(), base.levels.size());
        for (std::size_t l = 0; l < h.levels.size(); ++l) EXPECT_EQ(h.levels[l].cell_count, base.levels[l].cell_count);
        EXPECT_EQ(h.levels.back().reach, base.levels.back().reach);
        EXPECT_EQ(h.levels.back().max_edge, base.levels.back().max_edge);
      }
      for (int l = 0; l < h.finest(); ++l) {
        const RawMesh level = level_mesh(h, l);
        if (is_closed_manifold(input)) {
          EXPECT_TRUE(is_closed_manifold(level)) << "level " << l;
          EXPECT_EQ(topology_of(level).euler, finest.euler) << "level " << l;
        }
        if (level.triangles.empty()) continue;
        EXPECT_LE(compare_meshes(level, input, {.area_points = 1024}).forward.max,
                  h.levels[static_cast<std::size_t>(l)].error * cell_size(l) * h.transform.scale + rounding)
            << "level " << l;
      }
    }
  }
}

TEST(Metamorphic, ProgressiveMeshesOfTheSameSurfaceAgree) {
  const auto serial = make_serial_scheduler();
  for (const Surface& surface : surfaces(small)) {
    const ProgressiveMesh base = progressive(surface.mesh, *serial);
    // That of the finest level, not of the input: fans that meet in a vertex are cut apart.
    const std::int64_t euler = topology_of(LevelFinder(base).level_mesh(base.vertex_count())).euler;
    for (const Change& change : changes()) {
      SCOPED_TRACE(surface.name + ", " + change.name);
      const RawMesh input = change.apply(surface.mesh);
      const ProgressiveMesh mesh = progressive(input, *serial);
      EXPECT_NO_THROW(check_progressive(mesh, surface.name));
      EXPECT_EQ(mesh.triangles.size(), base.triangles.size());
      if (!is_closed_manifold(input)) continue;
      const LevelFinder levels(mesh);
      for (const std::uint32_t vertices : {mesh.base_vertices, mesh.vertex_count() / 2, mesh.vertex_count()}) {
        const RawMesh level = levels.level_mesh(levels.vertices_for(vertices));
        EXPECT_TRUE(is_closed_manifold(level)) << vertices;
        EXPECT_EQ(topology_of(level).euler, euler) << vertices;
      }
    }
  }
}

void expect_near(const DirectedDistance& a, const DirectedDistance& b, double scale, double tolerance) {
  EXPECT_NEAR(a.max, scale * b.max, tolerance);
  EXPECT_NEAR(a.rms, scale * b.rms, tolerance);
  EXPECT_NEAR(a.mean, scale * b.mean, tolerance);
  EXPECT_NEAR(a.p99, scale * b.p99, tolerance);
}

// A comparison of two surfaces that are mapped alike. Every other vertex of the second one is off by a few hundredths.
TEST(Metamorphic, DistancesOfMovedSurfacesAgree) {
  // A power of two, above the triangles: the k-th sample then never lies between two triangles of equal area, where
  // rounding of the areas would decide on which of them it is.
  const CompareConfig config{.area_points = 4096};
  for (const Surface& surface : surfaces(small)) {
    RawMesh other = surface.mesh;
    for (std::size_t v = 0; v < other.positions.size(); v += 2)
      other.positions[v].z += static_cast<double>(1 + v % 5) * 0x1p-7;
    const auto serial = make_serial_scheduler();
    const MeshDistance base = compare_meshes(surface.mesh, other, config, *serial);
    const auto expect_alike = [&](const MeshDistance& d, double scale, double tolerance) {
      EXPECT_NEAR(d.diagonal, scale * base.diagonal, tolerance);
      expect_near(d.forward, base.forward, scale, tolerance);
      expect_near(d.backward, base.backward, scale, tolerance);
    };
    for (const Harmless& change : harmless()) {
      SCOPED_TRACE(surface.name + ", " + change.name);
      if (change.name == "unwelded" || change.name == "in two parts") continue;  // their vertices count more than once
      expect_alike(
          compare_meshes(change.apply(surface.mesh), change.apply(other), config, *scheduler_of(change.threads)),
          change.scale, 0);
    }
    // Not by transform_mesh, which turns triangles over: the points within them are then others. Distances from thin
    // triangles lose four of the sixteen digits of a double (core/spatial/point_triangle.h).
    const std::array maps{axes_turned, quarter_turn, mirror, turning(1)};
    for (std::size_t m = 0; m < maps.size(); ++m) {
      SCOPED_TRACE(surface.name + ", map " + std::to_string(m));
      const auto placed = [&](RawMesh mesh) {
        for (Vec3d& p : mesh.positions) p = maps[m].point(p);
        return mesh;
      };
      const MeshDistance d = compare_meshes(placed(surface.mesh), placed(other), config, *serial);
      expect_near(d.forward, base.forward, 1, 1e-12);
      expect_near(d.backward, base.backward, 1, 1e-12);
    }
  }
}

}  // namespace
}  // namespace lodestone::test
