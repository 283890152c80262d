// Rows of results: what a sweep stores and what a command prints as JSON, under the same names and in the same units.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/files/json.h"

namespace lodestone {

// name -> number, text, truth value or null (not measured in this row). A flat object.
using Row = Json;

// A condition on the setting for a column to be measured: one of these must hold.
struct ColumnNeed {
  struct Condition {
    std::string parameter;
    Json value;
    bool is = true;  // false: any other value
  };
  std::vector<Condition> any;
};

struct ColumnInfo {
  // Less is better for accuracy, more is better for quality (PSNR, SSIM).
  enum class Kind { label, accuracy, quality, cost, count };

  std::string name;
  std::string unit;     // "s", "% of the diagonal", "pixels", ...; empty: none
  std::string meaning;  // for the report and docs/schema.md
  Kind kind = Kind::count;
  std::vector<ColumnNeed> needs{};  // all of them; empty: every setting has it
};

// A column and its value in a result.
template <class Result>
struct Column {
  ColumnInfo info;
  std::function<Row(const Result&)> value;
};

template <class Result>
[[nodiscard]] std::vector<ColumnInfo> infos_of(const std::vector<Column<Result>>& columns) {
  std::vector<ColumnInfo> infos;
  for (const Column<Result>& column : columns) infos.push_back(column.info);
  return infos;
}

template <class Result>
[[nodiscard]] Row row_of(const std::vector<Column<Result>>& columns, const Result& result) {
  Row row = Row::object();
  for (const Column<Result>& column : columns) row[column.info.name] = column.value(result);
  return row;
}

// The value, or null where there is none.
template <class Value>
[[nodiscard]] Row or_null(const std::optional<Value>& value) {
  return value ? Row(*value) : Row();
}

void append(std::vector<ColumnInfo>& list, std::vector<ColumnInfo> more);
// The columns but those of these names.
[[nodiscard]] std::vector<ColumnInfo> without(std::vector<ColumnInfo> columns, const std::vector<std::string>& names);
// The row with the declared columns alone.
[[nodiscard]] Row restricted_to(const std::vector<ColumnInfo>& columns, Row row);
// The row without its null values: what a command prints.
[[nodiscard]] Json without_nulls(Row row);

// NAME, NAME_min and NAME_max: the columns of a value that is measured in several rounds, and its median and ends.
void add_spread_columns(std::vector<ColumnInfo>& columns, const std::string& name, const std::string& unit,
                        const std::string& meaning);
void add_spread(Row& row, const std::string& name, const std::vector<double>& values);
// NAME_min and NAME_max for columns that are in the list already.
[[nodiscard]] std::vector<ColumnInfo> spread_ends(const std::vector<ColumnInfo>& columns,
                                                  const std::vector<std::string>& names);

// The value of a column; empty when the row does not have it, or has null or something that is not a finite number.
[[nodiscard]] std::optional<double> number_in(const Row& row, const std::string& column);
// Likewise for a text; an empty text when the row does not have it.
[[nodiscard]] std::string text_in(const Row& row, const std::string& column);

}  // namespace lodestone
