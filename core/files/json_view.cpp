#include "core/files/json_view.h"

#include <cmath>

#include "core/base/error.h"

namespace lodestone {
namespace {

const char* name_of(const Json& value) { return value.is_null() ? "nothing" : value.type_name(); }

}  // namespace

Json parse_json(std::span<const char> text, const std::string& file) {
  try {
    return Json::parse({text.data(), text.size()});
  } catch (const JsonError& error) {
    const std::string place = error.byte == 0 ? "" : "byte " + std::to_string(error.byte);
    throw InputError(describe(file, place, "invalid JSON", "the file is damaged or of another type"));
  }
}

void JsonView::fail(const std::string& what, const std::string& remedy) const {
  throw InputError(describe(*file_, place_, what, remedy));
}

std::optional<JsonView> JsonView::find(const char* key) const {
  if (!value_->is_object()) fail(std::string("expected an object, found ") + name_of(*value_));
  const Json* const member = value_->find(key);
  if (member == nullptr) return std::nullopt;
  return JsonView(*member, *file_, place_.empty() ? key : place_ + "." + key);
}

JsonView JsonView::at(const char* key) const {
  if (const std::optional<JsonView> member = find(key)) return *member;
  fail(std::string("has no '") + key + "'");
}

std::size_t JsonView::size() const {
  if (!value_->is_array()) fail(std::string("expected an array, found ") + name_of(*value_));
  return value_->size();
}

JsonView JsonView::at(std::size_t index) const {
  if (index >= size()) fail("has no element " + std::to_string(index) + ", only " + std::to_string(size()));
  return {(*value_)[index], *file_, place_ + "[" + std::to_string(index) + "]"};
}

std::uint64_t JsonView::integer() const {
  constexpr std::uint64_t most = std::uint64_t{1} << 53;
  if (value_->is_number_unsigned() && value_->get<std::uint64_t>() <= most) return value_->get<std::uint64_t>();
  if (value_->is_number_float()) {  // "3.0"
    const double number = value_->get<double>();
    if (number >= 0 && number <= static_cast<double>(most) && number == std::floor(number))
      return static_cast<std::uint64_t>(number);
  }
  fail("expected a whole number from 0 to 2^53, found " +
       (value_->is_number() ? value_->dump() : std::string(name_of(*value_))));
}

double JsonView::number() const {
  if (!value_->is_number()) fail(std::string("expected a number, found ") + name_of(*value_));
  return value_->get<double>();
}

const std::string& JsonView::string() const {
  if (!value_->is_string()) fail(std::string("expected a string, found ") + name_of(*value_));
  return value_->string();
}

bool JsonView::boolean() const {
  if (!value_->is_boolean()) fail(std::string("expected true or false, found ") + name_of(*value_));
  return value_->get<bool>();
}

std::uint64_t JsonView::integer_or(const char* key, std::uint64_t otherwise) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->integer() : otherwise;
}

std::string JsonView::string_or(const char* key, std::string otherwise) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->string() : otherwise;
}

bool JsonView::boolean_or(const char* key, bool otherwise) const {
  const std::optional<JsonView> member = find(key);
  return member ? member->boolean() : otherwise;
}

}  // namespace lodestone
