#include "experiments/subjects/row.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "experiments/metrics/cost/order_statistics.h"

namespace lodestone {

void append(std::vector<ColumnInfo>& list, std::vector<ColumnInfo> more) {
  list.insert(list.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::vector<ColumnInfo> without(std::vector<ColumnInfo> columns, const std::vector<std::string>& names) {
  std::erase_if(columns,
                [&](const ColumnInfo& column) { return std::ranges::find(names, column.name) != names.end(); });
  return columns;
}

Row restricted_to(const std::vector<ColumnInfo>& columns, Row row) {
  std::erase_if(row.items(), [&](const auto& member) {
    return std::ranges::find(columns, member.first, &ColumnInfo::name) == columns.end();
  });
  return row;
}

Json without_nulls(Row row) {
  std::erase_if(row.items(), [](const auto& member) { return member.second.is_null(); });
  return row;
}

void add_spread_columns(std::vector<ColumnInfo>& columns, const std::string& name, const std::string& unit,
                        const std::string& meaning) {
  columns.push_back({name, unit, meaning + ", median", ColumnInfo::Kind::cost});
  append(columns, spread_ends({{name, unit, meaning}}, {name}));
}

void add_spread(Row& row, const std::string& name, const std::vector<double>& values) {
  const Spread spread = spread_of(values);
  row[name] = spread.median;
  row[name + "_min"] = spread.minimum;
  row[name + "_max"] = spread.maximum;
}

std::vector<ColumnInfo> spread_ends(const std::vector<ColumnInfo>& columns, const std::vector<std::string>& names) {
  std::vector<ColumnInfo> ends;
  for (const std::string& name : names) {
    const ColumnInfo& column = *std::ranges::find(columns, name, &ColumnInfo::name);
    ends.push_back({name + "_min", column.unit, column.meaning + ", minimum", ColumnInfo::Kind::cost});
    ends.push_back({name + "_max", column.unit, column.meaning + ", maximum", ColumnInfo::Kind::cost});
  }
  return ends;
}

std::optional<double> number_in(const Row& row, const std::string& column) {
  const Json* const found = row.find(column);
  if (!found || !found->is_number() || !std::isfinite(found->get<double>())) return {};
  return found->get<double>();
}

std::string text_in(const Row& row, const std::string& column) {
  const Json* const found = row.find(column);
  return found && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace lodestone
