// Real scans and hard files through the whole road: read, clean, build, write, open, verify.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/base/error.h"
#include "core/hierarchy/lode_file.h"
#include "core/hierarchy/verify.h"
#include "parallel/build.h"
#include "parallel/load.h"
#include "parallel/prepare.h"
#include "parallel/save.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

IndexedMesh clean_mesh(const fs::path& path, Scheduler& scheduler) {
  Repairs repairs;
  return prepare_mesh(load_mesh(path, scheduler), repairs, scheduler);
}

std::string failures(const VerifyReport& report) {
  std::string list;
  for (const VerifyCheck& check : report.checks)
    if (!check.passed) list += check.name + ": " + check.detail + "\n";
  return list;
}

class Scratch {
 public:
  Scratch() : folder_(fs::temp_directory_path() / ("lodestone_real_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Scratch() { fs::remove_all(folder_); }
  [[nodiscard]] fs::path operator/(const char* name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

class RealScan : public testing::TestWithParam<const char*> {};

TEST_P(RealScan, SameFileForAnyThreadsAndStrategyAndItVerifies) {
  LODESTONE_MODEL_OR_SKIP(path, GetParam());
  const Scratch scratch;
  const auto serial = make_serial_scheduler();
  BuildConfig config;
  config.cell_triangles = 1000;
  config.strategy = Strategy::serial;
  const IndexedMesh input = clean_mesh(path, *serial);
  save_lode(build_hierarchy(IndexedMesh(input), config, *serial), scratch / "serial.lode", *serial);
  const std::string expected = content(scratch / "serial.lode");
  EXPECT_EQ(failures(verify_hierarchy(open_lode(scratch / "serial.lode"), &input)), "");

  for (const int threads : {1, 2, 3, 7})
    for (const Strategy strategy : {Strategy::serial, Strategy::levels, Strategy::graph}) {
      const auto scheduler = make_tbb_scheduler(threads);
      config.strategy = strategy;
      save_lode(build_hierarchy(clean_mesh(path, *scheduler), config, *scheduler), scratch / "other.lode", *scheduler);
      EXPECT_TRUE(content(scratch / "other.lode") == expected) << threads << " threads, " << name_of(strategy);
    }
}

INSTANTIATE_TEST_SUITE_P(Scans, RealScan,
                         testing::Values("scans/armadillo.obj", "scans/dragon_vrip_res2.ply",
                                         "scans/rangemap_lato315.ply"),
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
      for (const SimplifierKind kind : {SimplifierKind::quadric, SimplifierKind::cluster}) {
        BuildConfig config;
        config.simplifier = kind;
        config.cell_triangles = 200;  // several levels also of small models
        const Hierarchy h = build_hierarchy(IndexedMesh(input), config, *scheduler);
        EXPECT_EQ(failures(verify_hierarchy(h, &input)), "") << name_of(kind);
      }
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
