// Hierarchies built out of core: the same files as in memory, whatever the memory and the workers.
#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/verify/verify.h"
#include "core/mesh/generate.h"
#include "core/simplify/simplifiers.h"
#include "parallel/mesh/mesh_stream.h"
#include "tests/parallel/out_of_core/out_of_core.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

using namespace testing;

TEST_F(OutOfCore, SameBytesForAnyThreadsAndStrategy) {
  const fs::path path = sphere();
  const std::string expected = in_memory(path);
  for (const int threads : {0, 1, 2, 3, 7})
    for (const Strategy strategy : {Strategy::serial, Strategy::levels, Strategy::graph}) {
      config_.build.strategy = strategy;
      EXPECT_TRUE(expected == built(path, threads)) << threads << " threads, " << name_of(strategy);
    }
}

// The entry for both forms chooses by the limit; the bytes tell nothing of the choice.
TEST_F(OutOfCore, TheLimitAloneChoosesBetweenMemoryAndDisk) {
  const fs::path path = sphere();
  const std::string expected = in_memory(path);
  const auto scheduler = make_tbb_scheduler(2);
  const ModelSource in_core = open_model_source({path}, {}, config_.memory_limit, 2);
  EXPECT_EQ(in_core.stream, nullptr);
  EXPECT_EQ(open_model_source({path}, {}, 0, 2).stream, nullptr);
  EXPECT_NE(open_model_source({path}, {}, std::uint64_t{20} << 20, 2).stream, nullptr);
  std::vector<std::string> steps;
  config_.progress = [&](const ModelProgress& now) {
    if (steps.empty() || steps.back() != now.step) steps.push_back(now.step);
  };
  const ModelResult result = build_model(in_core, config_, *scheduler);
  EXPECT_EQ(steps, (std::vector<std::string>{"reading", "welding", "building", "writing"}));
  for (const char* stage : {"read", "weld", "partition", "hierarchy", "build", "write"})
    EXPECT_TRUE(result.report.stages.contains(stage)) << stage;
  EXPECT_EQ(result.file_bytes, fs::file_size(config_.output));
  EXPECT_TRUE(expected == content(config_.output));
}

TEST_F(OutOfCore, SeveralFilesAreOneMesh) {
  const fs::path first = sphere();
  const RawMesh other = generate_mesh({Shape::torus, 30'000, 2});
  write_mesh(folder_ / "second.stl", other);
  const std::vector<fs::path> files{first, folder_ / "second.stl"};
  const auto scheduler = make_tbb_scheduler(2);
  const ModelSource on_disk = open_model_source(files, {}, std::uint64_t{20} << 20, 2);
  ASSERT_NE(on_disk.stream, nullptr);
  (void)build_model(on_disk, config_, *scheduler);
  const std::string built_on_disk = content(config_.output);
  (void)build_model(open_model_source(files, {}, 0, 2), config_, *scheduler);
  EXPECT_TRUE(built_on_disk == content(config_.output));
  EXPECT_EQ(load_lode(config_.output, *scheduler).provenance.input_triangles,
            load_mesh(first, *scheduler).triangles.size() + other.triangles.size());
  // A file that is read as a whole, beside others.
  EXPECT_THROW((void)open_model_source({first, test_folder_.write("a.off", std::string(2000, '#'))}, {}, 1000, 2),
               ResourceError);
}

// A small input needs more on disk than in memory: the message asks for what the build in memory needs.
TEST_F(OutOfCore, AMeshInMemoryIsBuiltAsItsFileIs) {
  const fs::path path = sphere(), output = std::exchange(config_.output, {});
  config_.memory_limit = 1;  // of no concern to a mesh that is there
  const auto scheduler = make_tbb_scheduler(2);
  const ModelResult result = build_model(load_mesh(path, *scheduler), "mesh", config_, *scheduler);
  EXPECT_EQ(result.file_bytes, 0u);
  EXPECT_FALSE(fs::exists(output));
  save_lode(result.hierarchy, output, *scheduler);
  EXPECT_EQ(content(output), in_memory(path));
}

TEST_F(OutOfCore, NamesTheSmallerNeed) {
  const fs::path path = sphere();
  const auto scheduler = make_serial_scheduler();
  config_.memory_limit = std::uint64_t{5} << 20;
  try {
    (void)build_model(open_model_source({path}, {}, config_.memory_limit, 1), config_, *scheduler);
    FAIL() << "5 MiB are not enough";
  } catch (const ResourceError& error) {
    const std::string message = error.what();
    config_.memory_limit = std::stoull(message.substr(message.find("--memory-limit ") + 15)) << 20;
  }
  const ModelSource source = open_model_source({path}, {}, config_.memory_limit, 1);
  EXPECT_EQ(source.stream, nullptr) << "built in memory";
  EXPECT_NO_THROW((void)build_model(source, config_, *scheduler));
}

// A file that can only be read as a whole is refused by its size before it is read.
TEST_F(OutOfCore, RefusesWholeFilesBeyondTheLimit) {
  const fs::path path = folder_ / "m.obj";
  write_mesh(path, test::sphere_mesh(5));
  EXPECT_THROW((void)open_model_source({path}, {}, 1000, 2), ResourceError);
  const auto scheduler = make_serial_scheduler();
  config_.memory_limit = std::uint64_t{1} << 20;
  EXPECT_THROW((void)build_model(open_model_source({path}, {}, config_.memory_limit, 2), config_, *scheduler),
               ResourceError);
}

TEST_F(OutOfCore, SameBytesForPartsOfAnySize) {
  const fs::path path = mesh(test::with_faults(test::raw_of(test::terrain_mesh(60)), 1));
  const std::string expected = in_memory(path);
  for (const std::uint64_t part : {50u, 777u, 70000u, 0u}) {
    config_.part_triangles = part;
    EXPECT_TRUE(expected == built(path)) << part;
  }
}

TEST_F(OutOfCore, SameBytesForFaultyAndShuffledMeshesOfEverySimplifier) {
  const fs::path path = mesh(test::with_faults(test::raw_of(test::sphere_mesh(5)), 2));
  for (const std::string& kind : simplifier_names()) {
    config_.build.simplifier = kind;
    EXPECT_TRUE(in_memory(path) == built(path)) << kind;
  }
}

TEST_F(OutOfCore, SameBytesForMoreTrianglesThanAPieceHas) {
  const fs::path path = mesh(test::with_faults(test::raw_of(test::terrain_mesh(320)), 3));
  config_.build.cell_triangles = 2000;
  config_.part_triangles = 150'000;
  EXPECT_TRUE(in_memory(path) == built(path));
  config_.part_triangles = 0;
  EXPECT_TRUE(in_memory(path) == built(path));
}

TEST_F(OutOfCore, SameBytesForAnyNumberOfLevels) {
  const fs::path path = sphere();
  for (const bool halves : {false, true})
    for (const int level : {-1, 0, 1, 2, 5}) {
      config_.build.half_levels = halves;
      config_.build.finest_level = level;
      EXPECT_TRUE(in_memory(path) == built(path)) << level;
    }
}

TEST_F(OutOfCore, SameBytesCompressedAndOrdered) {
  const fs::path path = sphere();
  config_.lattice = {Lattice::automatic};
  for (const LodeForm form : {LodeForm::plain, LodeForm::compressed})
    for (const bool order : {false, true}) {
      config_.form = form;
      config_.build.order_cells = order;
      for (const int threads : {1, 3}) EXPECT_TRUE(in_memory(path) == built(path, threads)) << order;
    }
}

// Covers the hard files that can be read as streams.
TEST_F(OutOfCore, SameBytesForHardFiles) {
  LODESTONE_MODEL_OR_SKIP(folder, "hard");
  int compared = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::unique_ptr<MeshStream> stream;
    try {
      stream = open_mesh_stream(entry.path());
    } catch (const Error&) {  // no mesh
    }
    if (!stream || stream->has_attributes()) continue;
    EXPECT_TRUE(in_memory(entry.path()) == built(entry.path())) << entry.path();
    ++compared;
  }
  EXPECT_GT(compared, 4);
}

TEST_F(OutOfCore, FileVerifies) {
  const fs::path path = sphere();
  (void)built(path);
  const auto scheduler = make_tbb_scheduler(2);
  Repairs repairs;
  const IndexedMesh input = prepare_mesh(load_mesh(path, *scheduler), repairs, *scheduler);
  EXPECT_TRUE(verify_hierarchy(open_lode(folder_ / "m.lode"), &input).valid());
}

// The number of blocks in memory is as large as the limit allows.
TEST_F(OutOfCore, SameBytesWithBarelyEnoughMemory) {
  const fs::path path = sphere();
  const std::string expected = in_memory(path);
  config_.part_triangles = 0;
  config_.memory_limit = std::uint64_t{10} << 20;
  std::string message;
  for (int attempt = 0; attempt < 2; ++attempt) {  // first the need in general, then that of the blocks
    try {
      EXPECT_TRUE(expected == built(path, 7));
      break;
    } catch (const ResourceError& error) {
      message = error.what();
      EXPECT_EQ(files(), (std::vector<std::string>{"expected.lode", "m.ply"}));
      const std::size_t at = message.find("--memory-limit ");
      ASSERT_NE(at, std::string::npos) << message;
      config_.memory_limit = std::stoull(message.substr(at + 15)) << 20;
    }
  }
  EXPECT_NE(message.find("m.ply"), std::string::npos) << message;
  EXPECT_TRUE(expected == built(path, 7));
}

TEST_F(OutOfCore, RefusesWhatCannotBeDone) {
  const fs::path path = sphere();
  const auto scheduler = make_serial_scheduler();
  config_.build.sigma0 = 3;
  EXPECT_THROW((void)build(path, *scheduler), InputError);
  config_.build.sigma0 = 1;
  config_.build.refine = true;
  EXPECT_THROW((void)build(path, *scheduler), UnsupportedError);
  config_.build.refine = false;
  config_.measure_errors = true;
  EXPECT_THROW((void)build(path, *scheduler), UnsupportedError);
  config_.measure_errors = false;
  config_.scratch = folder_ / "nowhere";
  EXPECT_THROW((void)build(path, *scheduler), FileError);
  config_.resume = true;
  EXPECT_THROW((void)build(path, *scheduler), FileError);
  EXPECT_EQ(files(), (std::vector<std::string>{"m.ply"}));
}

TEST_F(OutOfCore, ReportsStagesProgressAndScratch) {
  const fs::path path = sphere();
  const auto scheduler = make_tbb_scheduler(2);
  std::vector<std::string> steps;
  config_.progress = [&](const ModelProgress& now) {
    EXPECT_TRUE(now.share >= 0 && now.share <= 1) << now.share;
    if (steps.empty() || steps.back() != now.step) steps.push_back(now.step);
  };
  const ModelResult result = build(path, *scheduler);
  EXPECT_EQ(steps, (std::vector<std::string>{"reading", "sorting", "sharing", "building", "writing"}));
  for (const char* stage : {"clean", "spill", "shared", "hierarchy", "write"})
    EXPECT_TRUE(result.report.stages.contains(stage)) << stage;
  double building = 0, processors = 0;  // without reading and writing
  for (const char* stage : {"spill", "shared", "hierarchy"}) {
    building += result.report.stages.at(stage).seconds;
    processors += result.report.stages.at(stage).cpu_seconds;
  }
  EXPECT_DOUBLE_EQ(result.report.total.seconds, building);
  EXPECT_DOUBLE_EQ(result.report.total.cpu_seconds, processors);
  EXPECT_EQ(result.file_bytes, fs::file_size(folder_ / "m.lode"));
  EXPECT_GT(result.scratch_bytes, 12 * result.hierarchy.provenance.input_triangles);
  EXPECT_EQ(result.blocks_resumed, 0u);
  EXPECT_EQ(files(), (std::vector<std::string>{"m.lode", "m.ply"}));
}

}  // namespace
}  // namespace lodestone
