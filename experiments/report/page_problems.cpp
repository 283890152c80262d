#include <fmt/core.h>

#include <set>

#include "experiments/report/number_text.h"
#include "experiments/report/page_parts.h"

namespace lodestone {
namespace {

// A run as people know it: data and the parameters that its sweep varies.
std::string run_label(const SweepRecord& sweep, const RunRecord& run) {
  std::string label = run.data;
  for (const ParameterInfo& parameter : sweep.parameters) {
    std::set<std::string> values;
    for (const RunRecord& other : sweep.runs)
      values.insert(other.parameters.value(parameter.name, nlohmann::json()).dump());
    if (values.size() > 1)
      label += fmt::format("{}{} = {}", label.empty() ? "" : ", ", parameter.name,
                           value_text(run.parameters.value(parameter.name, nlohmann::json())));
  }
  return label;
}

std::string joined(const std::vector<std::string>& messages) {
  std::string text;
  for (const std::string& message : messages) text += (text.empty() ? "" : "; ") + message;
  return text;
}

struct Problem {
  const SweepRecord* sweep;
  const RunRecord* run;
  std::string repetitions, kind, why;
};

std::string kind_text(const std::string& kind) {
  if (kind == "verify") return "did not verify";
  return kind == "error" ? "ended in an error" : "crashed";
}

std::vector<Problem> list_problems(const Study& study) {
  std::vector<Problem> problems;
  for (const SweepRecord& sweep : study.sweeps)
    for (const RunRecord& run : sweep.runs) {
      std::string lacking;
      for (const Repetition& r : run.repetitions) {
        if (r.fault)
          problems.push_back(
              {&sweep, &run, std::to_string(r.number), kind_text(r.fault->kind), joined(r.fault->messages)});
        else if (!r.has_rows)
          lacking += (lacking.empty() ? "" : ", ") + std::to_string(r.number);
      }
      if (!run.unsteady.empty()) problems.push_back({&sweep, &run, "all", kind_text("verify"), joined(run.unsteady)});
      if (!lacking.empty()) problems.push_back({&sweep, &run, lacking, "not yet run", ""});
    }
  return problems;
}

void add_problem_table(Html& page, const std::vector<Problem>& problems) {
  open_table(page, "Runs that are left out or lack repetitions", "sort filter");
  page.raw(
      "<thead><tr><th scope=\"col\">run</th><th scope=\"col\">sweep</th><th scope=\"col\">setting</th>"
      "<th scope=\"col\">repetition</th><th scope=\"col\">what</th><th scope=\"col\">why</th></tr></thead>\n<tbody>\n");
  for (const Problem& p : problems)
    page.add(
        "<tr><th scope=\"row\"><code title=\"runs/{0}/log.txt\">{1}</code></th><td>{2}</td><td class=\"long\">{3}</td>"
        "<td>{4}</td><td class=\"{7}\">{5}</td><td class=\"long\">{6}</td></tr>\n",
        p.run->id, p.run->id.substr(0, 8), p.sweep->name, run_label(*p.sweep, *p.run), p.repetitions, p.kind, p.why,
        p.kind == "not yet run" ? "" : "warn");
  page.raw("</tbody>");
  close_table(page);
}

// Rows of a run that did not verify, all repetitions, the columns that they have.
void add_rows(Html& page, const SweepRecord& sweep, const RunRecord& run) {
  std::set<std::string> names;
  for (const Repetition& r : run.repetitions)
    for (const Row& row : r.rows)
      for (const auto& [name, value] : row.items())
        if (!value.is_null()) names.insert(name);
  if (names.empty()) return;
  open_table(page, fmt::format("Run {}: {}", run.id.substr(0, 8), run_label(sweep, run)), "sort");
  page.raw("<thead><tr><th scope=\"col\" class=\"n\">repetition</th>");
  std::vector<const ColumnInfo*> columns;
  for (const ColumnInfo& column : sweep.columns)
    if (names.contains(column.name)) columns.push_back(&column);
  for (const ColumnInfo* column : columns)
    page.add("<th scope=\"col\" title=\"{}\">{} <small>{}</small></th>", column->meaning, column->name,
             shown_unit(column->unit).name);
  page.raw("</tr></thead>\n<tbody>\n");
  for (const Repetition& r : run.repetitions)
    for (const Row& row : r.rows) {
      page.add("<tr><th scope=\"row\" class=\"n\" data-v=\"{0}\">{0}</th>", r.number);
      for (const ColumnInfo* column : columns) {
        const nlohmann::json value = row.value(column->name, nlohmann::json());
        if (value.is_number())
          page.add("<td class=\"n\" data-v=\"{}\">{}</td>", value.get<double>(),
                   number_text(value.get<double>() / shown_unit(column->unit).divisor));
        else
          page.add("<td>{}</td>", value_text(value));
      }
      page.raw("</tr>\n");
    }
  page.raw("</tbody>");
  close_table(page);
}

void add_unverified_rows(Html& page, const Study& study) {
  bool opened = false;
  std::set<std::string> seen;
  for (const SweepRecord& sweep : study.sweeps)
    for (const RunRecord& run : sweep.runs) {
      if (state_of(run) != RunState::unverified || !seen.insert(run.id).second) continue;
      if (!opened) page.raw("<details><summary>Rows that did not verify; no figure and no table has them</summary>\n");
      opened = true;
      add_rows(page, sweep, run);
    }
  if (opened) page.raw("</details>\n");
}

}  // namespace

void add_problems(Html& page, const StudyReport& entry, const SectionPlace& place) {
  add_heading(page, place.level, "Problems", place.prefix + "-problems");
  const std::vector<Problem> problems = list_problems(entry.study);
  if (problems.empty()) {
    page.raw("<p class=\"aside\">None: every repetition of every run is there and verified.</p>\n");
    return;
  }
  add_problem_table(page, problems);
  add_unverified_rows(page, entry.study);
}

void add_manifest(Html& page, const StudyReport& entry, const SectionPlace& place) {
  add_heading(page, place.level, "Manifest", place.prefix + "-manifest");
  const std::vector<ManifestLine> lines = summarize_manifests(entry.study);
  if (lines.empty()) page.raw("<p class=\"aside\">No run has left a manifest.</p>\n");
  if (!lines.empty()) {
    open_table(page, "What it ran on and with, over all repetitions");
    page.raw("<thead><tr><th scope=\"col\">key</th><th scope=\"col\">value</th></tr></thead>\n<tbody>\n");
    for (const ManifestLine& line : lines)
      page.add("<tr><th scope=\"row\">{}</th><td class=\"long\">{}</td></tr>\n", line.key, line.text);
    page.raw("</tbody>");
    close_table(page);
  }
  std::set<std::vector<std::string>> inputs;
  for (const SweepRecord& sweep : entry.study.sweeps)
    for (const RunRecord& run : sweep.runs)
      if (!run.input_sha256.empty()) inputs.insert({run.data, run.input, run.input_sha256});
  if (inputs.empty()) return;
  open_table(page, "Inputs");
  page.raw(
      "<thead><tr><th scope=\"col\">data</th><th scope=\"col\">file</th><th "
      "scope=\"col\">hash</th></tr></thead>\n<tbody>\n");
  for (const auto& input : inputs)
    page.add("<tr><th scope=\"row\">{}</th><td>{}</td><td><code>{}</code></td></tr>\n", input[0], input[1], input[2]);
  page.raw("</tbody>");
  close_table(page);
}

}  // namespace lodestone
