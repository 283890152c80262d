// Makes and reads rows of results.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/subjects/column_info.h"

namespace lodestone {

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
