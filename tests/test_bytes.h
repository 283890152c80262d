// Arrays compared and collected byte by byte, so that the sign of a zero and the bits of a NaN count.
#pragma once

#include <algorithm>
#include <cstring>
#include <ranges>
#include <span>
#include <string>
#include <vector>

#include "core/hierarchy/model/index_view.h"

namespace lodestone::test {

template <std::ranges::contiguous_range Range>
[[nodiscard]] bool same_bytes(const Range& a, const Range& b) {
  const auto left = std::as_bytes(std::span(a)), right = std::as_bytes(std::span(b));
  return left.size() == right.size() && (left.empty() || std::memcmp(left.data(), right.data(), left.size()) == 0);
}

template <std::ranges::contiguous_range Range>
void append_bytes(std::string& out, const Range& values) {
  const auto bytes = std::as_bytes(std::span(values));
  out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

// Indices count as those of 32 bits, however they are stored.
template <class Value>
[[nodiscard]] bool same_bytes(const IndexView<Value>& a, const IndexView<Value>& b) {
  return std::ranges::equal(a, b);
}

template <class Value>
void append_bytes(std::string& out, const IndexView<Value>& values) {
  append_bytes(out, std::vector<Value>(values.begin(), values.end()));
}

}  // namespace lodestone::test
