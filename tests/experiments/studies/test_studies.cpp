// Every experiment, run on a small surface: its rows have the columns that it declares, verify() accepts them, and
// refuses each kind of row that is wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "experiments/studies/experiment.h"
#include "experiments/sweep/run_folder.h"
#include "tests/expect_error.h"
#include "tests/experiments/studies/study_case.h"

namespace lodestone {
namespace {

struct Lie {
  std::string column;
  Row value;
};

// An experiment with settings that are quick and have something in every column, and what it must not get away with.
struct Case {
  std::string experiment;
  Row parameters;
  std::vector<Lie> lies;
};

const Row picture = {{"width", 64}, {"height", 48}};

const std::vector<Case> cases = {
    {"build",
     with(shallow, {{"threads", 2}, {"rounds", 2}, {"error_level", 1}, {"measure_error", true}, {"compress", true}}),
     {{"valid", false},
      {"failed_checks", "parents"},
      {"hash", "0000000000000000"},
      {"fingerprint", ""},
      {"seconds", 0},
      {"seconds_min", 1e9},
      {"stored_triangles", 1},
      {"error_mean", 1e3},
      {"slivers", 101},
      {"level_distance", 1},
      {"normal_mean", 181}}},
    {"distributed",
     with(shallow, {{"ranks", 2}, {"rounds", 1}}),
     {{"same", false},
      {"hash", ""},
      {"seconds", 0},
      {"clean_bytes", 0},
      {"bytes_per_triangle", 1},
      {"imbalance_cpu", 0.9},
      {"imbalance_triangles", 2.1},
      {"over_one", 100},
      {"first_peak_bytes", 0}}},
    {"effects",
     with(picture, {{"rounds", 1}, {"frames", 3}}),
     {{"effects", "other"}, {"frame_ms", -1}, {"gain_ms_min", 1e9}}},
    {"families",
     with(shallow, {{"rounds", 1}, {"level_count", 1}, {"peers", true}}),
     {{"family", "progressive"}, {"triangles", 1}, {"rms", 1e3}, {"cpu_seconds", Row()}}},
    {"flight",
     with(with(shallow, picture), {{"frames", 4}, {"image", true}, {"kappa0", 1.0}, {"backend", "soft"}}),
     {{"open_edges", 1},
      {"gap_max", 1e-9},
      {"torn_pixels", 1},
      {"jump_over_bound", 1.01},
      {"jump_p99", 1e3},
      {"admissible", Row()},
      {"ssim", 1.1},
      {"pop_p99", 101},
      {"pop_p50", 100},
      {"flip_pop_changed", 101},
      {"gap_mean_pixels", 1},
      {"triangles", 1e9}}},
    {"progressive",
     {{"rounds", 1}, {"level_count", 2}},
     {{"residual_edges", 1}, {"same", false}, {"hash", Row()}, {"base_triangles", 1e9}, {"error_p99", 1e3}}},
    {"ranks",
     with(shallow, {{"virtual_ranks", 8}}),
     {{"ranks", 1},
      {"busy_ranks", 9},
      {"most_triangles", 1},
      {"level_imbalance", 0.5},
      {"moved_bytes", 1},
      {"largest_message", 1e9},
      {"most_border_vertices", 1e9},
      {"first_rank_bytes", 1}}},
    {"raster",
     with(with(shallow, picture), {{"frames", 3}, {"rounds", 1}, {"measured_frames", 2}, {"camera", "orbit"}}),
     {{"same", false}, {"hash", ""}, {"screen_error", 3}, {"frame_ms_max", 0}, {"flip_worst", 2}, {"flip", 1}}},
    {"reconstruct",
     {{"rounds", 1}, {"resolution", 32}},
     {{"manifold", false}, {"same", false}, {"triangles", 0}, {"coverage", 101}, {"seconds_max", 0}}},
    {"scaling",
     with(shallow, {{"threads", 2}, {"rounds", 2}}),
     {{"same", false},
      {"hash", "0000000000000000"},
      {"processors", 3},
      {"speedup", 7},
      {"efficiency", 1},
      {"seconds", Row()}}},
    {"schedule",
     with(shallow, {{"threads", 2}, {"rounds", 1}, {"array", 1}}),
     {{"predicted", 0}, {"slowdown", 0.5}, {"hash", ""}, {"span", 1e9}, {"workers", -1}}},
    {"shells",
     {{"rounds", 1}, {"target", 2000}},
     {{"manifold", false}, {"closed", false}, {"triangles", 1e9}, {"seen_coverage", 101}, {"seconds_max", 0}}},
    {"spherical",
     {{"texture", 32}, {"maps", "geometry,normal,colour"}},
     {{"flips", 1},
      {"residual_edges", 1},
      {"same", false},
      {"hash", ""},
      {"efficiency", 1.5},
      {"texture_sliding", 1.5}}},
    {"systems",
     with(with(shallow, picture), {{"frames", 3}}),
     {{"open_edges", 1}, {"gap_pixels", 1}, {"jump_over_bound", 1.01}, {"frame_ms", Row()}, {"image_error", 101}}},
    {"table",
     shallow,
     {{"valid", false},
      {"failed_checks", "parents"},
      {"fingerprint", Row()},
      {"stored_triangles", 1},
      {"seconds", 1e9},
      {"read_seconds", 1e9},
      {"weld_seconds", 1e9},
      {"write_seconds", 1e9},
      {"spill_seconds", 1e9},
      {"cpu_seconds", 1e9},
      {"file_seconds", 0},
      {"out_of_core", true}}},
};

// Two start lodestone-mpi, which LODESTONE_MPI names where it is built.
bool lacks_program(const std::string& experiment) {
  return (experiment == "distributed" || experiment == "ranks") && std::getenv("LODESTONE_MPI") == nullptr;
}

class EachStudy : public Studies, public ::testing::WithParamInterface<Case> {};

TEST_P(EachStudy, HasItsColumnsVerifiesAndRefusesWrongRows) {
  const auto& [name, given, lies] = GetParam();
  if (lacks_program(name)) GTEST_SKIP() << "lodestone-mpi is not built";
  const std::vector<Row> rows = rows_of(name, given);
  EXPECT_EQ(joined(faults(name, given, rows)), "");
  for (const ColumnInfo& column : find_experiment(name).columns)
    EXPECT_TRUE(std::ranges::any_of(rows, [&](const Row& row) { return row.contains(column.name); })) << column.name;
  for (const std::filesystem::path& file : std::filesystem::directory_iterator(folder_))
    EXPECT_TRUE(is_picture(file) || file == sphere_ || file == scene_) << file;

  EXPECT_NE(joined(faults(name, given, {})), "");
  std::vector<Lie> all = lies;
  all.push_back({"no_such_column", 1});
  all.push_back({find_experiment(name).columns.front().name, {1, 2}});
  for (const auto& [column, value] : all) {
    // Compared between numbers of workers, of which a build without oneTBB has one.
    if (name == "scaling" && column == "hash" && rows.size() == 1) continue;
    std::vector<Row> tampered = rows;
    tampered.back()[column] = value;
    EXPECT_NE(joined(faults(name, given, tampered)), "") << column << " = " << value.dump();
  }
}

TEST_P(EachStudy, LaterRepetitionsVerify) {
  const auto& [name, given, lies] = GetParam();
  if (lacks_program(name)) GTEST_SKIP() << "lodestone-mpi is not built";
  EXPECT_EQ(joined(faults(name, given, rows_of(name, given, 1))), "");
}

INSTANTIATE_TEST_SUITE_P(All, EachStudy, ::testing::ValuesIn(cases),
                         [](const auto& param) { return param.param.experiment; });

TEST(StudyList, HasACaseForEach) {
  std::set<std::string> known, tested;
  for (const Experiment& experiment : studies()) known.insert(experiment.name);
  for (const Case& one : cases) tested.insert(one.experiment);
  EXPECT_EQ(known, tested);
}

TEST(StudyList, NamesAreUniqueAndExplained) {
  for (const Experiment& experiment : studies()) {
    std::set<std::string> names;
    EXPECT_TRUE(experiment.question.ends_with("?")) << experiment.name;
    for (const ParameterInfo& info : experiment.parameters) {
      EXPECT_TRUE(names.insert(info.name).second) << experiment.name << ' ' << info.name;
      EXPECT_NE(info.description, "") << info.name;
    }
    for (const ColumnInfo& info : experiment.columns) {
      EXPECT_TRUE(names.insert(info.name).second) << experiment.name << ' ' << info.name;
      EXPECT_NE(info.meaning, "") << info.name;
    }
    EXPECT_NO_THROW(Parameters(experiment.parameters, Row::object()));  // defaults are in their ranges
  }
}

TEST(StudyList, DefaultsAndTestedSettingsAreWithoutContradiction) {
  const auto check = [](const std::string& name, const Row& given) {
    const Experiment& experiment = find_experiment(name);
    if (!experiment.check) return;
    for (const SettingFault& fault : experiment.check(Parameters(experiment.parameters, given))) {
      EXPECT_TRUE(fault.idle && !given.contains(fault.parameters.front())) << name << ": " << fault.what;
      for (const std::string& parameter : fault.parameters)
        EXPECT_TRUE(Parameters(experiment.parameters, given).json().contains(parameter)) << parameter;
    }
  };
  for (const Experiment& experiment : studies()) check(experiment.name, Row::object());
  for (const Case& one : cases) check(one.experiment, one.parameters);
}

TEST_F(Studies, MissingInputIsAnError) {
  for (const Experiment& experiment : studies())
    EXPECT_THROW((void)experiment.run(Parameters(experiment.parameters, Row::object()), RunContext{}), InputError)
        << experiment.name;
}

TEST_F(Studies, JobsNeedTheirProgramAndTheirLauncher) {
  const char* program = std::getenv("LODESTONE_MPI");
  const std::string before = program != nullptr ? program : "";
  setenv("LODESTONE_MPI", sphere_.c_str(), 1);
  expect_error_of<UnsupportedError>([&] { return rows_of("ranks", shallow); }, {"sphere.ply", "set LODESTONE_MPI"});
  setenv("LODESTONE_MPI", "/bin/false", 1);
  setenv("LODESTONE_LAUNCHER", "no-such-launcher -x", 1);
  expect_error_of<UnsupportedError>([&] { return rows_of("distributed", shallow); },
                                    {"no-such-launcher", "scripts/setup distributed"});
  setenv("LODESTONE_LAUNCHER", "/bin/false --tells nothing", 1);
  expect_error_of<ResourceError>([&] { return rows_of("distributed", shallow); }, {"lodestone-mpi build", "status 1"});
  unsetenv("LODESTONE_LAUNCHER");
  before.empty() ? unsetenv("LODESTONE_MPI") : setenv("LODESTONE_MPI", before.c_str(), 1);
}

TEST_F(Studies, MultiplesOfABorderNeedOne) {
  const Row given = {{"kappa0_over_rho", 1.05}, {"cell_triangles", 1000000}};
  expect_error_of<InputError>([&] { return rows_of("flight", given); }, {"give kappa0, or smaller cells"});
}

TEST_F(Studies, CancellationEndsARun) {
  const CancelFlag cancelled = true;
  RunContext context;
  context.input = sphere_;
  context.directory = folder_.string();
  context.cancel = &cancelled;
  for (const char* name : {"build", "flight", "progressive", "reconstruct", "scaling", "schedule", "systems"}) {
    const Experiment& experiment = find_experiment(name);
    EXPECT_THROW((void)experiment.run(Parameters(experiment.parameters, Row::object()), context), Cancelled) << name;
  }
}

}  // namespace
}  // namespace lodestone
