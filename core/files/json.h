// A JSON value that may run out of memory at any place: what throws leaves whole values, and destruction allocates
// nothing. nlohmann::json promises neither: its destructor allocates, and a null that was to become an object destroys
// one that it does not have. That library still reads the texts.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace lodestone {

// A value of another kind than the caller asked for, a member that is not there, or a text that is not JSON.
struct JsonError : std::runtime_error {
  using std::runtime_error::runtime_error;
  std::size_t byte = 0;  // of a text: where it stops being JSON; 0: it is JSON, but too deep or with a number too large
};

class Json {
 public:
  class Item;  // of a list in braces
  using Array = std::vector<Json>;
  using Object = std::map<std::string, Json, std::less<>>;  // written in the order of names

  // Parsed values are nested no deeper: copies, comparisons and destruction recurse.
  static constexpr int most_depth = 500;

  Json() = default;
  Json(std::nullptr_t) {}
  template <std::same_as<bool> Bool>  // no pointer
  Json(Bool value) : value_(value) {}
  template <std::signed_integral Integer>
  Json(Integer value) : value_(static_cast<std::int64_t>(value)) {}
  template <std::unsigned_integral Integer>
  requires(!std::same_as<Integer, bool>) Json(Integer value) : value_(static_cast<std::uint64_t>(value)) {}
  template <std::floating_point Real>
  Json(Real value) : value_(static_cast<double>(value)) {}
  Json(const char* text) : value_(std::string(text)) {}
  Json(std::string_view text) : value_(std::string(text)) {}
  Json(std::string text) : value_(std::move(text)) {}
  Json(Array items) : value_(std::move(items)) {}
  Json(Object members) : value_(Box(std::move(members))) {}
  template <class Element>
  requires(!std::same_as<Element, Json>) Json(const std::vector<Element>& items)
      : value_(Array(items.begin(), items.end())) {}
  template <class Element, std::size_t N>
  Json(const std::array<Element, N>& items) : value_(Array(items.begin(), items.end())) {}
  template <class Value, class Less>
  requires(!std::same_as<std::map<std::string, Value, Less>, Object>)
      Json(const std::map<std::string, Value, Less>& members)
      : value_(Box(Object(members.begin(), members.end()))) {}
  // {{"name", value}, ...} is an object, any other list an array; but {json} alone may be that value: array({json}).
  Json(std::initializer_list<Item> list);

  [[nodiscard]] static Json array() { return Array(); }
  [[nodiscard]] static Json array(std::initializer_list<Item> items);
  [[nodiscard]] static Json object() { return Object(); }
  // Throws JsonError. Of members of one name the last counts.
  [[nodiscard]] static Json parse(std::string_view text);

  [[nodiscard]] bool is_null() const { return is<std::nullptr_t>(); }
  [[nodiscard]] bool is_boolean() const { return is<bool>(); }
  [[nodiscard]] bool is_number_unsigned() const { return is<std::uint64_t>(); }
  [[nodiscard]] bool is_number_integer() const { return is<std::int64_t>() || is<std::uint64_t>(); }
  [[nodiscard]] bool is_number_float() const { return is<double>(); }
  [[nodiscard]] bool is_number() const { return is_number_integer() || is_number_float(); }
  [[nodiscard]] bool is_string() const { return is<std::string>(); }
  [[nodiscard]] bool is_array() const { return is<Array>(); }
  [[nodiscard]] bool is_object() const { return is<Object>(); }
  [[nodiscard]] bool is_structured() const { return is_array() || is_object(); }
  [[nodiscard]] const char* type_name() const;  // "number" for each kind of number

  // The value as bool, number of any kind, std::string, or std::vector or std::array of these.
  template <class Value>
  [[nodiscard]] Value get() const {
    if constexpr (std::same_as<Value, bool>)
      return ask<bool>();
    else if constexpr (std::is_arithmetic_v<Value>)
      return std::visit([](auto number) { return static_cast<Value>(number); }, number());
    else if constexpr (std::same_as<Value, std::string>)
      return string();
    else
      return list<Value>();
  }
  [[nodiscard]] const std::string& string() const { return ask<std::string>(); }

  // Items of an array; null is an empty one. To change the item after the last adds it.
  [[nodiscard]] Json* begin() { return items_of().data(); }
  [[nodiscard]] Json* end() { return begin() + items_of().size(); }
  [[nodiscard]] const Json* begin() const { return items_of().data(); }
  [[nodiscard]] const Json* end() const { return begin() + items_of().size(); }
  template <std::integral Index>
  [[nodiscard]] Json& operator[](Index index) {
    return item(static_cast<std::size_t>(index));
  }
  template <std::integral Index>
  [[nodiscard]] const Json& operator[](Index index) const {
    return at(static_cast<std::size_t>(index));
  }
  [[nodiscard]] const Json& at(std::size_t index) const;
  [[nodiscard]] Json& back() { return (*this)[size() - 1]; }
  void push_back(Json item) { make<Array>().push_back(std::move(item)); }  // null becomes an array

  // Members of an object.
  [[nodiscard]] Object& items() { return ask<Object>(); }
  [[nodiscard]] const Object& items() const { return ask<Object>(); }
  // Null becomes an object; a member that is not there becomes null.
  [[nodiscard]] Json& operator[](std::string_view name);
  [[nodiscard]] const Json& operator[](std::string_view name) const { return at(name); }
  [[nodiscard]] const Json& at(std::string_view name) const;
  [[nodiscard]] const Json* find(std::string_view name) const;  // null if there is none, or this is not an object
  [[nodiscard]] Json* find(std::string_view name) { return const_cast<Json*>(std::as_const(*this).find(name)); }
  [[nodiscard]] bool contains(std::string_view name) const { return find(name) != nullptr; }
  template <class Value>
  [[nodiscard]] Value value(std::string_view name, Value otherwise) const {
    const Json* const member = find(name);
    if (member == nullptr) return otherwise;
    if constexpr (std::same_as<Value, Json>)
      return *member;
    else
      return member->get<Value>();
  }
  [[nodiscard]] std::string value(std::string_view name, const char* otherwise) const {
    return value(name, std::string(otherwise));
  }
  std::size_t erase(std::string_view name);  // the number of members that were of this name
  void update(const Json& members);          // adds them, or replaces those of the same name; null becomes an object

  // The number of items or members; 0 for null, 1 for other values.
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool empty() const { return size() == 0; }

  // The text: on one line, or with `indent` spaces a level. What is not UTF-8 is replaced; numbers that JSON does not
  // have are null.
  [[nodiscard]] std::string dump(int indent = -1) const;

  // Numbers of different kinds are equal when their values are.
  friend bool operator==(const Json& a, const Json& b) { return compare(a, b) == 0; }
  friend bool operator<(const Json& a, const Json& b) { return compare(a, b) < 0; }

 private:
  // Keeps a value at 40 bytes, of which an array may have millions.
  class Box {
   public:
    explicit Box(Object members = {}) : members_(std::make_unique<Object>(std::move(members))) {}
    Box(const Box& other) : Box(*other.members_) {}
    Box(Box&&) = default;
    Box& operator=(Box other) noexcept {
      members_.swap(other.members_);
      return *this;
    }
    [[nodiscard]] const Object& operator*() const { return *members_; }

   private:
    std::unique_ptr<Object> members_;
  };
  using Number = std::variant<bool, std::int64_t, std::uint64_t, double>;

  template <class Kind>
  using Stored = std::conditional_t<std::same_as<Kind, Object>, Box, Kind>;

  template <class Kind>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<Stored<Kind>>(value_);
  }
  template <class Kind>
  [[nodiscard]] const Kind& ask() const {
    if (const auto* const value = std::get_if<Stored<Kind>>(&value_)) {
      if constexpr (std::same_as<Kind, Object>)
        return **value;
      else
        return *value;
    }
    fail(Json(Kind()).type_name());
  }
  template <class Kind>
  [[nodiscard]] Kind& ask() {
    return const_cast<Kind&>(std::as_const(*this).ask<Kind>());
  }
  template <class Kind>
  [[nodiscard]] Kind& make() {
    if (is_null()) value_ = Stored<Kind>();
    return ask<Kind>();
  }
  template <class List>
  [[nodiscard]] List list() const {
    using Element = typename List::value_type;
    List list{};
    if constexpr (requires { list.reserve(1); }) {
      for (const Json& item : ask<Array>()) list.push_back(item.get<Element>());
    } else {
      for (std::size_t i = 0; i < list.size(); ++i) list[i] = at(i).get<Element>();
    }
    return list;
  }
  [[noreturn]] void fail(const char* expected) const;
  [[nodiscard]] Number number() const;
  [[nodiscard]] Array& items_of();
  [[nodiscard]] Json& item(std::size_t index);
  [[nodiscard]] const Array& items_of() const { return const_cast<Json&>(*this).items_of(); }
  static int compare(const Json& a, const Json& b);
  static int compare_numbers(const Number& a, const Number& b);
  void write(std::string& text, int indent, int depth) const;

  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Array, Box> value_;
};

// Values of a list in braces may be moved out of it.
class Json::Item {
 public:
  template <class Value>
  requires(!std::same_as<std::remove_cvref_t<Value>, Item> && std::constructible_from<Json, Value>) Item(Value&& value)
      : value_(std::forward<Value>(value)) {}
  Item(std::initializer_list<Item> list) : value_(list) {}

 private:
  friend Json;
  mutable Json value_;
};

}  // namespace lodestone
