// What a figure shows: computed here, drawn elsewhere (plots.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/report/aggregate.h"

namespace lodestone {

struct FigurePoint {
  double x = 0, x_least = 0, x_most = 0;
  double y = 0, y_least = 0, y_most = 0;
  std::string label;         // the setting, in words
  std::size_t settings = 1;  // that were taken together: y is their median then, y_least and y_most their range
};

struct FigureSeries {
  std::string name;
  std::vector<FigurePoint> points;  // by rising x; of a scatter plot in the order of the settings
};

// The Pareto front of the settings on one input.
struct FigureFront {
  std::string data;
  std::size_t candidates = 0;       // settings that it was chosen from
  std::vector<FigurePoint> points;  // by rising cost
  // For round limits of the error the cheapest setting that keeps it, an index of `points`; of quality, all points.
  struct Choice {
    double limit = 0;
    std::size_t point = 0;
  };
  std::vector<Choice> choices;
};

// Curves with a y axis in common: columns of the same unit.
struct FigurePanel {
  std::string y_name, y_unit;
  bool more_is_better = false;  // of y
  std::vector<FigureSeries> series;
  std::vector<FigureFront> fronts;  // where the figure asks for them
};

// "at most" or "at least": how a limit of y is kept.
[[nodiscard]] inline const char* limit_text(const FigurePanel& panel) {
  return panel.more_is_better ? "at least" : "at most";
}

struct FigureMark {
  double x = 0;
  std::string label;
};

struct Figure {
  std::string title, kind, x_name, x_unit;
  bool log_x = false, log_y = false;
  std::vector<std::string> categories;  // names at x = 0, 1, 2 ... where x is no number, and of bars; else empty
  std::vector<FigurePanel> panels;
  std::vector<FigureMark> marks;
  std::string outcome;             // what it shows, in a line
  std::vector<std::string> notes;  // what to know when reading it
};

// `tables` are those of the spec's sweeps. Points without a number are left out and counted in a note.
[[nodiscard]] Figure make_figure(const FigureRequest& spec, const std::vector<const SettingTable*>& tables);

[[nodiscard]] nlohmann::json to_json(const Figure& figure);

}  // namespace lodestone
