// Every experiment, run on a small surface: its rows have the columns that it declares, verify() accepts them, and
// refuses each kind of row that is wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "experiments/studies/experiment.h"
#include "experiments/sweep/sweep_file.h"
#include "parallel/generate.h"
#include "tests/test_folder.h"

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

const Row shallow = {{"cell_triangles", 100}};

Row with(Row base, const Row& more) {
  base.update(more);
  return base;
}

std::vector<Case> cases() {
  const Row picture = {{"width", 64}, {"height", 48}};
  return {
      {"build",
       with(shallow, {{"threads", 2}, {"rounds", 2}, {"error_level", 1}}),
       {{"valid", false},
        {"failed_checks", "parents"},
        {"hash", "0000000000000000"},
        {"fingerprint", ""},
        {"seconds", 0},
        {"seconds_min", 1e9},
        {"stored_triangles", 1},
        {"error_mean", 1e3},
        {"slivers", 101},
        {"normal_mean", 181}}},
      {"effects", with(picture, {{"rounds", 1}, {"frames", 3}}), {{"effects", "other"}, {"frame_ms", -1}}},
      {"families",
       with(shallow, {{"rounds", 1}, {"level_count", 1}}),
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
        {"triangles", 1e9}}},
      {"progressive",
       {{"rounds", 1}, {"level_count", 2}},
       {{"residual_edges", 1}, {"same", false}, {"hash", Row()}, {"base_triangles", 1e9}, {"error_p99", 1e3}}},
      {"raster",
       with(with(shallow, picture), {{"frames", 3}, {"rounds", 1}, {"measured_frames", 2}, {"camera", "orbit"}}),
       {{"same", false}, {"hash", ""}, {"screen_error", 3}, {"frame_ms_max", 0}, {"flip", 2}}},
      {"reconstruct",
       {{"rounds", 1}, {"resolution", 32}},
       {{"manifold", false}, {"same", false}, {"triangles", 0}, {"coverage", 101}, {"seconds_max", 0}}},
      {"scaling",
       with(shallow, {{"threads", 2}, {"rounds", 2}}),
       {{"same", false}, {"hash", "0000000000000000"}, {"speedup", 7}, {"efficiency", 1}, {"seconds", Row()}}},
      {"systems",
       with(with(shallow, picture), {{"frames", 3}}),
       {{"open_edges", 1}, {"gap_pixels", 1}, {"jump_over_bound", 1.01}, {"frame_ms", Row()}, {"image_error", 101}}},
      {"table",
       shallow,
       {{"valid", false},
        {"failed_checks", "parents"},
        {"fingerprint", Row()},
        {"hlod_triangles", 1},
        {"build_seconds", 1e9},
        {"seconds", 0},
        {"out_of_core", true}}},
  };
}

class Studies : public FolderTest {
 protected:
  Studies() {
    sphere_ = (folder_ / "sphere.ply").string();
    generate_ply({Shape::sphere, 3000, 1}, sphere_, *make_serial_scheduler());
    scene_ = test_folder_
                 .write("scene.toml",
                        "[[model]]\nfile = \"sphere.ply\"\nextent = 1\n"
                        "[lighting]\nhead = 0.5\ndirectional = { strength = 1, shadows = true }\n"
                        "[camera]\npath = \"orbit\"\nframes = 4\n")
                 .string();
  }

  [[nodiscard]] std::vector<Row> rows_of(const std::string& name, const Row& given, int repetition = 0) const {
    const Experiment& experiment = find_experiment(name);
    RunContext context;
    context.input = name == "effects" ? scene_ : sphere_;
    context.directory = folder_.string();
    context.repetition = repetition;
    return experiment.run(Parameters(experiment.parameters, given), context);
  }
  [[nodiscard]] static std::vector<std::string> faults(const std::string& name, const Row& given,
                                                       const std::vector<Row>& rows) {
    const Experiment& experiment = find_experiment(name);
    return experiment.verify(Parameters(experiment.parameters, given), rows);
  }

  std::string sphere_, scene_;
};

// All but the one that tries sweeps out.
std::vector<Experiment> studies() {
  std::vector<Experiment> list = experiments();
  std::erase_if(list, [](const Experiment& experiment) { return experiment.name == "probe"; });
  return list;
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text + "\n";
  return all;
}

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
    EXPECT_NE(joined(faults(name, given, tampered)), "") << column << " = " << value;
  }
}

TEST_P(EachStudy, LaterRepetitionsVerify) {
  const auto& [name, given, lies] = GetParam();
  EXPECT_EQ(joined(faults(name, given, rows_of(name, given, 1))), "");
}

INSTANTIATE_TEST_SUITE_P(All, EachStudy, ::testing::ValuesIn(cases()),
                         [](const auto& param) { return param.param.experiment; });

TEST(StudyList, HasACaseForEach) {
  std::set<std::string> known, tested;
  for (const Experiment& experiment : studies()) known.insert(experiment.name);
  for (const Case& one : cases()) tested.insert(one.experiment);
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
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(LODESTONE_SOURCE_DIR) + "/experiments/sweeps")) {
    const SweepFile full = load_sweep_file(file.path().string(), false);
    const SweepFile small = load_sweep_file(file.path().string(), true);
    EXPECT_EQ(full.name, file.path().stem());
    EXPECT_FALSE(full.figures.empty()) << full.name;
    ASSERT_EQ(full.sweeps.size(), small.sweeps.size());
    for (std::size_t i = 0; i < full.sweeps.size(); ++i) {
      const auto runs = [](const SweepSection& sweep) {
        return sweep.data.size() * sweep.settings.size() * static_cast<std::size_t>(sweep.repetitions);
      };
      EXPECT_LE(runs(small.sweeps[i]), runs(full.sweeps[i])) << full.name << ' ' << full.sweeps[i].name;
    }
    ++files;
  }
  EXPECT_EQ(files, 6u);
}

// ---- what the studies are for ----

double number(const Row& row, const char* column) { return row.at(column).get<double>(); }

TEST_F(Studies, UniformRadiiCrackBelowTheBorderAndNotAbove) {
  const auto row = [&](double over_border) {
    return rows_of("flight", with(shallow, {{"radii", "uniform"},
                                            {"camera", "adversarial"},
                                            {"kappa0_over_rho", over_border},
                                            {"frames", 12}}))
        .front();
  };
  const Row below = row(0.4), above = row(1.05);
  EXPECT_EQ(below.at("admissible"), false);
  EXPECT_GT(number(below, "open_edges"), 0);
  EXPECT_GT(number(below, "gap_max"), 0);
  EXPECT_EQ(above.at("admissible"), true);
  EXPECT_EQ(number(above, "open_edges"), 0);
  EXPECT_EQ(number(above, "gap_max"), 0);
  EXPECT_NEAR(number(above, "over_border"), 1.05, 1e-6);
}

TEST_F(Studies, AStepPopsAndDoesNotCrack) {
  const auto row = [&](const char* blend) {
    return rows_of("flight", with(shallow, {{"kappa0", 1.0}, {"frames", 40}, {"blend", blend}})).front();
  };
  const Row linear = row("linear"), step = row("step");
  EXPECT_LE(number(linear, "jump_over_bound"), 1);
  EXPECT_GT(number(step, "jump_over_bound"), 1);
  EXPECT_GT(number(step, "jump_max"), number(linear, "jump_max"));
  EXPECT_EQ(number(step, "open_edges"), 0);
}

TEST_F(Studies, DiscreteLevelsCrackOnThePathOnWhichTheMorphDoesNot) {
  generate_ply({Shape::sphere, 30000, 1}, sphere_, *make_serial_scheduler());
  const auto row = [&](const char* system) {
    const Row path = {{"frames", 3}, {"from", 0.3}, {"to", 0.5}, {"pixel_error", 2.0}};
    return rows_of("systems", with(path, {{"system", system}, {"cell_triangles", 200}})).front();
  };
  const Row morph = row("morph"), discrete = row("discrete");
  EXPECT_EQ(morph.at("admissible"), true);
  EXPECT_EQ(number(morph, "open_edges"), 0);
  EXPECT_EQ(discrete.at("admissible"), false);
  EXPECT_GT(number(discrete, "open_edges"), 0);
  EXPECT_GT(number(discrete, "gap_pixels"), 0);
  EXPECT_GT(number(discrete, "torn_pixels"), 0);
}

TEST_F(Studies, PicturesHaveTheEffectsThatAreAskedForAndTheFullModelHasThem) {
  const auto row = [&](const char* effects) {
    const Row given = {{"frames", 3}, {"rounds", 1}, {"width", 64}, {"height", 48}, {"effects", effects}};
    const std::vector<Row> rows = rows_of("raster", with(shallow, given));
    EXPECT_EQ(joined(faults("raster", with(shallow, given), rows)), "") << effects;
    return rows.front();
  };
  const Row plan = row("auto"), all = row("all"), unlit = row("geomorph,smooth-normals");
  EXPECT_EQ(plan.at("hash"), all.at("hash"));
  EXPECT_NE(plan.at("hash"), unlit.at("hash"));
  EXPECT_LT(number(unlit, "image_error"), number(plan, "image_error"));  // flat colour differs at the outline alone
  const Row picture = {{"frames", 3}, {"width", 64}, {"height", 48}};
  const auto worst = [&](const char* effects) {
    return rows_of("systems", with(with(shallow, picture), {{"effects", effects}})).front();
  };
  EXPECT_EQ(worst("none").at("admissible"), true);  // the morph is the system's
  EXPECT_LT(number(worst("none"), "image_error"), number(worst("auto"), "image_error"));
}

TEST_F(Studies, WithoutGeomorphAFlightCracksAndPops) {
  generate_ply({Shape::sphere, 30000, 1}, sphere_, *make_serial_scheduler());
  const auto row = [&](const char* effects) {
    const Row path = {{"frames", 3}, {"from", 0.3}, {"to", 0.5}, {"pixel_error", 2.0}, {"cell_triangles", 200}};
    const Row given = with(path, {{"effects", effects}});
    const std::vector<Row> rows = rows_of("flight", given);
    EXPECT_EQ(joined(faults("flight", given, rows)), "") << effects;
    return rows.front();
  };
  const Row morph = row("geomorph"), still = row("none");
  EXPECT_EQ(morph.at("admissible"), true);
  EXPECT_EQ(number(morph, "open_edges"), 0);
  EXPECT_EQ(still.at("admissible"), false);
  EXPECT_GT(number(still, "open_edges"), 0);
  EXPECT_GT(number(still, "torn_pixels"), 0);
  EXPECT_GT(number(still, "jump_max"), number(morph, "jump_max"));
  EXPECT_TRUE(still.at("jump_over_bound").is_null());
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
      const bool weak = std::string(mode) == "weak";
      EXPECT_EQ(weak, number(rows[2], "work") > 2 * number(rows[0], "work")) << task << ' ' << mode;
      EXPECT_EQ(weak, rows[2].at("karp_flatt").is_null());
    }
}

TEST_F(Studies, TableBuildsOnDiskBeyondItsLimit) {
  const std::string large = (folder_ / "large.ply").string();
  generate_ply({Shape::sphere, 2'000'000, 1}, large, *make_serial_scheduler());
  const Experiment& experiment = find_experiment("table");
  const Parameters parameters(experiment.parameters, {{"memory_limit", 0.13}});
  RunContext context;
  context.input = large;
  context.directory = folder_.string();
  const std::vector<Row> rows = experiment.run(parameters, context);
  EXPECT_EQ(rows.front().at("out_of_core"), true);
  EXPECT_GT(number(rows.front(), "scratch_bytes"), 0);
  EXPECT_EQ(joined(experiment.verify(parameters, rows)), "");
}

TEST_F(Studies, ContradictionsAndMissingInputAreErrors) {
  EXPECT_THROW((void)rows_of("flight", {{"kappa0", 2.0}, {"kappa0_over_rho", 1.0}}), InputError);
  for (const Experiment& experiment : studies())
    EXPECT_THROW((void)experiment.run(Parameters(experiment.parameters, Row::object()), RunContext{}), InputError)
        << experiment.name;
}

TEST_F(Studies, CancellationEndsARun) {
  const CancelFlag cancelled = true;
  RunContext context;
  context.input = sphere_;
  context.directory = folder_.string();
  context.cancel = &cancelled;
  for (const char* name : {"build", "flight", "progressive", "reconstruct", "scaling", "systems"}) {
    const Experiment& experiment = find_experiment(name);
    EXPECT_THROW((void)experiment.run(Parameters(experiment.parameters, Row::object()), context), Cancelled) << name;
  }
}

}  // namespace
}  // namespace lodestone
