// Every experiment, run on a small surface: its rows have the columns that it declares, verify() accepts them, and
// refuses each kind of row that is wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "experiments/studies/experiment.h"
#include "experiments/sweep/sweep_file.h"
#include "parallel/scheduler/processors.h"
#include "tests/expect_error.h"
#include "tests/experiments/study_case.h"
#include "tests/test_data.h"

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

class EachStudy : public Studies, public ::testing::WithParamInterface<Case> {};

TEST_P(EachStudy, HasItsColumnsVerifiesAndRefusesWrongRows) {
  const auto& [name, given, lies] = GetParam();
  const std::vector<Row> rows = rows_of(name, given);
  EXPECT_EQ(joined(faults(name, given, rows)), "");
  for (const ColumnInfo& column : find_experiment(name).columns)
    EXPECT_TRUE(std::ranges::any_of(rows, [&](const Row& row) { return row.contains(column.name); })) << column.name;
  for (const std::filesystem::path& file : std::filesystem::directory_iterator(folder_))
    EXPECT_TRUE(file.extension() == ".png" || file == sphere_ || file == scene_) << file;

  EXPECT_NE(joined(faults(name, given, {})), "");
  std::vector<Lie> all = lies;
  all.push_back({"no_such_column", 1});
  all.push_back({find_experiment(name).columns.front().name, {1, 2}});
  for (const auto& [column, value] : all) {
    std::vector<Row> tampered = rows;
    tampered.back()[column] = value;
    EXPECT_NE(joined(faults(name, given, tampered)), "") << column << " = " << value.dump();
  }
}

TEST_P(EachStudy, LaterRepetitionsVerify) {
  const auto& [name, given, lies] = GetParam();
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

TEST(SweepFiles, TheStandardOnesAreWithoutMistake) {
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(source_folder() / "experiments/studies/standard")) {
    const SweepFile standard = load_sweep_file(file.path().string(), SweepForm::standard);
    const SweepFile full = load_sweep_file(file.path().string(), SweepForm::full);
    const SweepFile small = load_sweep_file(file.path().string(), SweepForm::small);
    EXPECT_EQ(full.name, file.path().stem());
    EXPECT_FALSE(full.figures.empty()) << full.name;
    ASSERT_EQ(full.sweeps.size(), small.sweeps.size());
    ASSERT_EQ(full.sweeps.size(), standard.sweeps.size());
    for (std::size_t i = 0; i < full.sweeps.size(); ++i) {
      const auto runs = [](const SweepSection& sweep) {
        return sweep.data.size() * sweep.settings.size() * static_cast<std::size_t>(sweep.repetitions);
      };
      EXPECT_LE(runs(small.sweeps[i]), runs(standard.sweeps[i])) << full.name << ' ' << full.sweeps[i].name;
      EXPECT_LE(runs(standard.sweeps[i]), runs(full.sweeps[i])) << full.name << ' ' << full.sweeps[i].name;
    }
    ++files;
  }
  EXPECT_EQ(files, 12u);
}

// A run is one system: times of two are comparable by repetitions alone, which take turns.
TEST(SweepFiles, SystemsTakeTurns) {
  const std::string file = (source_folder() / "experiments/studies/standard/systems.toml").string();
  for (const SweepForm form : {SweepForm::standard, SweepForm::full})
    for (const SweepSection& sweep : load_sweep_file(file, form).sweeps) {
      EXPECT_GE(sweep.repetitions, 3) << sweep.name;
      for (const Row& setting : sweep.settings)
        EXPECT_GE(Parameters(sweep.experiment->parameters, setting).integer("rounds"), 3) << sweep.name;
    }
}

TEST_F(Studies, ScalingTimesEachNumberOfWorkers) {
  for (const char* task : {"build", "raster", "reconstruct", "progressive"})
    for (const char* mode : {"strong", "weak"}) {
      const Row given = with(shallow, {{"threads", 3},
                                       {"rounds", 1},
                                       {"task", task},
                                       {"mode", mode},
                                       {"resolution", 24},
                                       {"frames", 2},
                                       {"width", 32},
                                       {"height", 32}});
      const std::vector<Row> rows = rows_of("scaling", given);
      ASSERT_EQ(rows.size(), 3u) << task;
      EXPECT_EQ(rows[0].at("workers"), 1);
      EXPECT_EQ(rows[1].at("workers"), 2);
      EXPECT_EQ(rows[2].at("workers"), 3);
      EXPECT_EQ(joined(faults("scaling", given, rows)), "") << task << ' ' << mode;
      for (const Row& row : rows)
        EXPECT_EQ(number(row, "processors"),
                  std::min(number(row, "workers"), static_cast<double>(allowed_processors().size())));
      const bool weak = std::string(mode) == "weak";
      EXPECT_EQ(weak, number(rows[2], "work") > 2 * number(rows[0], "work")) << task << ' ' << mode;
      EXPECT_EQ(weak, rows[2].at("karp_flatt").is_null());
    }
}

TEST_F(Studies, VirtualWorkersComeAfterThoseThatAreMeasured) {
  const Row given = with(shallow, {{"threads", 2}, {"rounds", 1}, {"array", 1}, {"virtual_workers", 16}});
  const std::vector<Row> rows = rows_of("schedule", given);
  ASSERT_EQ(rows.size(), 4u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(number(rows[i], "workers"), (std::array{1, 2, 4, 16}[i]));
    EXPECT_EQ(rows[i].at("measured").is_null(), i >= 2);
    EXPECT_GE(number(rows[i], "speedup"), i == 0 ? 0.999 : number(rows[i - 1], "speedup") * 0.9);
    EXPECT_LE(number(rows[i], "speedup"), number(rows[i], "parallelism") * (1 + 1e-9));
  }
  EXPECT_NE(rows[0].at("critical").get<std::string>().find("partition"), std::string::npos);
}

TEST_F(Studies, MillionsPerCoreSecondAreThoseOfBuilding) {
  for (const char* name : {"build", "table"}) {
    const Row row = rows_of(name, shallow, 1).front();
    EXPECT_DOUBLE_EQ(number(row, "mtri_per_core_second") * number(row, "cpu_seconds"),
                     number(row, "input_triangles") * 1e-6);
  }
  const Row table = rows_of("table", shallow, 1).front();
  EXPECT_GT(number(table, "read_seconds"), 0);
  EXPECT_GT(number(table, "write_seconds"), 0);
  EXPECT_TRUE(table.at("spill_seconds").is_null());
  EXPECT_DOUBLE_EQ(number(table, "file_mtri_per_core_second") * number(table, "file_cpu_seconds"),
                   number(table, "input_triangles") * 1e-6);
}

TEST_F(Studies, TableBuildsOnDiskBeyondItsLimit) {
  const std::string large = (folder_ / "large.ply").string();
  generate_ply({Shape::sphere, 2'500'000, 1}, large, *make_serial_scheduler());
  const Experiment& experiment = find_experiment("table");
  const Parameters parameters(experiment.parameters, {{"memory_limit", 0.135}, {"threads", 2}});
  RunContext context;
  context.input = large;
  context.directory = folder_.string();
  const std::vector<Row> rows = experiment.run(parameters, context);
  const Row& row = rows.front();
  EXPECT_EQ(row.at("out_of_core"), true);
  EXPECT_GT(number(row, "scratch_bytes"), 0);
  for (const char* column : {"read_seconds", "spill_seconds", "write_seconds"}) EXPECT_GT(number(row, column), 0);
  EXPECT_LT(number(row, "spill_seconds"), number(row, "seconds"));
  std::vector<std::string> faults = experiment.verify(parameters, rows);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  std::erase(faults, "the build took more memory than the limit");  // sanitizers take a multiple of it for themselves
#endif
  EXPECT_EQ(joined(faults), "");
}

// Columns with needs: numbers in the settings that meet them, none in one that does not.
TEST_F(Studies, ColumnsAreThereAsTheirNeedsSay) {
  const auto measured = [&](const char* name, const Row& given, const char* column) {
    const Row small = {{"frames", 3}, {"width", 64}, {"height", 48}};
    const std::vector<Row> rows = rows_of(name, with(with(shallow, small), given));
    return std::ranges::any_of(rows, [&](const Row& row) { return row.value(column, Row()).is_number(); });
  };
  for (const char* column : {"image_error", "flip_pop_max"}) {
    EXPECT_TRUE(measured("flight", {{"image", true}, {"backend", "soft"}}, column)) << column;
    EXPECT_FALSE(measured("flight", {{"backend", "soft"}}, column)) << column;
  }
  EXPECT_TRUE(measured("flight", {{"kappa0", 1.0}}, "over_border"));
  EXPECT_FALSE(measured("flight", Row::object(), "over_border"));
  const Row orbit = {{"camera", "orbit"}, {"rounds", 1}};
  EXPECT_TRUE(measured("raster", orbit, "flip"));
  EXPECT_FALSE(measured("raster", with(orbit, {{"backend", "null"}}), "flip"));
  EXPECT_TRUE(measured("raster", with(orbit, {{"backend", "null"}}), "screen_error"));
  EXPECT_FALSE(measured("raster", with(orbit, {{"measured_frames", 0}}), "screen_error"));
  EXPECT_TRUE(measured("systems", {{"system", "step"}}, "jump_max"));
  EXPECT_FALSE(measured("systems", {{"system", "cross-fade"}}, "jump_max"));
}

// A setting that an experiment refuses, the parameter at which it does, and part of the reason.
struct Refusal {
  std::string experiment;
  Row given;
  std::string parameter, part;
  bool idle = false;
};

std::vector<Refusal> refusals() {
  return {
      {"flight", {{"kappa0", 2.0}, {"kappa0_over_rho", 0.5}}, "kappa0_over_rho", "exclude each other"},
      {"flight", {{"radii", "uniform"}}, "radii", "needs kappa0 or kappa0_over_rho"},
      {"flight", {{"radii", "adaptive"}, {"kappa0", 2.0}}, "radii", "goes by pixel_error"},
      {"flight", {{"constraint", 0.5}}, "constraint", "beside radii", true},
      {"flight", {{"image", true}, {"backend", "null"}}, "backend", "set backend to soft or gl"},
      {"flight", {{"image", true}}, "backend", "set backend to soft or gl"},
      {"flight", {{"from", 0.5}, {"to", 0.5}}, "to", "from = 0.5 must be less than to = 0.5"},
      {"flight", {{"kappa0", 2.0}, {"pixel_error", 2.0}}, "pixel_error", "beside kappa0 = 2.0", true},
      {"flight", {{"kappa0_over_rho", 2.0}, {"pixel_error", 2.0}}, "pixel_error", "beside kappa0_over_rho", true},
      {"flight", {{"camera", "fly-in"}, {"seed", 3}}, "seed", "beside camera = \"fly-in\"", true},
      {"flight", {{"camera", "adversarial"}, {"step", 0.1}}, "step", "beside camera", true},
      {"flight", {{"camera", "random"}, {"from", 0.1}}, "from", "beside camera", true},
      {"flight", {{"camera", "adversarial"}, {"to", 0.1}}, "to", "beside camera", true},
      {"flight", {{"backend", "null"}, {"samples", 4}}, "samples", "beside backend", true},
      {"raster", {{"backend", "null"}, {"samples", 4}}, "samples", "beside backend", true},
      {"raster", {{"samples", 2}}, "samples", "1 or 4 samples"},
      {"raster", {{"camera", "orbit"}, {"from", 0.8}, {"to", 0.1}}, "to", "must be less than"},
      {"effects", {{"samples", 3}}, "samples", "1 or 4 samples"},
      {"systems", {{"from", 1.0}}, "to", "must be less than"},
      {"systems", {{"system", "morph"}, {"fade_width", 1.0}}, "fade_width", "beside system", true},
      {"build", {{"simplifier", "cluster"}, {"placement", "optimal"}}, "placement", "only quadric"},
      {"families", {{"simplifier", "meshopt"}, {"placement", "endpoint"}}, "placement", "beside simplifier", true},
      {"table", {{"finest_level", 3}, {"cell_triangles", 100}}, "cell_triangles", "beside finest_level = 3", true},
      {"scaling", {{"task", "build"}, {"resolution", 64.0}}, "resolution", "beside task", true},
      {"scaling", {{"task", "progressive"}, {"sigma0", 0.1}}, "sigma0", "beside task", true},
      {"scaling", {{"task", "reconstruct"}, {"frames", 3}}, "frames", "beside task", true},
      {"schedule", {{"task", "build"}, {"frames", 3}}, "frames", "beside task", true},
      {"scaling", {{"task", "raster"}, {"simplifier", "cluster"}, {"placement", "optimal"}}, "placement", "quadric"},
  };
}

TEST(StudyList, ContradictionsAreKnownBeforeARun) {
  for (const auto& [name, given, parameter, part, idle] : refusals()) {
    const Experiment& experiment = find_experiment(name);
    const std::vector<SettingFault> faults = experiment.check(Parameters(experiment.parameters, given));
    EXPECT_TRUE(std::ranges::any_of(faults,
                                    [&, parameter = parameter, part = part, idle = idle](const SettingFault& fault) {
                                      return fault.parameters.back() == parameter &&
                                             fault.what.find(part) != std::string::npos && fault.idle == idle;
                                    }))
        << name << ' ' << given.dump();
  }
}

TEST(StudyList, WhatColumnsNeedIsThere) {
  for (const Experiment& experiment : studies())
    for (const ColumnInfo& column : experiment.columns)
      for (const ColumnNeed& need : column.needs) {
        EXPECT_FALSE(need.any.empty()) << column.name;
        for (const auto& [parameter, value, is] : need.any)
          EXPECT_NO_THROW(Parameters(experiment.parameters, {{parameter, value}}))
              << experiment.name << ' ' << column.name;
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
