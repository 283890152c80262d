// The partition and the finest cells against a slow twin of maps and sets; same bytes for any number of workers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "core/hierarchy/construct/compact_order.h"
#include "core/hierarchy/model/fingerprint.h"
#include "parallel/hierarchy/finest_level.h"
#include "parallel/hierarchy/partition.h"
#include "parallel/hierarchy/vertex_stamps.h"
#include "tests/test_bytes.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

struct Case {
  const char* name;
  IndexedMesh (*mesh)();
  int level;
};

// Triangles and vertices in random order: every cell has a run in every chunk.
IndexedMesh shuffled(IndexedMesh mesh) {
  std::mt19937 random(7);
  std::vector<std::uint32_t> to(mesh.positions.size());
  for (std::uint32_t v = 0; v < to.size(); ++v) to[v] = v;
  std::shuffle(to.begin(), to.end(), random);
  const std::vector<Vec3f> positions = mesh.positions;
  for (std::size_t v = 0; v < to.size(); ++v) mesh.positions[to[v]] = positions[v];
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t.v) v = to[v];
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  return mesh;
}

IndexedMesh one_triangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5f}}, {{{0, 1, 2}}}, {}}; }

// Many cells, of which the one at the origin has more triangles than stamps can number.
IndexedMesh crowded_at_the_origin() {
  IndexedMesh mesh = test::sphere_mesh(7);
  const auto eighth_power = [](float x) { return std::pow(x, 8.0f); };
  for (Vec3f& p : mesh.positions) p = {eighth_power(p.x), eighth_power(p.y), eighth_power(p.z)};
  return mesh;
}

// Triangles apart from one another, all in the first cell, as many as stamps can number and `more`; and one elsewhere.
IndexedMesh apart(std::size_t more) {
  IndexedMesh mesh;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(0, 0.4f);
  for (std::uint32_t t = 0; t <= VertexStamps::most_triangles + more; ++t) {
    const Vec3f p = t == 0 ? Vec3f{0.7f, 0.7f, 0.7f} : Vec3f{place(random), place(random), place(random)};
    for (const Vec3f& q : {p, p + Vec3f{0.01f, 0, 0}, p + Vec3f{0, 0.01f, 0}}) mesh.positions.push_back(q);
    mesh.triangles.push_back({{3 * t, 3 * t + 1, 3 * t + 2}});
  }
  return mesh;
}

const Case cases[] = {
    {"OneTriangle", one_triangle, 3},
    {"RootAlone", [] { return test::sphere_mesh(4); }, 0},
    {"Sphere", [] { return test::sphere_mesh(7); }, 4},  // more than one chunk
    {"Shuffled", [] { return shuffled(test::sphere_mesh(7)); }, 4},
    {"LargeCellBesideSmall", crowded_at_the_origin, 4},
    {"AsManyAsStampsNumber", [] { return apart(0); }, 1},
    {"OneMoreThanStampsNumber", [] { return apart(1); }, 1},
    {"ManyCells", [] { return test::sphere_mesh(7); }, max_level},  // a cell or more for every triangle
    {"Torus", [] { return test::torus_mesh(40, 20); }, 2},
};

class Partitions : public testing::TestWithParam<Case> {};

// Triangles by cell, in input order.
std::map<CellCode, std::vector<Triangle>> naive_partition(const IndexedMesh& mesh, int level) {
  std::map<CellCode, std::vector<Triangle>> cells;
  for (const Triangle& t : mesh.triangles) {
    const Vec3f centre = barycentre(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]);
    cells[CellCode::from(cell_of(centre, level))].push_back(t);
  }
  return cells;
}

std::map<std::uint32_t, UsageBox> naive_usage(const std::map<CellCode, std::vector<Triangle>>& cells) {
  std::map<std::uint32_t, UsageBox> usage;
  for (const auto& [code, triangles] : cells)
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t.v) usage[v].extend(code.coord());
  return usage;
}

std::vector<Vec3d> naive_normals(const IndexedMesh& mesh) {
  std::vector<Vec3d> sums(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = to_double(mesh.positions[t.v[0]]);
    const Vec3d n = cross(to_double(mesh.positions[t.v[1]]) - a, to_double(mesh.positions[t.v[2]]) - a);
    for (const std::uint32_t v : t.v) sums[v] = sums[v] + n;
  }
  return sums;
}

TEST_P(Partitions, PutsTheTrianglesOfACellTogetherInInputOrder) {
  const IndexedMesh mesh = GetParam().mesh();
  const auto expected = naive_partition(mesh, GetParam().level);
  const auto scheduler = make_tbb_scheduler(3);
  const Partition partition = partition_mesh(IndexedMesh(mesh), GetParam().level, *scheduler);
  ASSERT_EQ(partition.codes.size(), expected.size());
  ASSERT_EQ(partition.cells.size(), expected.size());
  std::size_t c = 0;
  std::uint64_t fingerprint = 0;
  for (const auto& [code, triangles] : expected) {
    EXPECT_EQ(partition.codes[c], code);
    const CellBuild& cell = partition.cells[c++];
    ASSERT_EQ(cell.triangles.size(), triangles.size());
    std::uint32_t seen = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t local = cell.triangles[t].v[k];
        EXPECT_EQ(cell.ids.at(local), triangles[t].v[k]);
        EXPECT_LE(local, seen);  // numbered in order of appearance
        seen = std::max(seen, local + 1);
      }
      const auto& v = triangles[t].v;
      fingerprint += triangle_fingerprint(mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]);
    }
    EXPECT_EQ(seen, cell.ids.size());
  }
  EXPECT_EQ(partition.fingerprint, fingerprint);
}

// Rounded up, by no more than rounding.
void expect_rounded_up(float found, float expected) {
  EXPECT_NEAR(found, expected, 1e-6f * found);
  EXPECT_GE(found, expected);
}

// Triangles in the order that finest cells have, which test_compact_order tells.
std::vector<Triangle> in_compact_order(const std::vector<Triangle>& triangles, const std::vector<Float4>& places,
                                       CellCode code, int level) {
  std::vector<Triangle> sorted(triangles.size());
  CompactOrderScratch scratch;
  sort_compactly(triangles, places, code, level, sorted, scratch);
  return sorted;
}

void expect_edges(const CellBuild& cell, const std::vector<Triangle>& triangles, const std::vector<Vec3f>& positions,
                  int level, float sigma0) {
  const float limit = sigma0 * cell_size(level);
  float longest2 = 0;
  std::uint64_t over = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(cell.ids[cell.triangles[t].v[k]], triangles[t].v[k]);
      const Vec3f edge = positions[triangles[t].v[(k + 1) % 3]] - positions[triangles[t].v[k]];
      longest2 = std::max(longest2, dot(edge, edge));
      over += dot(edge, edge) > limit * limit;
    }
  EXPECT_EQ(cell.long_edges, over);
  expect_rounded_up(cell.max_edge, std::sqrt(longest2) / cell_size(level));
}

void expect_reach(const CellBuild& cell, int level) {
  const Box3f& box = cell.bounds;
  float farthest = 0, farthest_axis = 0;
  for (const Vec3f p : cell.slab.positions) {
    const Vec3f d{std::max(p.x - box.lo.x, box.hi.x - p.x), std::max(p.y - box.lo.y, box.hi.y - p.y),
                  std::max(p.z - box.lo.z, box.hi.z - p.z)};
    farthest = std::max(farthest, length(d));
    farthest_axis = std::max({farthest_axis, d.x, d.y, d.z});
  }
  expect_rounded_up(cell.reach[0], farthest / cell_size(level));
  expect_rounded_up(cell.reach[1], farthest_axis / cell_size(level));
}

TEST_P(Partitions, PacksEveryCellAsTheSlowTwinWould) {
  const IndexedMesh mesh = GetParam().mesh();
  const int level = GetParam().level;
  const float sigma0 = 0.5f;
  const auto by_cell = naive_partition(mesh, level);
  const auto usage = naive_usage(by_cell);
  const std::vector<Vec3d> normals = naive_normals(mesh);
  std::vector<Float4> places;
  for (const Vec3f p : mesh.positions) places.push_back(Float4{p.x, p.y, p.z, 0});
  const auto scheduler = make_tbb_scheduler(3);
  Partition partition = partition_mesh(IndexedMesh(mesh), level, *scheduler);
  const std::vector<Triangle> storage = std::move(partition.triangles);
  const std::vector<CellBuild> cells = make_finest_cells(std::move(partition), level, sigma0, *scheduler);
  std::size_t c = 0;
  for (const auto& [code, triangles] : by_cell) {
    const CellBuild& cell = cells[c++];
    Box3f box;
    for (std::size_t i = 0; i < cell.ids.size(); ++i) {
      const std::uint32_t v = cell.ids[i];
      const bool shared = usage.at(v).lo != usage.at(v).hi;
      ASSERT_EQ(shared, i >= cell.first_shared());
      EXPECT_EQ(cell.slab.positions[i], mesh.positions[v]);
      box.extend(mesh.positions[v]);
      if (shared) {
        EXPECT_EQ(cell.slab.shared_ids[i - cell.first_shared()], v);
        EXPECT_EQ(cell.usage[i - cell.first_shared()].lo, usage.at(v).lo);
        EXPECT_EQ(cell.usage[i - cell.first_shared()].hi, usage.at(v).hi);
      }
      const double size = length(normals[v]);
      const Vec3d normal = to_double(unpack_normal(cell.slab.normals[i]));
      EXPECT_TRUE(size == 0 || dot(normal, normals[v]) / size > 0.999999);
    }
    EXPECT_EQ(cell.bounds, box);
    expect_edges(cell, in_compact_order(triangles, places, code, level), mesh.positions, level, sigma0);
    expect_reach(cell, level);
    CellBuild measured;
    measured.bounds = box;
    measured.triangles = cell.triangles;
    measured.slab.positions = cell.slab.positions;
    measure_cell(measured, level, sigma0);
    EXPECT_EQ(cell.reach, measured.reach);
    EXPECT_EQ(cell.diameter, measured.diameter);
    EXPECT_EQ(cell.max_edge, measured.max_edge);
    EXPECT_EQ(cell.long_edges, measured.long_edges);
  }
}

std::string bytes(const IndexedMesh& mesh, int level, Scheduler& scheduler) {
  Partition partition = partition_mesh(IndexedMesh(mesh), level, scheduler);
  const std::vector<Triangle> triangles = std::move(partition.triangles);
  std::string out;
  test::append_bytes(out, triangles);
  test::append_bytes(out, partition.codes);
  for (const CellBuild& cell : make_finest_cells(std::move(partition), level, 0.2f, scheduler)) {
    test::append_bytes(out, cell.slab.positions);
    test::append_bytes(out, cell.slab.normals);
    test::append_bytes(out, cell.slab.shared_ids);
    test::append_bytes(out, cell.ids);
    test::append_bytes(out, cell.usage);
    test::append_bytes(out, cell.reach);
    test::append_bytes(out, std::span<const float>(&cell.max_edge, 1));
  }
  return out;
}

TEST_P(Partitions, AreTheSameBytesForAnyNumberOfWorkers) {
  const IndexedMesh mesh = GetParam().mesh();
  const std::string expected = bytes(mesh, GetParam().level, *make_serial_scheduler());
  for (const int threads : {1, 2, 3, 7})
    EXPECT_TRUE(expected == bytes(mesh, GetParam().level, *make_tbb_scheduler(threads))) << threads << " threads";
}

INSTANTIATE_TEST_SUITE_P(Meshes, Partitions, testing::ValuesIn(cases),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(ChooseFinestLevel, TakesTheLevelWhoseOccupiedCellsAreNearestToTheTarget) {
  const IndexedMesh mesh = test::sphere_mesh(6);  // few enough that the sample is all of it
  for (const std::uint32_t target : {1u, 30u, 300u, 3000u, 1'000'000u}) {
    int best = 0;
    double best_misfit = 1e9;
    for (int level = 0; level <= max_level; ++level) {
      const double mean =
          static_cast<double>(mesh.triangles.size()) / static_cast<double>(naive_partition(mesh, level).size());
      const double misfit = std::abs(std::log(mean / target));
      if (misfit < best_misfit) best = level, best_misfit = misfit;
    }
    EXPECT_EQ(choose_finest_level(mesh, target), best) << target;
  }
}

// On a plane, which has 4^l cells at level l: beyond some 40 million triangles most of its cells are in no sample.
TEST(ChooseFinestLevel, CountsTheCellsThatNoSampleSees) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> anywhere(0, 1);
  constexpr std::uint32_t side = 256;
  std::vector<CellCode> regular, drawn;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const auto on_grid = [](std::uint32_t k) { return (static_cast<float>(k) + 0.5f) / side; };
    regular.push_back(CellCode::from(cell_of({on_grid(i % side), on_grid(i / side), 0.3f}, max_level)));
    drawn.push_back(CellCode::from(cell_of({anywhere(random), anywhere(random), 0.3f}, max_level)));
  }
  for (const std::size_t triangles : {std::size_t{10'000'000}, std::size_t{60'000'000}, std::size_t{240'000'000},
                                      std::size_t{1'000'000'000}, std::size_t{1'000'000'000'000}}) {
    const double best = std::log(static_cast<double>(triangles) / 1200) / std::log(4.0);
    for (const auto& sample : {regular, drawn})
      EXPECT_EQ(finest_level_of(sample, triangles, 1200), std::lround(best)) << triangles;
  }
}

}  // namespace
}  // namespace lodestone
