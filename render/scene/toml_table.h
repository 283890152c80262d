// Tables of a TOML file: each key is read once, with its kind and range; unknown keys are refused.
#pragma once

#include <toml++/toml.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "core/files/text_file.h"
#include "core/math/vec3.h"

namespace lodestone {

class TomlTable {
 public:
  // `name` as messages have it: "model 2".
  TomlTable(const toml::table& table, std::string file, std::string name)
      : table_(table), file_(std::move(file)), name_(std::move(name)) {}

  // True if the table has the key, which is then known to be one.
  [[nodiscard]] bool has(std::string_view key) {
    read_.emplace(key);
    return table_.contains(key);
  }
  // For keys without one of which the table means nothing. One that is misspelt is named as it is in the file.
  [[noreturn]] void fail_missing(const toml::node& at, const std::vector<std::string>& keys,
                                 const std::string& what) const {
    for (const auto& [key, node] : table_)
      if (!read_.contains(std::string(key.str())) && !nearest_name(key.str(), keys).empty())
        refuse(key, known_names(key.str(), keys));
    fail(at, keys.front(), what);
  }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const toml::source_region& source() const { return table_.source(); }

  // Leaves `to` unchanged if the key is missing.
  void number(const char* key, double& to, double least, double largest) {
    if (const toml::node* node = find(key)) to = number_of(*node, key, least, largest);
  }
  void number(const char* key, float& to, double least, double largest) {
    if (const toml::node* node = find(key)) to = static_cast<float>(number_of(*node, key, least, largest));
  }
  void integer(const char* key, std::int64_t& to, std::int64_t least, std::int64_t largest) {
    const toml::node* node = find(key);
    if (!node) return;
    const auto value = node->value_exact<std::int64_t>();
    if (!value || *value < least || *value > largest)
      fail(*node, key, "must be a whole number from " + std::to_string(least) + " to " + std::to_string(largest));
    to = *value;
  }
  void flag(const char* key, bool& to) {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_boolean()) fail(*node, key, "must be true or false");
    to = node->as_boolean()->get();
  }
  void text(const char* key, std::string& to) {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_string() || node->as_string()->get().empty()) fail(*node, key, "must be a text in quotes");
    to = node->as_string()->get();
  }
  void vector(const char* key, Vec3d& to, double least, double largest) {
    const toml::node* node = find(key);
    if (!node) return;
    const toml::array* array = node->as_array();
    if (!array || array->size() != 3) fail(*node, key, "must be three numbers, as [x, y, z]");
    to = {number_of(*array->get(0), key, least, largest), number_of(*array->get(1), key, least, largest),
          number_of(*array->get(2), key, least, largest)};
  }
  void colour(const char* key, Vec3f& to) {
    Vec3d value = to_double(to);
    vector(key, value, 0, 1);
    to = to_float(value);
  }

  // The node of a key of any kind; null if the key is missing.
  [[nodiscard]] const toml::node* find(const char* key) {
    read_.insert(key);
    return table_.get(key);
  }
  [[noreturn]] void fail(const toml::node& node, std::string_view key, const std::string& what) const {
    fail_at(node.source(), std::string(key) + " " + what);
  }
  [[noreturn]] void fail_at(const toml::source_region& place, const std::string& what) const {
    throw InputError(
        describe(file_, "line " + std::to_string(place.begin.line), (name_.empty() ? "" : name_ + ", ") + what));
  }
  // Calls read(TomlTable&) if there is a table of that name.
  template <class Read>
  void sub_table(const char* key, const Read& read) {
    const toml::node* node = find(key);
    if (!node) return;
    if (!node->is_table()) fail(*node, key, "must be a table, as [" + std::string(key) + "]");
    TomlTable table(*node->as_table(), file_, key);
    read(table);
    table.refuse_others();
  }
  // Calls read(TomlTable&, const toml::node& at) for each of an array of tables.
  template <class Read>
  void tables(const char* key, const Read& read) {
    const toml::node* node = find(key);
    if (!node) return;
    const toml::array* array = node->as_array();
    if (!array || !array->is_array_of_tables())
      fail(*node, key, "must be tables, each as [[" + std::string(key) + "]]");
    std::size_t number = 0;
    for (const toml::node& element : *array) {
      TomlTable table(*element.as_table(), file_, std::string(key) + " " + std::to_string(++number));
      read(table, element);
      table.refuse_others();
    }
  }

  // Throws InputError for a key that none of the calls before has read.
  void refuse_others() const {
    for (const auto& [key, node] : table_) {
      if (read_.contains(std::string(key.str()))) continue;
      refuse(key, known_names(key.str(), {read_.begin(), read_.end()}));
    }
  }

 private:
  [[noreturn]] void refuse(const toml::key& key, const std::string& remedy) const {
    throw InputError(describe(file_, "line " + std::to_string(key.source().begin.line),
                              "unknown key '" + std::string(key.str()) + "'" + (name_.empty() ? "" : " in " + name_),
                              remedy));
  }

  double number_of(const toml::node& node, const char* key, double least, double largest) const {
    const std::optional<double> value = node.value<double>();
    if (!node.is_number() || !value || !std::isfinite(*value) || *value < least || *value > largest) {
      const auto shown = [](double v) {
        std::string text = std::to_string(v);
        text.erase(text.find_last_not_of('0') + 1);
        if (text.back() == '.') text.pop_back();
        return text;
      };
      const bool bounded = largest < 1e29;
      fail(node, key,
           least <= -1e29 ? "must be a number"
                          : "must be a number " + (bounded ? "from " + shown(least) + " to " + shown(largest)
                                                           : (least > 0 ? "above 0" : "of at least " + shown(least))));
    }
    return *value;
  }

  const toml::table& table_;
  std::string file_, name_;
  std::set<std::string> read_;
};

// Throws FileError when the file cannot be read, InputError with the line when it is invalid TOML, or a folder.
[[nodiscard]] inline toml::table parse_toml(const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw InputError(describe(file, {}, "is a folder", "name a file (.toml)"));
  try {
    return toml::parse(read_text(file), file);
  } catch (const toml::parse_error& error) {
    throw InputError(describe(file, "line " + std::to_string(error.source().begin.line),
                              "is not valid TOML: " + std::string(error.description())));
  }
}

// A path in a TOML file is relative to the file's folder.
[[nodiscard]] inline std::string beside(const std::string& file, const std::string& path) {
  return (std::filesystem::path(file).parent_path() / path).lexically_normal().string();
}

}  // namespace lodestone
