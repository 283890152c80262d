// Values of a JSON document with their place in it, for precise error messages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/files/json.h"

namespace lodestone {

// Throws InputError naming `file` and the byte for invalid JSON.
[[nodiscard]] Json parse_json(std::span<const char> text, const std::string& file);

// A value, and "nodes[3].mesh" or the like. Every function throws InputError naming file and place when the value is
// not of the requested kind. Holds references to document and file name.
class JsonView {
 public:
  JsonView(const Json& value, const std::string& file, std::string place = {})
      : value_(&value), file_(&file), place_(std::move(place)) {}

  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] const Json& json() const { return *value_; }
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = {}) const;

  // Members of an object.
  [[nodiscard]] std::optional<JsonView> find(const char* key) const;
  [[nodiscard]] JsonView at(const char* key) const;
  // Items of an array.
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] JsonView at(std::size_t index) const;

  [[nodiscard]] std::uint64_t integer() const;  // not negative, at most 2^53
  [[nodiscard]] double number() const;
  [[nodiscard]] const std::string& string() const;
  [[nodiscard]] bool boolean() const;
  // An array of N numbers.
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> numbers() const {
    if (size() != N) fail("expected " + std::to_string(N) + " numbers, found " + std::to_string(size()));
    std::array<double, N> values;
    for (std::size_t i = 0; i < N; ++i) values[i] = at(i).number();
    return values;
  }

  // The value of a member, or `otherwise` when there is no such member.
  [[nodiscard]] std::uint64_t integer_or(const char* key, std::uint64_t otherwise) const;
  [[nodiscard]] std::string string_or(const char* key, std::string otherwise) const;
  [[nodiscard]] bool boolean_or(const char* key, bool otherwise) const;
  template <std::size_t N>
  [[nodiscard]] std::array<double, N> numbers_or(const char* key, std::array<double, N> otherwise) const {
    const std::optional<JsonView> member = find(key);
    return member ? member->numbers<N>() : otherwise;
  }

 private:
  const Json* value_;
  const std::string* file_;
  std::string place_;
};

}  // namespace lodestone
