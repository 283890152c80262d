#include "experiments/command_line/option_text.h"

#include <fmt/core.h>

#include <optional>
#include <type_traits>

namespace lodestone {
namespace {

struct ValueKind {
  std::string operator()(const bool*) const { return {}; }
  std::string operator()(const Bytes*) const { return "SIZE"; }
  std::string operator()(const std::string*) const { return "TEXT"; }
  std::string operator()(const std::vector<std::string>*) const { return "TEXT"; }
  template <class Value>
  std::string operator()(const std::optional<Value>*) const {
    return (*this)(static_cast<const Value*>(nullptr));
  }
  template <class Value>
  std::string operator()(const Value*) const {
    return std::is_floating_point_v<Value> ? "NUMBER" : "INTEGER";
  }
};

struct DefaultValue {
  std::string operator()(const bool*) const { return {}; }
  std::string operator()(const Bytes*) const { return {}; }
  std::string operator()(const std::string* value) const { return *value; }
  std::string operator()(const std::vector<std::string>*) const { return {}; }
  template <class Value>
  std::string operator()(const std::optional<Value>*) const {
    return {};
  }
  template <class Value>
  std::string operator()(const Value* value) const {
    return fmt::format("{:g}", static_cast<double>(*value));
  }
};

}  // namespace

bool is_argument(const OptionSpec& option) { return option.name.find('-') == std::string::npos; }

std::vector<std::string> flags_of(const OptionSpec& option) {
  std::vector<std::string> flags;
  for (std::size_t begin = 0; begin < option.name.size() && !is_argument(option);) {
    const std::size_t end = std::min(option.name.find(',', begin), option.name.size());
    const std::string flag = option.name.substr(begin, end - begin);
    flags.push_back(flag.substr(flag.find('-')));  // without the mark of a flag that sets false
    begin = end + 1;
  }
  return flags;
}

std::string value_text(const OptionSpec& option) {
  std::string choices;
  for (const std::string& choice : option.choices) choices += (choices.empty() ? "" : "|") + choice;
  if (!choices.empty()) return choices;
  return option.type.empty() ? std::visit(ValueKind{}, option.value) : option.type;
}

std::string default_text(const OptionSpec& option) { return std::visit(DefaultValue{}, option.value); }

}  // namespace lodestone
