// Faults in the rows of a run, and in a setting before it is run: the checks that the experiments have in common.
#pragma once

#include <string>
#include <vector>

#include "experiments/studies/experiment.h"

namespace lodestone {

// Collects in words the checks that rows fail.
class RowVerdict {
 public:
  // There are rows; each is an object of declared columns alone; labels are texts or truth values, everything else is a
  // finite number, a truth value, or null. No count is negative.
  RowVerdict(const std::vector<ColumnInfo>& columns, const std::vector<Row>& rows);

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

  void require(bool holds, const std::string& otherwise);
  // For every row that has the column:
  void at_most(const std::string& column, double most);
  void is_true(const std::string& column);
  // For every row that has both:
  void in_order(const std::string& lower, const std::string& upper);
  void equal(const std::string& column, const std::string& other);
  // In every row `name` is positive and lies between name_min and name_max.
  void spread(const std::string& name);
  // Every row has the column, and it is neither null nor empty.
  void present(const std::string& column);

  [[nodiscard]] std::vector<std::string> messages() && { return std::move(messages_); }

 private:
  const std::vector<Row>& rows_;
  std::vector<std::string> messages_;
};

// No crack where a row says that it is admissible; nor a jump beyond the bound, if the blend is continuous.
void check_surface(RowVerdict& verdict, bool continuous_blend);
// The columns of frame_columns() are in order.
void check_frames(RowVerdict& verdict);

// Collects in words the parameters that contradict each other or have no effect.
class SettingVerdict {
 public:
  // `names`: the parameters that are at odds.
  void require(bool holds, std::vector<std::string> names, const std::string& otherwise);
  // `beside`: what leaves the parameter without effect, as "kappa0 = 2".
  void idle(bool without_effect, const std::string& name, const std::string& beside);

  [[nodiscard]] std::vector<SettingFault> faults() && { return std::move(faults_); }

 private:
  std::vector<SettingFault> faults_;
};

// "kappa0 = 2": a parameter and its value.
[[nodiscard]] std::string assignment(const Parameters& parameters, const std::string& name);

}  // namespace lodestone
