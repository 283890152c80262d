// Hierarchies of meshes with attributes, from corners to the root.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "parallel/mesh/load.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

// Charts by octants around a shifted centre, one material each; in a chart the texture coordinate is the position on
// the xy plane, ten units apart from that of the next chart.
RawMesh charted(Shape shape, std::uint64_t triangles) {
  RawMesh raw = generate_mesh({shape, triangles, 3});
  const double shift = shape == Shape::terrain ? 0.4 : 0.1;
  std::uint32_t wedge = 0;
  for (const auto& [v] : raw.triangles) {
    const Vec3d p = (1.0 / 3) * (raw.positions[v[0]] + raw.positions[v[1]] + raw.positions[v[2]]);
    const std::uint32_t chart = (p.x > shift ? 1 : 0) + (p.y > shift ? 2 : 0) + (p.z > shift ? 4 : 0);
    raw.wedges.corners.push_back({{wedge, wedge + 1, wedge + 2}});
    wedge += 3;
    raw.wedges.material.push_back(chart);
    for (const std::uint32_t corner : v) {
      const Vec3f at = to_float(raw.positions[corner]);
      raw.wedges.uv.push_back({at.x + 10 * static_cast<float>(chart), at.y});
      const auto channel = [](float x) { return static_cast<std::uint8_t>(std::clamp(128 + 100 * x, 0.0f, 255.0f)); };
      raw.wedges.colour.push_back({channel(at.x), channel(at.y), channel(at.z), 255});
    }
  }
  for (int i = 0; i < 8; ++i) raw.materials.push_back({"chart " + std::to_string(i), {}, no_texture, no_texture});
  return raw;
}

struct Case {
  Shape shape;
  std::string simplifier;
};

class BuildWedges : public testing::TestWithParam<Case> {
 protected:
  static Hierarchy build(int threads, Strategy strategy) {
    const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
    Repairs repairs;
    BuildConfig config;
    config.cell_triangles = 150;
    config.sigma0 = 0.8f;
    config.strategy = strategy;
    config.simplifier = GetParam().simplifier;
    return build_hierarchy(prepare_mesh(charted(GetParam().shape, 20'000), repairs, *scheduler), config, *scheduler);
  }
};

TEST_P(BuildWedges, IsValidAndKeepsCharts) {
  const Hierarchy h = build(2, Strategy::graph);
  ASSERT_GE(h.finest(), 3);
  const VerifyReport report = verify_hierarchy(h);
  for (const VerifyCheck& check : report.checks) EXPECT_TRUE(check.passed) << check.name << ": " << check.detail;
  ASSERT_NE(report.find("wedges"), nullptr);
  EXPECT_LT(h.levels.front().triangles, h.levels.back().triangles / 20) << "seams do not stop it";
  for (const Cell& cell : h.cells) {
    for (std::size_t v = 0; v < cell.positions.size(); ++v) {
      const Vec3f p = to_float(h.transform.to_model(cell.positions[v]));
      const Vec2f uv = cell.attributes.uv[v];
      const float chart = 10 * static_cast<float>(cell.attributes.materials[v]);
      // As far as the surface has moved, and no farther.
      const float tolerance = 0.05f * static_cast<float>(h.transform.scale) + 1e-4f;
      EXPECT_NEAR(uv.x, p.x + chart, tolerance);
      EXPECT_NEAR(uv.y, p.y, tolerance);
    }
    for (std::size_t t = 1; t < cell.triangles.size(); ++t)
      EXPECT_LE(cell.attributes.materials[cell.triangles[t - 1].v[0]],
                cell.attributes.materials[cell.triangles[t].v[0]]);
  }
}

TEST_P(BuildWedges, DoesNotDependOnWorkersAndStrategy) {
  const Hierarchy one = build(0, Strategy::serial);
  for (const auto& [threads, strategy] : {std::pair{3, Strategy::graph}, std::pair{2, Strategy::levels}}) {
    const Hierarchy other = build(threads, strategy);
    ASSERT_EQ(one.cells.size(), other.cells.size());
    for (std::size_t c = 0; c < one.cells.size(); ++c) {
      const Cell &a = one.cells[c], &b = other.cells[c];
      EXPECT_TRUE(std::ranges::equal(a.positions, b.positions));
      EXPECT_TRUE(std::ranges::equal(a.triangles, b.triangles));
      EXPECT_TRUE(std::ranges::equal(a.parents, b.parents));
      EXPECT_TRUE(std::ranges::equal(a.attributes.uv, b.attributes.uv));
      EXPECT_TRUE(std::ranges::equal(a.attributes.colours, b.attributes.colours));
      EXPECT_TRUE(std::ranges::equal(a.attributes.materials, b.attributes.materials));
    }
  }
}

// Normals are those of the vertex, whatever wedges it has.
TEST_P(BuildWedges, LeavesNormalsAndShapeOfTheFinestLevelAlone) {
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  RawMesh bare = charted(GetParam().shape, 20'000);
  bare.wedges = {};
  bare.materials = {};
  BuildConfig config;
  config.cell_triangles = 150;
  const Hierarchy with = build(1, Strategy::graph),
                  without = build_hierarchy(prepare_mesh(std::move(bare), repairs, *scheduler), config, *scheduler);
  const auto corners = [](const Hierarchy& h) {
    std::vector<std::array<float, 8>> all;
    for (const Cell& cell : h.cells_of(h.finest()))
      for (const Triangle& t : cell.triangles)
        for (const std::uint32_t v : t.v) {
          const Vec3f p = cell.positions[v], n = unpack_normal(cell.normals[v]);
          all.push_back({p.x, p.y, p.z, n.x, n.y, n.z});
        }
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto a = corners(with), b = corners(without);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(a[i][k], b[i][k], 1e-3f);
}

// Plain and compressed, materials and textures included.
TEST_P(BuildWedges, SurvivesTheFile) {
  const auto scheduler = make_tbb_scheduler(2);
  Repairs repairs;
  BuildConfig config;
  config.cell_triangles = 150;
  config.simplifier = GetParam().simplifier;
  config.order_cells = true;
  RawMesh raw = charted(GetParam().shape, 5'000);
  raw.textures.push_back({"stone.png", "image/png", TextureWrap::clamp, TextureWrap::mirror, {'a', 'b', '\0', 'c'}});
  raw.materials[2].texture = 0;
  const Hierarchy h =
      build_hierarchy(prepare_mesh(std::move(raw), repairs, *scheduler, {}, Lattice{18}), config, *scheduler);
  const TestFolder folder;
  const std::filesystem::path path = folder / "wedges.lode";
  for (const LodeForm form : {LodeForm::plain, LodeForm::compressed}) {
    (void)save_lode(h, path, *scheduler, form);
    const Hierarchy read = load_lode(path, *scheduler);
    EXPECT_EQ(read.attributes, h.attributes);
    EXPECT_EQ(read.materials, h.materials);
    EXPECT_EQ(read.textures, h.textures);
    const VerifyReport report = verify_hierarchy(read);
    for (const VerifyCheck& check : report.checks) EXPECT_TRUE(check.passed) << check.name << ": " << check.detail;
    ASSERT_EQ(read.cells.size(), h.cells.size());
    for (std::size_t c = 0; c < h.cells.size(); ++c) {
      EXPECT_TRUE(std::ranges::equal(read.cells[c].positions, h.cells[c].positions));
      EXPECT_TRUE(std::ranges::equal(read.cells[c].attributes.uv, h.cells[c].attributes.uv));
      EXPECT_TRUE(std::ranges::equal(read.cells[c].attributes.colours, h.cells[c].attributes.colours));
      EXPECT_TRUE(std::ranges::equal(read.cells[c].attributes.materials, h.cells[c].attributes.materials));
    }
    std::string parallel = content(path);
    write_lode(h, path, form);
    EXPECT_TRUE(content(path) == parallel) << "the parallel writer writes the same bytes";
    parallel.back() ^= 1;  // inside the assets
    folder.write("wedges.lode", parallel);
    EXPECT_THROW((void)load_lode(path, *scheduler), InputError);
  }
}

TEST_P(BuildWedges, LevelsComeOutWithTheirAttributes) {
  const Hierarchy h = build(2, Strategy::graph);
  for (const int level : {0, h.finest()}) {
    const RawMesh mesh = level_mesh(h, level);
    ASSERT_EQ(mesh.triangles.size(), h.levels[static_cast<std::size_t>(level)].triangles);
    ASSERT_EQ(mesh.wedges.uv.size(), mesh.positions.size());
    ASSERT_EQ(mesh.wedges.normal.size(), mesh.positions.size());
    ASSERT_EQ(mesh.wedges.colour.size(), mesh.positions.size());
    ASSERT_EQ(mesh.wedges.material.size(), mesh.triangles.size());
    EXPECT_EQ(mesh.materials, h.materials);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t].v)
        EXPECT_NEAR(mesh.wedges.uv[v].x, 10.0 * mesh.wedges.material[t] + mesh.positions[v].x,
                    0.05 * h.transform.scale + 1e-4);
  }
}

// Each fault of its own kind is found by the check of wedges.
TEST_P(BuildWedges, FaultsAreFound) {
  const Hierarchy sound = build(2, Strategy::graph);
  const auto is_found = [&](const auto& breakage) {
    Hierarchy broken = sound;
    Cell& cell = broken.cells.back();
    std::vector<Vec2f> uv(cell.attributes.uv.begin(), cell.attributes.uv.end());
    std::vector<std::uint32_t> materials(cell.attributes.materials.begin(), cell.attributes.materials.end());
    std::vector<std::uint32_t> parents(cell.parents.begin(), cell.parents.end());
    cell.attributes.uv = uv;
    cell.attributes.materials = materials;
    cell.parents = parents;
    breakage(uv, materials, parents, cell);
    const VerifyReport report = verify_hierarchy(broken);
    return !report.find("wedges")->passed;
  };
  using Uv = std::vector<Vec2f>;
  using Ids = std::vector<std::uint32_t>;
  EXPECT_FALSE(is_found([](Uv&, Ids&, Ids&, const Cell&) {}));
  EXPECT_TRUE(is_found([](Uv& uv, Ids&, Ids&, const Cell&) { uv[0].y = std::nanf(""); }));
  EXPECT_TRUE(is_found([](Uv&, Ids& materials, Ids&, const Cell&) { materials[0] = 99; }));
  EXPECT_TRUE(is_found([](Uv&, Ids& materials, Ids&, const Cell& cell) {
    const std::uint32_t v = cell.triangles[0].v[0];
    materials[v] = materials[v] == 0 ? 1 : 0;
  }));
}

// Wedges of one vertex must not part.
TEST_P(BuildWedges, PartingWedgesAreFound) {
  Hierarchy broken = build(2, Strategy::graph);
  for (const Cell& cell : broken.cells_of(broken.finest())) {
    const Cell& above = broken.cells[cell.parent];
    for (std::size_t a = 0; a < cell.positions.size(); ++a)
      for (std::size_t b = a + 1; b < cell.positions.size(); ++b) {
        if (cell.positions[a] != cell.positions[b]) continue;
        std::vector<std::uint32_t> parents(cell.parents.begin(), cell.parents.end());
        const auto parts = [&](std::uint32_t other) {  // and of the same material, which is looked at, too
          return above.positions[other] != above.positions[parents[b]] &&
                 above.attributes.materials[other] == above.attributes.materials[parents[b]];
        };
        std::uint32_t other = 0;
        while (other < above.positions.size() && !parts(other)) ++other;
        if (other == above.positions.size()) continue;
        parents[b] = other;
        const auto index = static_cast<std::size_t>(&cell - broken.cells.data());
        broken.cells[index].parents = parents;
        const VerifyReport report = verify_hierarchy(broken);
        EXPECT_NE(report.find("wedges")->detail.find("than that of another wedge there"), std::string::npos);
        return;
      }
  }
  FAIL() << "no vertex has two wedges";
}

INSTANTIATE_TEST_SUITE_P(All, BuildWedges,
                         testing::Values(Case{Shape::sphere, "quadric"}, Case{Shape::terrain, "quadric"},
                                         Case{Shape::box, "quadric"}, Case{Shape::sphere, "cluster"}),
                         [](const auto& param) { return std::to_string(param.index); });

TEST(BuildNormals, OfTheInputAreKept) {
  RawMesh raw = generate_mesh({Shape::sphere, 2000, 1});
  for (std::size_t v = 0; v < raw.positions.size(); ++v)
    raw.wedges.normal.push_back(v % 2 == 0 ? Vec3f{0, 0, 1} : Vec3f{});
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  const Hierarchy h = build_hierarchy(prepare_mesh(std::move(raw), repairs, *scheduler), {}, *scheduler);
  std::size_t kept = 0, all = 0;
  for (const Cell& cell : h.cells_of(h.finest()))
    for (const PackedNormal n : cell.normals) kept += n == pack_normal({0, 0, 1}), ++all;
  EXPECT_NEAR(static_cast<double>(kept), 0.5 * static_cast<double>(all), 0.05 * static_cast<double>(all));
}

}  // namespace
}  // namespace lodestone
