#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "experiments/report/number_text.h"
#include "experiments/report/page_parts.h"

namespace lodestone {
namespace {

using Raw = Html::Raw;

std::string cell_text(const SettingCell& cell, const ShownUnit& unit) {
  return cell.is_number() ? number_text(cell.number() / unit.divisor) : value_text(cell.value);
}

// How many different values a column has among the settings, null among them.
std::size_t count_values(const SettingTable& table, const std::string& name) {
  std::set<std::string> values;
  for (const SettingRow& setting : table.settings) values.insert(setting.at(name).value.dump());
  return values.size();
}

// Columns of the table, and those that are the same in all of its rows.
struct Shown {
  std::vector<ColumnInfo> columns, same;
};

// Of the columns those that the sweep lists, behind what tells rows apart; all where it lists none.
std::vector<ColumnInfo> wanted_columns(const SweepRecord& sweep, const SettingTable& table) {
  if (sweep.metrics.empty()) return table.columns;
  const auto is_listed = [&](const ColumnInfo& column) {
    return std::ranges::find(sweep.metrics, column.name) != sweep.metrics.end();
  };
  std::vector<ColumnInfo> wanted;
  for (const ColumnInfo& column : table.columns)
    if ((column.kind == ColumnInfo::Kind::label || column.kind == ColumnInfo::Kind::count) && !is_listed(column) &&
        parts_rows(table, column.name))
      wanted.push_back(column);
  for (const std::string& name : sweep.metrics)
    for (const auto* list : {&table.columns, &sweep.columns})  // ranges are columns of the sweep alone
      if (const auto found = std::ranges::find(*list, name, &ColumnInfo::name); found != list->end()) {
        wanted.push_back(*found);
        break;
      }
  return wanted;
}

Shown choose_columns(const SweepRecord& sweep, const SettingTable& table) {
  Shown shown;
  const std::vector<ColumnInfo> wanted = wanted_columns(sweep, table);
  for (const auto* list : {&table.parameters, &wanted})
    for (const ColumnInfo& column : *list) {
      const SettingCell& first = table.settings.front().at(column.name);
      const bool parameter = list == &table.parameters;
      const bool measured =
          !sweep.metrics.empty() || (column.kind != ColumnInfo::Kind::label && column.kind != ColumnInfo::Kind::count);
      if (count_values(table, column.name) > 1 || (!parameter && measured && !first.value.is_null()))
        shown.columns.push_back(column);
      else if (!first.value.is_null())
        shown.same.push_back(column);
    }
  return shown;
}

void add_same(Html& page, const SettingTable& table, const std::vector<ColumnInfo>& same) {
  if (same.empty()) return;
  page.add("<details><summary>The same in all rows: {}</summary>\n<dl class=\"same\">\n",
           counted(same.size(), "column"));
  for (const ColumnInfo& column : same) {
    const ShownUnit unit = shown_unit(column.unit);
    page.add("<div><dt title=\"{}\">{}</dt><dd>{}{}</dd></div>\n", column.meaning, column.name,
             cell_text(table.settings.front().at(column.name), unit), unit.name.empty() ? "" : " " + unit.name);
  }
  page.raw("</dl></details>\n");
}

void add_meanings(Html& page, const std::vector<ColumnInfo>& columns) {
  page.raw("<details><summary>What the columns mean</summary>\n<dl class=\"meanings\">\n");
  for (const ColumnInfo& column : columns)
    if (!column.meaning.empty()) page.add("<div><dt>{}</dt><dd>{}</dd></div>\n", column.name, column.meaning);
  page.raw("</dl></details>\n");
}

void add_header(Html& page, const SettingTable& table, const std::vector<ColumnInfo>& columns) {
  page.raw("<thead><tr>");
  for (const ColumnInfo& column : columns) {
    const std::string unit = shown_unit(column.unit).name;
    const bool number = std::any_of(table.settings.begin(), table.settings.end(),
                                    [&](const SettingRow& s) { return s.at(column.name).is_number(); });
    page.add("<th scope=\"col\"{} title=\"{}\">{}{}</th>", Raw{number ? " class=\"n\"" : ""}, column.meaning,
             column.name, Raw{unit.empty() ? "" : fmt::format(" <small>{}</small>", escape_html(unit))});
  }
  page.raw("<th scope=\"col\" title=\"folder below runs/\">run</th></tr></thead>\n");
}

void add_cell(Html& page, const ColumnInfo& column, const SettingCell& cell, bool heads_row) {
  const ShownUnit unit = shown_unit(column.unit);
  const char* tag = heads_row ? "th scope=\"row\"" : "td";
  if (!cell.is_number()) {
    page.add("<{}>{}</{}>", Raw{tag}, cell_text(cell, unit), Raw{heads_row ? "th" : "td"});
    return;
  }
  const bool range = cell.least != cell.most;
  page.add("<{} class=\"n\" data-v=\"{}\">{}{}</{}>", Raw{tag}, cell.number(), cell_text(cell, unit),
           Raw{range ? fmt::format(" <small>{} – {}</small>", number_text(cell.least / unit.divisor),
                                   number_text(cell.most / unit.divisor))
                     : std::string()},
           Raw{heads_row ? "th" : "td"});
}

void add_table(Html& page, const SweepRecord& sweep, const SettingTable& table) {
  const Shown shown = choose_columns(sweep, table);
  add_meanings(page, shown.columns);
  add_same(page, table, shown.same);
  open_table(page,
             fmt::format("Sweep {}: {} settings; costs are medians, with least and largest", sweep.name,
                         table.settings.size()),
             "sort filter");
  add_header(page, table, shown.columns);
  page.raw("<tbody>\n");
  for (const SettingRow& setting : table.settings) {
    page.raw("<tr>");
    for (std::size_t i = 0; i < shown.columns.size(); ++i)
      add_cell(page, shown.columns[i], setting.at(shown.columns[i].name), i == 0);
    page.add("<td><code title=\"runs/{0}\">{1}</code></td></tr>\n", sweep.runs[setting.run].id,
             sweep.runs[setting.run].id.substr(0, 8));
  }
  page.raw("</tbody>");
  close_table(page);
}

}  // namespace

void add_setting_tables(Html& page, const StudyReport& entry, const SectionPlace& place) {
  add_heading(page, place.level, "Tables", place.prefix + "-tables");
  for (std::size_t i = 0; i < entry.tables.size(); ++i) {
    const SweepRecord& sweep = entry.study.sweeps[i];
    add_heading(page, place.level + 1, sweep.name);
    if (entry.tables[i].settings.empty())
      page.raw("<p class=\"aside\">No run of this sweep has rows that verified.</p>\n");
    else
      add_table(page, sweep, entry.tables[i]);
  }
}

}  // namespace lodestone
