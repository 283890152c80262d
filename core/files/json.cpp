#include "core/files/json.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <compare>
#include <nlohmann/json.hpp>

namespace lodestone {
namespace {

// Makes the value while the library reads the text.
class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit Builder(Json& root) : open_{&root} {}

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return false; }  // not in texts
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    member_ = &(*open_.back())[name];
    return true;
  }
  bool parse_error(std::size_t byte, const std::string&, const nlohmann::json::exception& error) override {
    const bool syntax = dynamic_cast<const nlohmann::json::parse_error*>(&error) != nullptr;
    fail(syntax ? error.what() : "holds a number out of range", syntax ? byte : 0);
  }

 private:
  [[noreturn]] static void fail(const std::string& what, std::size_t byte) {
    JsonError error(what);
    error.byte = byte;
    throw error;
  }

  // The place of the next value: the whole, a member, or a new item. Items move only while nothing in them is open.
  Json& place() {
    Json& parent = *open_.back();
    if (parent.is_object()) return *member_;
    if (!parent.is_array()) return parent;
    parent.push_back(nullptr);
    return parent.back();
  }
  bool put(Json value) {
    place() = std::move(value);
    return true;
  }
  bool open(Json value) {
    if (open_.size() > Json::most_depth) fail("is nested more than " + std::to_string(Json::most_depth) + " deep", 0);
    Json& at = place();
    at = std::move(value);
    open_.push_back(&at);
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  std::vector<Json*> open_;  // the root, and in it the arrays and objects whose end is not read yet
  Json* member_ = nullptr;
};

void write_number(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  const double size = std::abs(value);
  const bool plain = size == 0 || (size >= 1e-4 && size < 1e15);
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.begin(), digits.end(), value,
                                 plain ? std::chars_format::fixed : std::chars_format::scientific)
                       .ptr;
  const std::string_view number(digits.data(), static_cast<std::size_t>(end - digits.data()));
  text += number;
  if (plain && number.find('.') == number.npos) text += ".0";  // remains a float when it is read again
}

void write_string(std::string& text, const std::string& value) {
  const bool plain = std::ranges::all_of(value, [](char c) { return c >= ' ' && c != '"' && c != '\\' && c != 127; });
  if (plain)
    text.append(1, '"').append(value).append(1, '"');
  else
    text += nlohmann::json(value).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void new_line(std::string& text, int indent, int depth) {
  if (indent < 0) return;
  text += '\n';
  text.append(static_cast<std::size_t>(indent) * static_cast<std::size_t>(depth), ' ');
}

int sign(std::partial_ordering order) { return order < 0 ? -1 : order > 0 ? 1 : 0; }

}  // namespace

Json::Json(std::initializer_list<Item> list) {
  const bool members = std::ranges::all_of(list, [](const Item& item) {
    const Json& value = item.value_;
    return value.is_array() && value.size() == 2 && value[0].is_string();
  });
  if (!members) {
    *this = array(list);
    return;
  }
  Object object;
  for (const Item& item : list) object.emplace(item.value_[0].string(), std::move(item.value_[1]));
  value_ = Box(std::move(object));
}

Json Json::array(std::initializer_list<Item> items) {
  Array array;
  array.reserve(items.size());
  for (const Item& item : items) array.push_back(std::move(item.value_));
  return array;
}

Json Json::parse(std::string_view text) {
  Json root;
  Builder builder(root);
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  return root;
}

const char* Json::type_name() const {
  constexpr std::array names{"null", "boolean", "number", "number", "number", "string", "array", "object"};
  return names[value_.index()];
}

void Json::fail(const char* expected) const {
  throw JsonError(std::string("expected ") + expected + ", found " + type_name());
}

Json::Number Json::number() const {
  return std::visit(
      [this](const auto& value) -> Number {
        if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(value)>>)
          return value;
        else
          fail("number");
      },
      value_);
}

Json::Array& Json::items_of() {
  static Array none;  // remains empty
  return is_null() ? none : ask<Array>();
}

Json& Json::item(std::size_t index) {
  if (index == size()) push_back(nullptr);
  return const_cast<Json&>(at(index));
}

const Json& Json::at(std::size_t index) const {
  const Array& items = ask<Array>();
  if (index >= items.size()) throw JsonError("has no item " + std::to_string(index));
  return items[index];
}

Json& Json::operator[](std::string_view name) {
  Object& members = make<Object>();
  const auto found = members.find(name);
  return found != members.end() ? found->second : members.emplace(name, Json()).first->second;
}

const Json& Json::at(std::string_view name) const {
  const Object& members = ask<Object>();
  const auto found = members.find(name);
  if (found == members.end()) throw JsonError("has no member '" + std::string(name) + "'");
  return found->second;
}

const Json* Json::find(std::string_view name) const {
  if (!is_object()) return nullptr;
  const Object& members = items();
  const auto found = members.find(name);
  return found == members.end() ? nullptr : &found->second;
}

std::size_t Json::erase(std::string_view name) {
  Object& members = items();
  const auto found = members.find(name);
  if (found == members.end()) return 0;
  members.erase(found);
  return 1;
}

void Json::update(const Json& members) {
  for (const auto& [name, value] : members.items()) (*this)[name] = value;
}

std::size_t Json::size() const {
  if (is_null()) return 0;
  if (is_object()) return items().size();
  return is_array() ? items_of().size() : 1;
}

std::string Json::dump(int indent) const {
  std::string text;
  write(text, indent, 0);
  return text;
}

void Json::write(std::string& text, int indent, int depth) const {
  if (is_null()) {
    text += "null";
  } else if (is_boolean()) {
    text += get<bool>() ? "true" : "false";
  } else if (is_number_float()) {
    write_number(text, get<double>());
  } else if (is_number()) {
    text += std::visit([](auto integer) { return std::to_string(integer); }, number());
  } else if (is_string()) {
    write_string(text, string());
  } else if (is_array()) {
    text += '[';
    for (const Json& item : *this) {
      if (&item != begin()) text += ',';
      new_line(text, indent, depth + 1);
      item.write(text, indent, depth + 1);
    }
    if (!empty()) new_line(text, indent, depth);
    text += ']';
  } else {
    text += '{';
    bool first = true;
    for (const auto& [name, value] : items()) {
      if (!std::exchange(first, false)) text += ',';
      new_line(text, indent, depth + 1);
      write_string(text, name);
      text += indent < 0 ? ":" : ": ";
      value.write(text, indent, depth + 1);
    }
    if (!empty()) new_line(text, indent, depth);
    text += '}';
  }
}

int Json::compare_numbers(const Number& a, const Number& b) {
  return std::visit(
      [](auto x, auto y) {
        if constexpr (std::is_floating_point_v<decltype(x)> || std::is_floating_point_v<decltype(y)>)
          return sign(static_cast<double>(x) <=> static_cast<double>(y));
        else if constexpr (std::same_as<decltype(x), bool> || std::same_as<decltype(y), bool>)
          return sign(static_cast<int>(x) <=> static_cast<int>(y));
        else
          return std::cmp_less(x, y) ? -1 : std::cmp_less(y, x) ? 1 : 0;
      },
      a, b);
}

int Json::compare(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) return compare_numbers(a.number(), b.number());
  const std::size_t kind = a.value_.index();
  if (kind != b.value_.index()) return kind < b.value_.index() ? -1 : 1;
  const auto order = [](const auto& x, const auto& y) { return x < y ? -1 : y < x ? 1 : 0; };
  if (a.is_array()) return order(a.items_of(), b.items_of());
  if (a.is_object()) return order(a.items(), b.items());
  if (a.is_string()) return order(a.string(), b.string());
  return a.is_null() ? 0 : order(a.get<bool>(), b.get<bool>());
}

}  // namespace lodestone
