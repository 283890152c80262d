#include "experiments/report/findings.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>

#include "experiments/report/number_text.h"

namespace lodestone {
namespace {

using nlohmann::json;

// Manifest keys in which the repetitions of one study should agree.
constexpr std::array one_of_a_kind = {"program", "commit", "compiler",     "flags",   "host",
                                      "cpu",     "cores",  "memory_bytes", "renderer"};

// Values by key, nested objects by dotted names, each with the number of its repetitions.
using Values = std::map<std::string, std::map<std::string, std::size_t>>;

void collect(Values& values, const std::string& prefix, const json& object) {
  for (const auto& [name, value] : object.items()) {
    const std::string key = prefix.empty() ? name : prefix + "." + name;
    if (value.is_object())
      collect(values, key, value);
    else
      ++values[key][value.dump()];
  }
}

Values collect(const Study& study) {
  Values values;
  std::set<std::string> seen;  // a run may be of several sweeps
  for (const SweepRecord& sweep : study.sweeps)
    for (const RunRecord& run : sweep.runs) {
      if (!seen.insert(run.id).second) continue;
      for (const Repetition& repetition : run.repetitions)
        if (repetition.has_rows || repetition.fault) collect(values, "", repetition.manifest);
      if (!run.program.empty() && state_of(run) != RunState::missing) ++values["program"][json(run.program).dump()];
    }
  return values;
}

// A value of a manifest: lists in a line, bytes as MiB.
std::string fact_text(const std::string& key, const json& value) {
  if (value.is_number() && key.ends_with("bytes"))
    return number_text(value.get<double>() / shown_unit("bytes").divisor) + " " + shown_unit("bytes").name;
  if (!value.is_array()) return value_text(value);
  std::string text;
  for (const json& entry : value) text += (text.empty() ? "" : ", ") + value_text(entry);
  return text;
}

std::string values_text(const std::string& key, const std::map<std::string, std::size_t>& values) {
  constexpr std::size_t few = 4;
  if (values.size() == 1) return fact_text(key, json::parse(values.begin()->first));
  std::vector<double> numbers;
  std::string list;
  for (const auto& [dump, count] : values) {
    const json value = json::parse(dump);
    if (value.is_number()) numbers.push_back(value.get<double>());
    list += fmt::format("{}{} ({}×)", list.empty() ? "" : "; ", fact_text(key, value), count);
  }
  if (values.size() <= few) return list;
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  if (numbers.size() == values.size()) return fmt::format("{} to {}", fact_text(key, *least), fact_text(key, *most));
  return fmt::format("{} different, from {} to {}", values.size(), fact_text(key, json::parse(values.begin()->first)),
                     fact_text(key, json::parse(values.rbegin()->first)));
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

void add_mixtures(std::vector<std::string>& oddities, const Study& study) {
  for (const auto& [key, values] : collect(study)) {
    const std::string last = lower(key.substr(key.rfind('.') + 1));
    const bool matters =
        std::any_of(one_of_a_kind.begin(), one_of_a_kind.end(), [&](const char* k) { return last == k; });
    if (matters && values.size() > 1)
      oddities.push_back(fmt::format("Mixed: {} has {} values: {}", key, values.size(), values_text(key, values)));
    if (last == "dirty" && values.contains("true"))
      oddities.push_back("Sources were changed after the commit: " + counted(values.at("true"), "repetition"));
  }
}

}  // namespace

RunCounts& RunCounts::operator+=(const RunCounts& o) {
  runs += o.runs, complete += o.complete, incomplete += o.incomplete;
  unverified += o.unverified, failed += o.failed, missing += o.missing;
  return *this;
}

RunCounts count_runs(const SweepRecord& sweep) {
  RunCounts counts;
  counts.runs = sweep.runs.size();
  for (const RunRecord& run : sweep.runs) switch (state_of(run)) {
      case RunState::complete:
        ++counts.complete;
        break;
      case RunState::incomplete:
        ++counts.incomplete;
        break;
      case RunState::unverified:
        ++counts.unverified;
        break;
      case RunState::failed:
        ++counts.failed;
        break;
      case RunState::missing:
        ++counts.missing;
        break;
    }
  return counts;
}

std::vector<ManifestLine> summarize_manifests(const Study& study) {
  std::vector<ManifestLine> lines;
  for (const auto& [key, values] : collect(study)) lines.push_back({key, values_text(key, values), values.size()});
  return lines;
}

std::vector<std::string> list_oddities(const Study& study) {
  std::vector<std::string> oddities;
  add_mixtures(oddities, study);
  for (const SweepRecord& sweep : study.sweeps)
    if (const RunCounts counts = count_runs(sweep); counts.incomplete > 0)
      oddities.push_back(fmt::format("Sweep {}: repetitions are missing of {}; the spread is of those that are there",
                                     sweep.name, counted(counts.incomplete, "run")));
  if (study.other_runs > 0)
    oddities.push_back(fmt::format("Left out: {} of other settings or of another program in the folder",
                                   counted(study.other_runs, "run")));
  return oddities;
}

}  // namespace lodestone
