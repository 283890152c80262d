// What is wrong with the rows of a run: the checks that every experiment's verify() makes, and those of its own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/studies/experiment.h"

namespace lodestone {

// The value of a column; empty when the row does not have it, or null, or something that is no finite number.
[[nodiscard]] std::optional<double> number_in(const Row& row, const std::string& column);
// Likewise for a text; empty text when the row does not have it.
[[nodiscard]] std::string text_in(const Row& row, const std::string& column);

// Collects in words what does not hold.
class RowVerdict {
 public:
  // There are rows; each is an object of declared columns alone; labels are texts or truth values, everything else is a
  // finite number, a truth value, or null. No count is negative.
  RowVerdict(const std::vector<ColumnInfo>& columns, const std::vector<Row>& rows);

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

  void require(bool holds, const std::string& otherwise);
  // Of every row that has the column.
  void at_most(const std::string& column, double most);
  void is_true(const std::string& column);
  // Of every row that has both.
  void in_order(const std::string& lower, const std::string& upper);
  void equal(const std::string& column, const std::string& other);
  // Of every row: `name` is positive and lies between name_min and name_max.
  void spread(const std::string& name);
  // Every row has the column, and it is neither null nor empty.
  void present(const std::string& column);

  [[nodiscard]] std::vector<std::string> messages() && { return std::move(messages_); }

 private:
  const std::vector<Row>& rows_;
  std::vector<std::string> messages_;
};

}  // namespace lodestone
