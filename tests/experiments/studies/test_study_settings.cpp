// Settings of studies: contradictions are known before a run, and the standard sweeps are without mistake.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "experiments/sweep/sweep_file.h"
#include "tests/experiments/studies/study_case.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

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
  EXPECT_EQ(files, 13u);
}

// Data that are generated or lie in the repository: those of scripts/data need a network. A scene names its models
// itself.
bool needs_no_models(const DataSource& source, const std::filesystem::path& folder) {
  if (source.path.empty()) return true;
  const std::filesystem::path file = (folder / source.path).lexically_normal();
  return file.string().find("/build/data/") == std::string::npos &&
         (file.extension() != ".toml" || content(file).find("build/data/") == std::string::npos);
}

TEST(SweepFiles, EveryStudyHasDataWithoutModels) {
  const std::filesystem::path folder = source_folder() / "experiments/studies/standard";
  for (const auto& file : std::filesystem::directory_iterator(folder))
    for (const SweepForm form : {SweepForm::small, SweepForm::standard, SweepForm::full}) {
      const SweepFile study = load_sweep_file(file.path().string(), form);
      const auto runs = [&](const SweepSection& sweep) {
        return sweep.data.empty() || std::ranges::any_of(study.data, [&](const DataSource& source) {
                 return std::ranges::find(sweep.data, source.name) != sweep.data.end() &&
                        needs_no_models(source, folder);
               });
      };
      EXPECT_TRUE(std::ranges::any_of(study.sweeps, runs)) << study.name << ' ' << name_of(form);
    }
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

}  // namespace
}  // namespace lodestone
