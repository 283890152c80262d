#include "experiments/studies/row_verdict.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

bool is_of_kind(const Row& value, ColumnInfo::Kind kind) {
  if (value.is_null() || value.is_boolean()) return true;
  if (kind == ColumnInfo::Kind::label) return value.is_string();
  if (!value.is_number() || !std::isfinite(value.get<double>())) return false;
  return kind != ColumnInfo::Kind::count || value.get<double>() >= 0;
}

}  // namespace

std::optional<double> number_in(const Row& row, const std::string& column) {
  const auto found = row.find(column);
  if (found == row.end() || !found->is_number() || !std::isfinite(found->get<double>())) return {};
  return found->get<double>();
}

std::string text_in(const Row& row, const std::string& column) {
  const auto found = row.find(column);
  return found != row.end() && found->is_string() ? found->get<std::string>() : std::string();
}

RowVerdict::RowVerdict(const std::vector<ColumnInfo>& columns, const std::vector<Row>& rows) : rows_(rows) {
  require(!rows.empty(), "there are no rows");
  for (const Row& row : rows) {
    require(row.is_object(), "a row is no object");
    if (!row.is_object()) continue;
    for (const auto& [name, value] : row.items()) {
      const auto column =
          std::find_if(columns.begin(), columns.end(), [&](const ColumnInfo& c) { return c.name == name; });
      if (column == columns.end())
        messages_.push_back(fmt::format("{} is none of the experiment's columns", name));
      else
        require(is_of_kind(value, column->kind), fmt::format("{} = {} is no value of its kind", name, value.dump()));
    }
  }
}

void RowVerdict::require(bool holds, const std::string& otherwise) {
  if (!holds) messages_.push_back(otherwise);
}

void RowVerdict::at_most(const std::string& column, double most) {
  for (const Row& row : rows_)
    if (const auto value = number_in(row, column))
      require(*value <= most, fmt::format("{} = {:g} is above {:g}", column, *value, most));
}

void RowVerdict::is_true(const std::string& column) {
  for (const Row& row : rows_)
    if (row.contains(column) && !row.at(column).is_null())
      require(row.at(column) == true, fmt::format("{} does not hold", column));
}

void RowVerdict::in_order(const std::string& lower, const std::string& upper) {
  for (const Row& row : rows_) {
    const auto a = number_in(row, lower), b = number_in(row, upper);
    if (a && b)
      require(*a <= *b + 1e-12 * std::abs(*b), fmt::format("{} = {:g} is above {} = {:g}", lower, *a, upper, *b));
  }
}

void RowVerdict::equal(const std::string& column, const std::string& other) {
  for (const Row& row : rows_)
    if (row.contains(column) && row.contains(other) && !row.at(column).is_null() && !row.at(other).is_null())
      require(row.at(column) == row.at(other),
              fmt::format("{} = {} is not {} = {}", column, row.at(column).dump(), other, row.at(other).dump()));
}

void RowVerdict::spread(const std::string& name) {
  for (const Row& row : rows_)
    require(number_in(row, name).value_or(0) > 0, fmt::format("{} is missing or not positive", name));
  in_order(name + "_min", name);
  in_order(name, name + "_max");
}

void RowVerdict::present(const std::string& column) {
  for (const Row& row : rows_) {
    const bool there = row.contains(column) && !row.at(column).is_null() && row.at(column) != "";
    require(there, fmt::format("{} is missing", column));
  }
}

}  // namespace lodestone
