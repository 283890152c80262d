// Real scans and hard files through the whole road: read, clean, build, write, open, verify.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/verify/verify.h"
#include "experiments/metrics/cracks/cracks.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "parallel/mesh/load.h"
#include "tests/experiments/lod_frames.h"
#include "tests/test_data.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

IndexedMesh clean_mesh(const fs::path& path, Scheduler& scheduler, Lattice lattice = {}) {
  Repairs repairs;
  return prepare_mesh(load_mesh(path, scheduler), repairs, scheduler, {}, lattice);
}

std::string failures(const VerifyReport& report) {
  std::string list;
  for (const VerifyCheck& check : report.checks)
    if (!check.passed) list += check.name + ": " + check.detail + "\n";
  return list;
}

// No crack in frames from random viewpoints.
void expect_whole(const Hierarchy& h, Scheduler& scheduler) {
  const auto basis = make_crack_basis(h, scheduler);
  CrackScratch memory;
  const Radii radii = testing::per_level_radii(h, DistanceMetric::euclidean, 0.01f);
  ASSERT_TRUE(radii.admissible);
  for (const Vec3f view : testing::random_viewpoints(h, 10, 3)) {
    const testing::Frame f = testing::make_frame(h, radii, Blend::smoothstep, view);
    EXPECT_EQ(residual_edges(f.context, f.selection, *basis, scheduler, memory).open_edges, 0u);
    EXPECT_EQ(vertex_gaps(f.context, f.selection, *basis, scheduler, memory).gap_max, 0);
  }
}

class RealScan : public ::testing::TestWithParam<const char*> {};

TEST_P(RealScan, SameFileForAnyThreadsAndStrategyAndItVerifies) {
  LODESTONE_MODEL_OR_SKIP(path, GetParam());
  const TestFolder folder;
  const auto serial = make_serial_scheduler();
  BuildConfig config;
  config.cell_triangles = 1000;
  config.strategy = Strategy::serial;
  const IndexedMesh input = clean_mesh(path, *serial);
  save_lode(build_hierarchy(IndexedMesh(input), config, *serial), folder.path() / "serial.lode", *serial);
  const std::string expected = content(folder.path() / "serial.lode");
  EXPECT_EQ(failures(verify_hierarchy(open_lode(folder.path() / "serial.lode"), &input)), "");

  for (const int threads : {1, 2, 3, 7})
    for (const Strategy strategy : {Strategy::serial, Strategy::levels, Strategy::graph}) {
      const auto scheduler = make_tbb_scheduler(threads);
      config.strategy = strategy;
      save_lode(build_hierarchy(clean_mesh(path, *scheduler), config, *scheduler), folder.path() / "other.lode",
                *scheduler);
      EXPECT_TRUE(content(folder.path() / "other.lode") == expected) << threads << " threads, " << name_of(strategy);
    }
}

INSTANTIATE_TEST_SUITE_P(Scans, RealScan,
                         ::testing::Values("textured/Gutenberg/Gutenberg.obj", "scans/armadillo.obj",
                                           "scans/dragon_vrip_res2.ply", "scans/rangemap_lato315.ply"),
                         [](const auto& param) { return std::to_string(param.index); });

class CompressedScan : public ::testing::TestWithParam<const char*> {};

TEST_P(CompressedScan, VerifiesAndIsSmallAndDoesNotCrack) {
  LODESTONE_MODEL_OR_SKIP(path, GetParam());
  const TestFolder folder;
  const auto scheduler = make_tbb_scheduler(2);
  const IndexedMesh input = clean_mesh(path, *scheduler, {Lattice::automatic});
  BuildConfig config;
  config.order_cells = true;
  const Hierarchy built = build_hierarchy(IndexedMesh(input), config, *scheduler);
  const std::uint64_t bytes = save_lode(built, folder.path() / "model.lode", *scheduler, LodeForm::compressed);
  const Hierarchy h = load_lode(folder.path() / "model.lode", *scheduler);
  EXPECT_EQ(failures(verify_hierarchy(h, &input)), "");
  std::uint64_t triangles = 0;
  for (const Level& level : h.levels) triangles += level.triangles;
  EXPECT_LT(static_cast<double>(bytes), 12.0 * static_cast<double>(triangles));

  const auto serial = make_serial_scheduler();
  save_lode(build_hierarchy(clean_mesh(path, *serial, {Lattice::automatic}), config, *serial),
            folder.path() / "other.lode", *serial, LodeForm::compressed);
  EXPECT_TRUE(content(folder.path() / "other.lode") == content(folder.path() / "model.lode"));
  expect_whole(h, *scheduler);
}

INSTANTIATE_TEST_SUITE_P(Scans, CompressedScan,
                         ::testing::Values("scans/armadillo.obj", "scans/igea.ply", "scans/dragon_vrip_res2.ply",
                                           "cad/tower_holes.obj", "scans/rangemap_lato315.ply"),
                         [](const auto& param) { return std::to_string(param.index); });

class TexturedModel : public ::testing::TestWithParam<const char*> {};

// Seams, several materials, surfaces that lie upon each other: all levels keep their charts, and none cracks.
TEST_P(TexturedModel, KeepsItsChartsAndDoesNotCrack) {
  LODESTONE_MODEL_OR_SKIP(path, GetParam());
  const auto scheduler = make_tbb_scheduler(2);
  const IndexedMesh input = clean_mesh(path, *scheduler);
  ASSERT_FALSE(input.wedges.uv.empty());
  BuildConfig config;
  config.cell_triangles = 500;
  const Hierarchy h = build_hierarchy(IndexedMesh(input), config, *scheduler);
  ASSERT_GE(h.finest(), 1);
  const VerifyReport report = verify_hierarchy(h, &input);
  ASSERT_NE(report.find("wedges"), nullptr);
  EXPECT_EQ(failures(report), "");
  expect_whole(h, *scheduler);
}

INSTANTIATE_TEST_SUITE_P(Models, TexturedModel,
                         ::testing::Values("textured/Gutenberg/Gutenberg.obj", "textured/Nymph/Nymph.obj",
                                           "textured/meshroom_esp32cam/texturedMesh.obj",
                                           "textured/ycb_Banana/textured_simple_reoriented.obj",
                                           "textured/komaba_tiles_022"),
                         [](const auto& param) { return std::to_string(param.index); });

// Everything in the folder of hard files either builds and verifies, with both simplifiers, or is refused with a line
// that names the file.
TEST(HardModels, BuildAndVerifyOrAreRefusedClearly) {
  LODESTONE_MODEL_OR_SKIP(probe, "hard/empty.ply");
  const auto scheduler = make_tbb_scheduler();
  int built = 0, refused = 0;
  for (const auto& entry : fs::directory_iterator(probe.parent_path())) {
    const std::string name = entry.path().filename().string();
    SCOPED_TRACE(name);
    try {
      Repairs repairs;
      RawMesh raw = load_mesh(entry.path(), *scheduler);
      const IndexedMesh input = prepare_mesh(std::move(raw), repairs, *scheduler);
      for (const std::string kind : {"quadric", "cluster"}) {
        BuildConfig config;
        config.simplifier = kind;
        config.cell_triangles = 200;  // several levels also of small models
        const Hierarchy h = build_hierarchy(IndexedMesh(input), config, *scheduler);
        EXPECT_EQ(failures(verify_hierarchy(h, &input)), "") << kind;
      }
      BuildConfig config;
      config.order_cells = true;
      config.cell_triangles = 200;
      const IndexedMesh on_lattice = clean_mesh(entry.path(), *scheduler, {Lattice::automatic});
      const TestFolder folder;
      save_lode(build_hierarchy(IndexedMesh(on_lattice), config, *scheduler), folder.path() / "hard.lode", *scheduler,
                LodeForm::compressed);
      EXPECT_EQ(failures(verify_hierarchy(open_lode(folder.path() / "hard.lode"), &on_lattice)), "");
      ++built;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()), "");
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GE(built, 15);
  EXPECT_GE(refused, 5);
}

}  // namespace
}  // namespace lodestone
