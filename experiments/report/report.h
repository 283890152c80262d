// The report on one or several sweeps' directories: what is computed, before it becomes a page.
#pragma once

#include <string>
#include <vector>

#include "experiments/report/figure.h"
#include "experiments/report/findings.h"
#include "experiments/report/plots.h"

namespace lodestone {

struct StudyReport {
  Study study;
  std::vector<SettingTable> tables;  // one per sweep
  std::vector<Figure> figures;
  std::vector<std::string> oddities;
  RunCounts counts;
};

struct Report {
  std::vector<StudyReport> studies;
  Plots plots;  // of the figures of all studies, in order

  [[nodiscard]] RunCounts counts() const;
};

// Equal folders give equal reports. Throws as read_study() and draw_plots() do.
[[nodiscard]] Report make_report(const std::vector<std::filesystem::path>& folders);

// Every row of every repetition, with study, sweep, run, data, repetition, state and parameters: RFC 4180, lines end in
// LF, null is an empty field. A row's state is "verified", "unverified", or the kind of its fault.
[[nodiscard]] std::string to_csv(const Report& report);

// Everything: rows, faults and manifests by run, settings aggregated over repetitions, figures.
[[nodiscard]] nlohmann::json to_json(const Report& report);

}  // namespace lodestone
