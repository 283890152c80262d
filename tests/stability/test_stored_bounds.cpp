// Every bound that a file or a table of radii stores, against the exact figure that it bounds: on the catalogue of hard
// surfaces, in rational arithmetic.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "core/base/error.h"
#include "core/files/byte_reader.h"
#include "core/hierarchy/tiles/tileset_tree.h"
#include "core/progressive/gltf/progressive_glb.h"
#include "core/progressive/lpm/lpm.h"
#include "core/progressive/mesh/level.h"
#include "core/simplify/simplifiers.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/measure_errors.h"
#include "parallel/progressive/level_errors.h"
#include "parallel/progressive/make_progressive.h"
#include "render/lod/radii.h"
#include "tests/hard_mesh.h"
#include "tests/stability/exact.h"

namespace lodestone::test {
namespace {

constexpr std::uint64_t small = 400;  // triangles of a case, about

class StoredBounds : public ::testing::Test {
 protected:
  void for_each_case(const std::function<void(const IndexedMesh&)>& check) {
    for (const HardCase& hard : hard_cases()) {
      if (!hard.refusal.empty()) continue;
      SCOPED_TRACE(std::string(hard.name));
      check(prepared(hard));
    }
  }
  [[nodiscard]] IndexedMesh prepared(const HardCase& hard) {
    Repairs repairs;
    return prepare_mesh(hard_mesh(hard, small), repairs, *scheduler_);
  }
  // Cells of some forty triangles, so that small surfaces have several levels.
  [[nodiscard]] Hierarchy built(IndexedMesh mesh, const std::string& simplifier = "quadric") {
    BuildConfig config;
    config.cell_triangles = 40;
    config.sigma0 = 1;
    config.simplifier = simplifier;
    return build_hierarchy(std::move(mesh), config, *scheduler_);
  }
  [[nodiscard]] ProgressiveMesh progressive(const IndexedMesh& mesh, std::size_t finest = 0) {
    ProgressiveReport report;
    return make_progressive(mesh, {.finest_triangles = finest}, *scheduler_, report);
  }

  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
};

// ---- hierarchies ----

Rational side_of(int level) { return Rational(cell_size(level)); }

// (1), the largest movement of each cell, the reach, the diameter and the longest edge.
void expect_figures(const Hierarchy& h) {
  for (CellId c{0}; c < h.cells.size(); ++c) {
    const Cell& cell = h.cells[c];
    const int l = h.level_of(c);
    const Level& level = h.levels[static_cast<std::size_t>(l)];
    const auto within = [&](float ratio) { return square(Rational(ratio) * side_of(l)); };
    const ExactPoint lo = exact(cell.bounds.lo), hi = exact(cell.bounds.hi);
    EXPECT_LE(squared_distance(lo, hi), within(level.diameter));
    for (std::size_t v = 0; v < cell.positions.size(); ++v) {
      ASSERT_TRUE(cell.bounds.contains(cell.positions[v]));
      const ExactPoint p = exact(cell.positions[v]);
      const auto far = [](const Rational& x, const Rational& low, const Rational& high) {
        return std::max(Rational(x - low), Rational(high - x));
      };
      const ExactPoint corner{far(p.x, lo.x, hi.x), far(p.y, lo.y, hi.y), far(p.z, lo.z, hi.z)};
      EXPECT_LE(squared_length(corner), within(level.reach[0])) << "level " << l;
      EXPECT_LE(std::max({corner.x, corner.y, corner.z}), Rational(level.reach[1]) * side_of(l)) << "level " << l;
      if (cell.parent == no_cell) continue;
      const Rational moved = squared_distance(p, exact(h.cells[cell.parent].positions[cell.parents[v]]));
      EXPECT_LE(moved, square(Rational(cell.max_displacement)));
      EXPECT_LE(moved, square(Rational(h.sigma0) * side_of(l) / 2));
    }
    for (const Triangle& t : cell.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_LE(squared_distance(exact(cell.positions[t.v[k]]), exact(cell.positions[t.v[(k + 1) % 3]])),
                  within(level.max_edge));
    EXPECT_LE(Rational(cell.error), Rational(level.error) * side_of(l));
  }
}

TEST_F(StoredBounds, OfHierarchiesHold) {
  for_each_case([&](const IndexedMesh& mesh) {
    for (const std::string& kind : simplifier_names()) expect_figures(built(mesh, kind));
  });
}

// A surface whose finest differences are far below the square root of the least float.
IndexedMesh mesh_of_tiny_differences(float size) {
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {1, 1, 1}, {1, 1, 0.9f}, {1, 0.9f, 1}};
  mesh.triangles = {{{0, 1, 2}}, {{3, 4, 5}}};
  return mesh;
}

TEST_F(StoredBounds, HoldWhereSquaresVanish) {
  for (const float size : {1e-18f, 1e-20f, 3e-22f, 1e-23f, 1e-30f, 1e-44f}) {
    BuildConfig config;
    config.finest_level = 3;
    const Hierarchy h = build_hierarchy(mesh_of_tiny_differences(size), config, *scheduler_);
    // By cell, since the other triangle makes the figures of the levels.
    expect_figures(h);
    IndexedMesh alone = mesh_of_tiny_differences(size);
    alone.triangles.resize(1);
    alone.positions.resize(3);
    for (Vec3f& p : alone.positions) p.z = 0;
    expect_figures(build_hierarchy(std::move(alone), config, *scheduler_));
  }
}

// M_l, with vertices that no triangle uses any more as triangles of one point.
ExactSurface surface_of(const Hierarchy& h, int l) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  for (const Cell& cell : h.cells_of(l)) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    std::vector<bool> used(cell.positions.size());
    for (const Vec3f p : cell.positions) positions.push_back(to_double(p));
    for (const Triangle& t : cell.triangles) {
      triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
      for (const std::uint32_t v : t.v) used[v] = true;
    }
    for (std::uint32_t v = 0; v < used.size(); ++v)
      if (!used[v]) triangles.push_back({{first + v, first + v, first + v}});
  }
  return {std::move(positions), std::move(triangles)};
}

ExactTriangle corners_of(const Cell& cell, const Triangle& t) {
  return {exact(cell.positions[t.v[0]]), exact(cell.positions[t.v[1]]), exact(cell.positions[t.v[2]])};
}

// Some points of every `stride`-th triangle of the cell are within its error.
void expect_within(const Cell& cell, const ExactSurface& surface, float error, unsigned stride) {
  unsigned number = 0;
  for (const Triangle& t : cell.triangles) {
    if (number++ % stride != 0) continue;
    for (const ExactPoint& p : points_of(corners_of(cell, t), number))
      ASSERT_TRUE(surface.is_within(p, Rational(error))) << to_double(p).x << " " << to_double(p).y;
  }
}

TEST_F(StoredBounds, MeasuredErrorsHoldExactly) {
  for_each_case([&](const IndexedMesh& mesh) {
    Hierarchy h = built(mesh);
    measure_errors(h, {}, *scheduler_);
    const ExactSurface finest = surface_of(h, h.finest());
    std::vector<CellId> ancestor;
    const auto leaves = h.cells_of(h.finest());
    for (std::uint32_t k = 0; k < leaves.size(); ++k) ancestor.push_back(leaves[k].parent);
    for (int l = h.finest() - 1; l >= 0; --l) {
      SCOPED_TRACE("level " + std::to_string(l));
      const ExactSurface surface = surface_of(h, l);
      for (const Cell& cell : h.cells_of(l)) expect_within(cell, finest, cell.error, 7);
      for (std::uint32_t k = 0; k < leaves.size(); ++k) {
        expect_within(leaves[k], surface, h.cells[ancestor[k]].error, 17);
        ancestor[k] = h.cells[ancestor[k]].parent;
      }
    }
  });
}

// The finest level of a compressed model stands on a lattice: its error is by how much the input was moved.
TEST_F(StoredBounds, ErrorsOfLatticesHoldExactly) {
  for (int bits = 1; bits <= Lattice::most_bits; ++bits) {
    const Rational error(Lattice{bits}.error()), half = Rational(Lattice{bits}.step()) / 2;
    EXPECT_GE(square(error), 3 * square(half)) << bits;
    EXPECT_LE(square(error), 3 * square(half) * Rational(1.000001)) << bits;
  }
}

// ---- tiles ----

TEST_F(StoredBounds, OfTilesHold) {
  using nlohmann::json;
  for_each_case([&](const IndexedMesh& mesh) {
    const Hierarchy h = built(mesh);
    const TileErrors errors(h);
    std::vector<double> of_cells;
    const Rational scale(h.transform.scale);
    for (CellId c{0}; c < h.cells.size(); ++c) {
      of_cells.push_back(errors.of(c));
      if (h.level_of(c) < h.finest()) {
        EXPECT_GE(Rational(of_cells.back()), Rational(h.cells[c].error) * scale);
      }
    }
    const json tileset = json::parse(encode_tilesets(h, of_cells).front().json);
    const auto extent = squared_distance(exact(h.cells[0].bounds.lo), exact(h.cells[0].bounds.hi));
    EXPECT_GE(square(Rational(tileset["geometricError"].get<double>())), extent * square(scale));
    // Children follow their parents in the order of the tree.
    const std::function<void(const json&, CellId)> check = [&](const json& tile, CellId id) {
      const Cell& cell = h.cells[id];
      const std::vector<double> box = tile["boundingVolume"]["box"];
      const auto covers = [&](std::size_t axis, float lo, float hi) {
        const Rational middle(box[axis]), half(box[3 + 4 * axis]);
        EXPECT_LE(middle - half, scale * Rational(lo));
        EXPECT_GE(middle + half, scale * Rational(hi));
      };
      covers(0, cell.bounds.lo.x, cell.bounds.hi.x);
      covers(1, cell.bounds.lo.y, cell.bounds.hi.y);
      covers(2, cell.bounds.lo.z, cell.bounds.hi.z);
      EXPECT_GE(tile["geometricError"].get<double>(), of_cells[id]);
      for (CellId k = cell.first_child; k < cell.end_child(); ++k) {
        const json& child = tile["children"][k - cell.first_child];
        const std::vector<double> inner = child["boundingVolume"]["box"];
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const Rational middle(box[axis]), half(box[3 + 4 * axis]), of_child(inner[axis]), wide(inner[3 + 4 * axis]);
          EXPECT_LE(middle - half, of_child - wide);
          EXPECT_GE(middle + half, of_child + wide);
        }
        EXPECT_GE(tile["geometricError"].get<double>(), child["geometricError"].get<double>());
        check(child, k);
      }
    };
    check(tileset["root"], CellId(0));
  });
}

// ---- progressive meshes ----

TEST_F(StoredBounds, OfQuantizedMeshesHold) {
  for_each_case([&](const IndexedMesh& input) {
    ProgressiveMesh mesh = progressive(input);
    for (const std::uint32_t bits : {4u, 12u, 20u})
      for (const double before : {0.0, 1e-3}) {
        mesh.finest_error = before;
        const Rational error = Rational(encode_lpm(mesh, {.position_bits = bits}).finest_error) - Rational(before);
        const double steps = std::ldexp(1.0, static_cast<int>(bits));
        const auto moved = [&](float v) {
          return Rational(Rational(std::floor(v * steps + 0.5)) / Rational(steps) - Rational(v));
        };
        Rational farthest = 0;
        for (const Vec3f p : mesh.positions)
          farthest = std::max(farthest, squared_length(ExactPoint{moved(p.x), moved(p.y), moved(p.z)}));
        ASSERT_GE(error, 0);
        EXPECT_GE(square(error), farthest) << bits;
      }
  });
}

TEST_F(StoredBounds, OfProgressiveGltfHold) {
  for_each_case([&](const IndexedMesh& input) {
    ProgressiveMesh mesh = progressive(input);
    mesh.finest_error = 1.0 / 3;
    const std::vector<std::byte> glb = encode_progressive_glb(mesh, false);
    const std::string text(reinterpret_cast<const char*>(glb.data()), glb.size());
    const std::string key = "\"finestError\":";
    const double written = std::stod(text.substr(text.find(key) + key.size(), 30));
    EXPECT_GE(Rational(written), Rational(mesh.finest_error) * Rational(mesh.transform.scale));
    ByteReader reader({reinterpret_cast<const char*>(glb.data()), glb.size()}, "it.glb");
    const ProgressiveMesh back = read_progressive_glb(reader);
    EXPECT_GE(Rational(back.finest_error) * Rational(back.transform.scale), Rational(written));
  });
}

ExactSurface surface_of(const PlacedLevel& level) {
  std::vector<Vec3d> positions;
  for (const Vec3f p : level.positions) positions.push_back(to_double(p));
  return {std::move(positions), level.triangles};
}

TEST_F(StoredBounds, MeasuredErrorsOfProgressiveLevelsHoldExactly) {
  for_each_case([&](const IndexedMesh& input) {
    ProgressiveMesh mesh = progressive(input);
    mesh.finest_error = 1.0 / 3;
    const LevelFinder levels(mesh);
    const LevelErrors errors(mesh, levels, *scheduler_);
    const ExactSurface finest = surface_of(levels.placed_level(mesh.vertex_count()));
    const std::uint32_t vertices = levels.vertices_for((mesh.base_vertices + mesh.vertex_count()) / 2);
    const PlacedLevel level = levels.placed_level(vertices);
    if (level.triangles.empty()) return;
    const ExactSurface coarse = surface_of(level);
    const double stored = errors.error_of(vertices);
    if (!std::isfinite(stored)) return;
    const Rational error = Rational(stored) - Rational(mesh.finest_error);
    unsigned number = 0;
    for (const auto& [from, to] : {std::pair{&finest, &coarse}, {&coarse, &finest}})
      for (const Triangle& t : from->triangles()) {
        if (number++ % 13 != 0) continue;
        for (const ExactPoint& p : points_of(from->corners(t), number)) ASSERT_TRUE(to->is_within(p, error));
      }
  });
}

// The levels that are left out, and the rounding of the model that is normalised anew without them.
TEST_F(StoredBounds, OfFewerTrianglesHold) {
  for (const char* name : {"plane", "crease", "negative", "far-away", "tiny", "huge", "long-triangles"}) {
    SCOPED_TRACE(name);
    const IndexedMesh input = prepared(hard_case(name));
    const ProgressiveMesh fewer = progressive(input, input.triangles.size() / 2);
    const auto in_model = [](std::span<const Vec3f> positions, std::vector<Triangle> triangles, const Transform& t,
                             const Transform& unit) {
      // Exactly, in units of the input about its origin.
      std::vector<ExactPoint> points;
      const Rational scale = Rational(t.scale) / Rational(unit.scale);
      const ExactPoint shift = Rational(1 / Rational(unit.scale)) * (exact(t.origin) - exact(unit.origin));
      for (const Vec3f p : positions) points.push_back(shift + scale * exact(p));
      return std::pair{points, std::move(triangles)};
    };
    const auto [from, triangles] = in_model(fewer.positions, fewer.triangles, fewer.transform, input.transform);
    std::vector<Vec3d> at;
    for (const Vec3f p : input.positions) at.push_back(to_double(p));
    const ExactSurface surface(at, input.triangles);
    const Rational error =
        Rational(fewer.finest_error) * Rational(fewer.transform.scale) / Rational(input.transform.scale);
    unsigned number = 0;
    for (const Triangle& t : triangles)
      for (const ExactPoint& p : points_of({from[t.v[0]], from[t.v[1]], from[t.v[2]]}, ++number))
        ASSERT_TRUE(surface.is_within(p, error)) << number;
  }
}

// ---- radii ----

// Against `long double`, whose tangent is right to 2^-63: a float has 2^-24.
TEST(StoredBoundsOfRadii, KeepTheToleranceAndTheBands) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int k = 0; k < 3000; ++k) {
    Hierarchy h;
    for (int l = 0; l < 5; ++l) {
      Level level;
      level.error = 0.3f * unit(random) + 1e-3f;
      level.reach = {1 + unit(random), 0.8f + 0.2f * unit(random)};
      h.levels.push_back(level);
    }
    RadiiConfig config;
    config.pixel_error = 0.1f + 4 * unit(random);
    config.delta = k % 3 == 0 ? unit(random) : 0;
    const ImageSize size{1 + static_cast<int>(random() % 4000), 1 + static_cast<int>(random() % 3000)};
    const double fov = 0.02 + 3.1 * double{unit(random)};
    config = for_picture(config, size, fov);
    const Radii radii = make_radii(h, config);
    ASSERT_TRUE(radii.admissible);
    const long double half = std::tan(static_cast<long double>(fov) / 2);
    const long double corner = 1 + half * half * (1 + std::pow(static_cast<long double>(size.width) / size.height, 2));
    for (std::size_t l = 0; l < 4; ++l) {
      const long double side = cell_size(static_cast<int>(l));
      const long double wanted = h.levels[l].error * side * size.height / (2 * config.pixel_error * half) * corner;
      EXPECT_GE(radii.select[l], wanted) << l;
      if (l == 0) continue;
      // The guard is for this: each of two distances is off by at most 3.5 halves of 2^-24.
      const long double rounding = 1 + 4 * 0x1p-24L, reach = h.levels[l].reach[0] + config.delta;
      EXPECT_GE(radii.band_begin[l], (radii.select[l] + reach * side) * rounding) << l;
      EXPECT_LE(radii.band_end[l] * rounding, radii.select[l - 1] - 2 * config.delta * side) << l;
    }
  }
}

}  // namespace
}  // namespace lodestone::test
