// A view of indices that are stored with 16 bits each where these suffice, or with 32, and read as 32 bits.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

// Value: std::uint32_t, or Triangle with its three of them. Elements are values, not references.
template <class Value>
class IndexView {
 public:
  static constexpr std::size_t words = sizeof(Value) / sizeof(std::uint32_t);  // indices of an element

  IndexView() = default;
  IndexView(std::span<const Value> items) : data_(items.data()), size_(items.size()) {}
  IndexView(std::span<Value> items) : IndexView(std::span<const Value>(items)) {}
  IndexView(const std::vector<Value>& items) : IndexView(std::span<const Value>(items)) {}
  // The indices of all elements.
  explicit IndexView(std::span<const std::uint16_t> indices)
      : data_(indices.data()), size_(indices.size() / words), is_short_(true) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool is_short() const { return is_short_; }

  [[nodiscard]] Value operator[](std::size_t i) const {
    if (!is_short_) return static_cast<const Value*>(data_)[i];
    const std::uint16_t* at = static_cast<const std::uint16_t*>(data_) + words * i;
    if constexpr (words == 1) {
      return *at;
    } else {
      return {{at[0], at[1], at[2]}};
    }
  }
  // Where an element lies, to be fetched ahead.
  [[nodiscard]] const void* address(std::size_t i) const {
    return static_cast<const std::byte*>(data_) +
           i * words * (is_short_ ? sizeof(std::uint16_t) : sizeof(std::uint32_t));
  }
  [[nodiscard]] Value front() const { return (*this)[0]; }
  [[nodiscard]] Value back() const { return (*this)[size_ - 1]; }

  // The indices as they are stored: those of 16 bits, if is_short(), or else the elements.
  [[nodiscard]] std::span<const std::uint16_t> short_indices() const {
    return {static_cast<const std::uint16_t*>(data_), words * size_};
  }
  [[nodiscard]] std::span<const Value> wide() const { return {static_cast<const Value*>(data_), size_}; }

  // The elements, in place if they are stored so, or else written to `room`.
  [[nodiscard]] std::span<const Value> widened(std::vector<Value>& room) const {
    if (!is_short_) return wide();
    room.assign(begin(), end());
    return room;
  }

  class Iterator {
   public:
    using iterator_concept = std::random_access_iterator_tag;
    using iterator_category = std::input_iterator_tag;
    using value_type = Value;
    using difference_type = std::ptrdiff_t;
    using reference = Value;
    using pointer = void;

    Iterator() = default;
    Iterator(IndexView view, std::size_t at) : view_(view), at_(at) {}
    Value operator*() const { return view_[at_]; }
    Value operator[](difference_type n) const { return *(*this + n); }
    Iterator& operator++() { return *this += 1; }
    Iterator& operator--() { return *this -= 1; }
    Iterator operator++(int) { return std::exchange(*this, *this + 1); }
    Iterator operator--(int) { return std::exchange(*this, *this - 1); }
    Iterator& operator+=(difference_type n) {
      at_ += static_cast<std::size_t>(n);
      return *this;
    }
    Iterator& operator-=(difference_type n) { return *this += -n; }
    friend Iterator operator+(Iterator i, difference_type n) { return i += n; }
    friend Iterator operator+(difference_type n, Iterator i) { return i += n; }
    friend Iterator operator-(Iterator i, difference_type n) { return i -= n; }
    friend difference_type operator-(const Iterator& a, const Iterator& b) {
      return static_cast<difference_type>(a.at_) - static_cast<difference_type>(b.at_);
    }
    friend bool operator==(const Iterator& a, const Iterator& b) { return a.at_ == b.at_; }
    friend auto operator<=>(const Iterator& a, const Iterator& b) { return a.at_ <=> b.at_; }

   private:
    IndexView view_;
    std::size_t at_ = 0;
  };
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size_}; }

 private:
  const void* data_ = nullptr;
  std::size_t size_ = 0;
  bool is_short_ = false;
};

using Indices = IndexView<std::uint32_t>;
using Triangles = IndexView<Triangle>;

}  // namespace lodestone
