#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "experiments/studies/experiment.h"

namespace lodestone {
namespace {

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

const char* kind_of(const ParameterValue& value) {
  if (value.is_boolean()) return "true or false";
  if (value.is_string()) return "a text";
  return value.is_number_integer() ? "a whole number" : "a number";
}

[[noreturn]] void fail(const ParameterInfo& info, const ParameterValue& value, const std::string& what) {
  throw InputError(fmt::format("{} = {}: {}", info.name, value.dump(), what));
}

void check_range(const ParameterInfo& info, const ParameterValue& value) {
  const double number = value.get<double>();
  if (std::isfinite(number) && number >= info.least && number <= info.most) return;
  fail(info, value,
       fmt::format("must lie from {:g} to {:g}{}", info.least, info.most, info.unit.empty() ? "" : " " + info.unit));
}

ParameterValue checked_text(const ParameterInfo& info, const ParameterValue& value) {
  const std::string& text = value.string();
  if (std::ranges::find(info.choices, text) != info.choices.end()) return value;
  if (info.choices.empty() && !info.others) return value;
  try {
    if (const auto form = info.others ? info.others->usual_form(text) : std::nullopt) return *form;
  } catch (const InputError& error) {
    fail(info, value, error.what());
  }
  fail(info, value, "unknown; known are " + known_texts(info));
}

ParameterValue checked(const ParameterInfo& info, const ParameterValue& value) {
  const ParameterValue& like = info.default_value;
  if (like.is_number_float() && value.is_number()) {
    check_range(info, value);
    return value.get<double>();
  }
  const bool alike =
      like.is_number() ? value.is_number_integer() : std::string_view(value.type_name()) == like.type_name();
  if (!alike) fail(info, value, fmt::format("must be {}", kind_of(like)));
  if (value.is_number()) {
    check_range(info, value);
    return value.get<std::int64_t>();
  }
  return value.is_string() ? checked_text(info, value) : value;
}

}  // namespace

std::string known_texts(const ParameterInfo& info) {
  std::string text = list(info.choices);
  if (info.others) text += (text.empty() ? "" : ", ") + info.others->what;
  return text;
}

bool names_file(const ParameterInfo& info, const ParameterValue& value) {
  return info.others && info.others->look_into && value.is_string() &&
         std::ranges::find(info.choices, value.get<std::string>()) == info.choices.end();
}

Parameters::Parameters(const std::vector<ParameterInfo>& known, const Json& given) : values_(Json::object()) {
  std::vector<std::string> names;
  for (const ParameterInfo& info : known) {
    names.push_back(info.name);
    values_[info.name] = checked(info, given.contains(info.name) ? given.at(info.name) : info.default_value);
  }
  for (const auto& [name, value] : given.items())
    if (!values_.contains(name))
      throw InputError(fmt::format("unknown parameter '{}'; {}", name, known_names(name, names)));
}

}  // namespace lodestone
