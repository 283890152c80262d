#include "experiments/studies/verdict.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "experiments/subjects/row.h"

namespace lodestone {
namespace {

bool is_of_kind(const Row& value, ColumnInfo::Kind kind) {
  if (value.is_null() || value.is_boolean()) return true;
  if (kind == ColumnInfo::Kind::label) return value.is_string();
  if (!value.is_number() || !std::isfinite(value.get<double>())) return false;
  return kind != ColumnInfo::Kind::count || value.get<double>() >= 0;
}

}  // namespace

RowVerdict::RowVerdict(const std::vector<ColumnInfo>& columns, const std::vector<Row>& rows) : rows_(rows) {
  require(!rows.empty(), "there are no rows");
  for (const Row& row : rows) {
    require(row.is_object(), "a row is not an object");
    if (!row.is_object()) continue;
    for (const auto& [name, value] : row.items()) {
      const auto column = std::ranges::find(columns, name, &ColumnInfo::name);
      if (column == columns.end())
        messages_.push_back(fmt::format("{} is none of the experiment's columns", name));
      else
        require(is_of_kind(value, column->kind), fmt::format("{} = {} is not a value of its kind", name, value.dump()));
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

void check_surface(RowVerdict& verdict, bool continuous_blend) {
  verdict.in_order("gap_mean", "gap_max");
  verdict.in_order("gap_mean_pixels", "gap_pixels");
  verdict.in_order("jump_p99", "jump_max");
  verdict.in_order("jump_p99_pixels", "jump_pixels");
  verdict.at_most("cracked_frames", 100);
  for (const Row& row : verdict.rows()) {
    if (!row.is_object()) continue;
    const auto zero = [&](const char* column) { return number_in(row, column).value_or(0) == 0; };
    const bool gaps_known = number_in(row, "gap_max").has_value();  // patches have none
    verdict.require(!gaps_known || !zero("gap_max") || zero("open_edges"), "residual edges without a gap");
    if (row.value("admissible", Row()) != true) continue;
    for (const char* column : {"open_edges", "gap_max", "gap_pixels", "torn_pixels"})
      verdict.require(zero(column), std::string(column) + " is not 0, although the radii are admissible");
    if (continuous_blend)
      verdict.require(number_in(row, "jump_over_bound").value_or(0) <= 1,
                      "a vertex jumps beyond its bound, although the radii are admissible and the blend is continuous");
  }
}

void check_frames(RowVerdict& verdict) {
  verdict.spread("frame_ms");
  verdict.in_order("frame_ms", "frame_ms_worst");
  verdict.in_order("frame_ms_median", "frame_ms_worst");
  verdict.in_order("frame_cpu_ms_min", "frame_cpu_ms");
  verdict.in_order("frame_cpu_ms", "frame_cpu_ms_max");
}

void SettingVerdict::require(bool holds, std::vector<std::string> names, const std::string& otherwise) {
  if (!holds) faults_.push_back({std::move(names), otherwise, false});
}

void SettingVerdict::idle(bool without_effect, const std::string& name, const std::string& beside) {
  if (without_effect) faults_.push_back({{name}, name + " has no effect beside " + beside, true});
}

std::string assignment(const Parameters& parameters, const std::string& name) {
  return name + " = " + parameters.json().at(name).dump();
}

}  // namespace lodestone
