// What a figure shows, in a line of text.
#pragma once

#include <string>

#include "experiments/report/figure.h"

namespace lodestone {

// One settled point of a panel, before points are taken together.
struct OutcomePoint {
  double x = 0, y = 0;
  std::optional<double> mark;  // of its own row
  std::string label;
};

// For a front: how many settings are on it, and what accuracy costs. Where points have a mark: y on either side of it.
// Otherwise the least and the largest y, and where.
[[nodiscard]] std::string describe_outcome(const Figure& figure, const std::string& mark,
                                           const std::vector<std::vector<OutcomePoint>>& panels);

}  // namespace lodestone
