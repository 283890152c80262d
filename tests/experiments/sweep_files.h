// Sweep files of three small experiments, and what is wrong with them.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "experiments/studies/effects_parameter.h"
#include "experiments/studies/verdict.h"
#include "experiments/studies/viewpoints.h"
#include "experiments/sweep/sweep_file.h"
#include "tests/expect_error.h"
#include "tests/test_folder.h"

namespace lodestone::testing {

inline const std::vector<Experiment>& known_experiments() {
  static const std::vector<Experiment> all = [] {
    Experiment flight;
    flight.name = "flight";
    flight.parameters = {{"blend", "linear", "", "", 0, 0, {"linear", "step", "cosine"}},
                         {"kappa0", 2.0, "cells", "", 0.1, 100, {}},
                         {"threads", 1, "", "", 1, 64, {}},
                         {"fast", false, "", "", 0, 0, {}},
                         effects_parameter(""),
                         camera_parameter("")};
    flight.columns = {{"gap", "", "", ColumnInfo::Kind::accuracy},
                      {"rho", "", "", ColumnInfo::Kind::count},
                      {"seconds", "s", "", ColumnInfo::Kind::cost}};
    Experiment clock = flight;
    clock.name = "clock";
    clock.takes_input = false;
    Experiment strict = clock;
    strict.name = "strict";
    const ColumnNeed fast{{{"fast", true}}}, no_step{{{"blend", "step", false}}},
        far{{{"kappa0", 3.0}, {"fast", true}}};
    strict.columns = {{"gap", "", "", ColumnInfo::Kind::accuracy, {fast, no_step}},
                      {"rho", "", "", ColumnInfo::Kind::count, {far}},
                      {"plain", "", "", ColumnInfo::Kind::cost}};
    strict.check = [](const Parameters& parameters) {
      SettingVerdict verdict;
      const bool step = parameters.text("blend") == "step";
      verdict.require(!step || !parameters.flag("fast"), {"fast", "blend"},
                      "a step cannot be fast; take another blend");
      verdict.idle(step, "kappa0", assignment(parameters, "blend"));
      return std::move(verdict).faults();
    };
    return std::vector<Experiment>{flight, clock, strict};
  }();
  return all;
}

inline const Experiment& lookup(const std::string& name) {
  for (const Experiment& experiment : known_experiments())
    if (experiment.name == name) return experiment;
  throw InputError("unknown experiment '" + name + "'");
}

class SweepFiles : public FolderTest {
 protected:
  SweepFile load(const std::string& text, SweepForm form = SweepForm::standard) const {
    return load_sweep_file(test_folder_.write("sweep.toml", text).string(), form, lookup);
  }
  // The head of a file whose sweep begins in line 5 and takes no data.
  static std::string clock(const std::string& rest) {
    return "name = \"test\"\n\n[data]\nball = { generate = \"sphere\" }\n[[sweep]]\nname = \"s\"\nexperiment = "
           "\"clock\"\n" +
           rest;
  }
  static std::string strict(const std::string& rest) {
    std::string text = clock(rest);
    return text.replace(text.find("clock"), 5, "strict");
  }
  std::vector<Json> settings(const std::string& rest, SweepForm form = SweepForm::standard) const {
    return load(clock(rest), form).sweeps.at(0).settings;
  }
  // Expects an error that names the line and has the text.
  void refused(const std::string& text, int line, const std::string& part) const {
    expect_error_of<InputError>([&] { return load(text); }, {": line " + std::to_string(line) + ": ", part}, text);
  }
};

}  // namespace lodestone::testing
