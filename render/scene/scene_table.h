// Reading tables of a TOML file: each key once, with its kind and range, and none that nobody asked for.
#pragma once

#include <toml++/toml.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/base/vec3.h"

namespace lodestone {

class SceneTable {
 public:
  // `name` as messages have it: "model 2".
  SceneTable(const toml::table& table, std::string file, std::string name)
      : table_(table), file_(std::move(file)), name_(std::move(name)) {}

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
  [[nodiscard]] const std::string& file() const { return file_; }

  // Leaves `to` as it is where the key is not there.
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

  // Any node, for kinds of their own; null where the key is not there.
  [[nodiscard]] const toml::node* find(const char* key) {
    read_.insert(key);
    return table_.get(key);
  }
  [[noreturn]] void fail(const toml::node& node, std::string_view key, const std::string& what) const {
    throw InputError(describe(file_, "line " + std::to_string(node.source().begin.line),
                              (name_.empty() ? "" : name_ + ", ") + std::string(key) + " " + what));
  }
  // Throws InputError for a key that none of the calls before has asked for.
  void refuse_others() const {
    for (const auto& [key, node] : table_) {
      if (read_.contains(std::string(key.str()))) continue;
      std::string known;
      for (const std::string& k : read_) known += (known.empty() ? "" : ", ") + k;
      throw InputError(describe(file_, "line " + std::to_string(key.source().begin.line),
                                "unknown key '" + std::string(key.str()) + "'" + (name_.empty() ? "" : " in " + name_),
                                "known are " + known));
    }
  }

 private:
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

}  // namespace lodestone
