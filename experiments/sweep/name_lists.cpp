#include "experiments/sweep/name_lists.h"

#include <fmt/core.h>

#include <algorithm>

#include "experiments/sweep/column_presence.h"

namespace lodestone {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<std::string> texts(TomlTable& table, const char* key) {
  const toml::node* node = table.find(key);
  if (!node) return {};
  if (node->is_string()) return {node->as_string()->get()};
  const toml::array* array = node->as_array();
  if (!array || array->empty()) table.fail(*node, key, "must be a text, or texts, as [\"a\", \"b\"]");
  std::vector<std::string> list;
  for (const toml::node& element : *array) {
    if (!element.is_string()) table.fail(element, key, "must be texts, as [\"a\", \"b\"]");
    list.push_back(element.as_string()->get());
    if (std::count(list.begin(), list.end(), list.back()) > 1)
      table.fail(element, key, "has '" + list.back() + "' twice");
  }
  return list;
}

void check_presence(TomlTable& table, const char* key, const std::string& name, const SweepSection& sweep,
                    const std::string& where, SweepFile& file) {
  const ColumnPresence found = presence(sweep, name);
  if (found.remedy.empty()) return;
  if (found.settings == 0)
    table.fail(*table.find(key), key,
               fmt::format("'{0}' is measured in no setting of sweep '{1}'; {2} in sweep '{1}'", name, sweep.name,
                           found.remedy));
  file.notes.push_back(
      fmt::format("line {}: {}, {} '{}' is measured in {} of {} settings of sweep '{}' only; for the others {}",
                  table.find(key)->source().begin.line, where, key, name, found.settings, sweep.settings.size(),
                  sweep.name, found.remedy));
}

}  // namespace lodestone
