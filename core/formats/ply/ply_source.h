// The body of a PLY file as a stream of scalars: text or binary behind one interface, for templates.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/files/text_scanner.h"
#include "core/formats/ply/ply_header.h"

namespace lodestone {

// The element being read, for messages; counted from 0.
struct PlyPlace {
  const PlyElement* element = nullptr;
  std::uint64_t index = 0;
  [[nodiscard]] std::string text() const { return "element " + quote(element->name) + " " + std::to_string(index); }
};

inline constexpr const char* ply_counts_may_be_wrong =
    "the element counts or properties of the header may be wrong, or the file is damaged";

// A body of text: values are words, wherever the line breaks are.
class PlyTextSource {
 public:
  PlyTextSource(ByteReader& input, const PlyHeader& header) : input_(&input), scan_(input, header.lines + 1) {}

  PlyPlace place;

  double number(const PlyProperty& property) {
    const std::string_view token = next();
    if (const std::optional<double> value = parse_number(token)) return *value;
    fail_expected("a number for " + quote(property.name), token);
  }
  std::int64_t integer(const PlyProperty& property) {
    const std::string_view token = next();
    if (const std::optional<std::int64_t> value = parse_integer(token)) return *value;
    fail_expected("an integer " + std::string(property.count_type ? "in the list " : "for ") + quote(property.name),
                  token);
  }
  std::int64_t length(const PlyProperty& list) {
    const std::string_view token = next();
    if (const std::optional<std::int64_t> value = parse_integer(token)) return *value;
    fail_expected("the length of the list " + quote(list.name), token);
  }
  void skip(ScalarType, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) (void)next();
  }
  // Counts from the next word on; blank lines are nothing.
  std::uint64_t bytes_left() {
    const std::string_view token = scan_.token_across_lines();
    return token.empty() ? 0 : token.size() + input_->remaining();
  }
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = {}) const {
    scan_.fail(place.text() + ": " + what, remedy);
  }

 private:
  // A word that does not fit is rarely a typing error: usually the header declares more or other values than follow, so
  // that the reader is at another place in the file than it expects.
  [[noreturn]] void fail_expected(const std::string& what, std::string_view found) const {
    fail("expected " + what + ", found " + quote(found), ply_counts_may_be_wrong);
  }
  std::string_view next() {
    const std::string_view token = scan_.token_across_lines();
    if (token.empty())
      fail(
          "the file ends before element " + std::to_string(place.index) + " of " + std::to_string(place.element->count),
          "it is truncated, or its header is damaged");
    return token;
  }
  ByteReader* input_;
  TextScanner scan_;
};

class PlyBinarySource {
 public:
  PlyBinarySource(ByteReader& input, const PlyHeader& header) : input_(&input), order_(*header.byte_order) {}

  PlyPlace place;

  double number(const PlyProperty& property) { return value<double>(property.type); }
  std::int64_t integer(const PlyProperty& property) { return value<std::int64_t>(property.type); }
  std::int64_t length(const PlyProperty& list) { return value<std::int64_t>(*list.count_type); }
  void skip(ScalarType type, std::uint64_t count) {
    if (count > input_->remaining() / size_of(type)) fail_truncated();
    input_->skip(count * size_of(type));
  }
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = {}) const {
    throw InputError(
        describe(input_->name(), place.text() + " at byte " + std::to_string(input_->offset()), what, remedy));
  }
  [[noreturn]] void fail_truncated() const {
    fail("the file ends before the " + std::to_string(place.element->count) + " elements it declares",
         "it is truncated, or its header is damaged");
  }
  [[nodiscard]] ByteReader& input() { return *input_; }
  [[nodiscard]] std::uint64_t bytes_left() const { return input_->remaining(); }

 private:
  template <class Value>
  Value value(ScalarType type) {
    const std::string_view bytes = input_->window(size_of(type));
    if (bytes.size() < size_of(type)) fail_truncated();
    const Value result = load_as<Value>(type, order_, bytes.data());
    input_->advance(size_of(type));
    return result;
  }
  ByteReader* input_;
  std::endian order_;
};

// The number of items of the list that comes next.
template <class Source>
std::uint64_t list_length(Source& source, const PlyProperty& list) {
  const std::int64_t length = source.length(list);
  if (length < 0) source.fail("a list has a negative length", ply_counts_may_be_wrong);
  return static_cast<std::uint64_t>(length);
}

template <class Source>
void skip_property(Source& source, const PlyProperty& property) {
  source.skip(property.type, property.count_type ? list_length(source, property) : 1);
}

}  // namespace lodestone
