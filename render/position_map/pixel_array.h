// Arrays over the pixels of a picture of which much may be empty.
//
// Pixels are numbered row by row. The pixels of a group, 16 successive numbers, have memory together or not at all;
// groups without share one that holds the array's empty value, so that every pixel can be read. All arrays of a picture
// share the list of its groups: a quarter of a byte for each pixel, and beyond that memory follows from what is seen.
#pragma once

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace lodestone {

class PixelGroups {
 public:
  static constexpr std::size_t length = 16;

  // `wanted`: of each group, whether it has memory.
  PixelGroups(std::size_t pixels, const std::vector<std::uint8_t>& wanted) : pixels_(pixels) {
    shift_.reserve(wanted.size());
    std::uint32_t next = length;  // after the empty group
    for (std::uint32_t first = 0; const std::uint8_t has : wanted) {
      shift_.push_back((has ? next : 0) - first);
      first += length;
      if (has) next += length;
    }
    stored_ = next;
  }
  [[nodiscard]] static std::shared_ptr<const PixelGroups> all(std::size_t pixels) {
    return std::make_shared<const PixelGroups>(
        pixels, std::vector<std::uint8_t>((pixels + length - 1) / length, std::uint8_t{1}));
  }

  [[nodiscard]] std::size_t pixels() const { return pixels_; }
  [[nodiscard]] std::size_t stored() const { return stored_; }  // values of an array, with those of the empty group
  [[nodiscard]] bool has(std::size_t pixel) const { return place(shift_.data(), pixel) >= length; }
  [[nodiscard]] const std::uint32_t* shifts() const { return shift_.data(); }
  // Place of a pixel among the stored values: the shift of its group, modulo 2^32, is added to its number.
  [[nodiscard]] static std::size_t place(const std::uint32_t* shifts, std::size_t pixel) {
    return shifts[pixel / length] + static_cast<std::uint32_t>(pixel);
  }

  // Calls visit(begin, end) for the runs of pixels in [first, last) that have memory, and gap(begin, end) for those
  // between them, in ascending order, each within one group.
  template <class Visit, class Gap>
  void for_runs(std::size_t first, std::size_t last, const Visit& visit, const Gap& gap) const {
    while (first < last) {
      const std::size_t end = std::min(last, (first / length + 1) * length);
      has(first) ? visit(first, end) : gap(first, end);
      first = end;
    }
  }
  // Calls visit(i) for the pixels in [first, last) that have memory, in ascending order.
  template <class Visit>
  void for_pixels(std::size_t first, std::size_t last, const Visit& visit) const {
    const auto each = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) visit(i);
    };
    for_runs(first, last, each, [](std::size_t, std::size_t) {});
  }

 private:
  std::size_t pixels_ = 0, stored_ = length;
  std::vector<std::uint32_t> shift_;  // of each group
};

// Finds the groups of a picture. What happens between two pixels that see something is noted at the pixel above and to
// the left, and silhouettes are extended by a pixel: all pixels next to one that sees something have memory.
class PixelMarks {
 public:
  PixelMarks(int width, int height)
      : width_(width), height_(height), marked_((pixels() + PixelGroups::length - 1) / PixelGroups::length) {}

  // The pixels [first, last) of row y see something. Several workers may mark at once.
  void add(int first, int last, int y) {
    first = std::max(first - 1, 0), last = std::min(last + 1, width_);
    for (int row = std::max(y - 1, 0); row <= std::min(y + 1, height_ - 1); ++row) {
      const std::size_t begin = static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
      const std::size_t from = (begin + static_cast<std::size_t>(first)) / PixelGroups::length,
                        to = (begin + static_cast<std::size_t>(last) - 1) / PixelGroups::length;
      for (std::size_t group = from; group <= to; ++group)
        std::atomic_ref(marked_[group]).store(1, std::memory_order_relaxed);
    }
  }
  // The pixels [begin, end) of row y of which sees(x) is true.
  template <class Sees>
  void add_row(int begin, int end, int y, const Sees& sees) {
    for (int x = begin; x < end; ++x) {
      if (!sees(x)) continue;
      const int first = x;
      while (x < end && sees(x)) ++x;
      add(first, x, y);
    }
  }
  [[nodiscard]] std::shared_ptr<const PixelGroups> groups() const {
    return std::make_shared<const PixelGroups>(pixels(), marked_);
  }

 private:
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }

  int width_, height_;
  std::vector<std::uint8_t> marked_;  // of each group
};

template <class T>
class PixelArray {
 public:
  PixelArray() = default;
  explicit PixelArray(std::shared_ptr<const PixelGroups> groups, const T& empty = {})
      : groups_(std::move(groups)), shifts_(groups_->shifts()), values_(groups_->stored(), empty) {}
  explicit PixelArray(const std::vector<T>& values) {
    if (values.empty()) return;  // no memory, in which the first place would lie
    resize(values.size());
    std::copy(values.begin(), values.end(), values_.begin() + PixelGroups::length);
  }

  [[nodiscard]] std::size_t size() const { return groups_ ? groups_->pixels() : 0; }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] const PixelGroups& groups() const { return *groups_; }
  [[nodiscard]] const T& operator[](std::size_t pixel) const { return values_[PixelGroups::place(shifts_, pixel)]; }
  // To be written only where the pixel has memory.
  [[nodiscard]] T& operator[](std::size_t pixel) {
    assert(groups_->has(pixel));
    return values_[PixelGroups::place(shifts_, pixel)];
  }

  void clear() { *this = {}; }
  // Memory for all pixels, unless there are as many already.
  void resize(std::size_t pixels) {
    if (pixels != size()) *this = PixelArray(PixelGroups::all(pixels));
  }
  void assign(std::size_t pixels, const T& value) { *this = PixelArray(PixelGroups::all(pixels), value); }

  // An array of other values for the same pixels with memory.
  template <class U>
  [[nodiscard]] PixelArray<U> like(const U& empty_value = {}) const {
    return PixelArray<U>(groups_, empty_value);
  }
  // The same values, stored in the groups of another array; what has no memory there becomes empty.
  template <class U>
  [[nodiscard]] PixelArray in(const PixelArray<U>& other, const T& empty_value = {}) const {
    if (empty()) return {};
    PixelArray moved = other.template like<T>(empty_value);
    moved.groups().for_pixels(0, moved.size(), [&](std::size_t i) { moved[i] = std::as_const(*this)[i]; });
    return moved;
  }
  [[nodiscard]] std::vector<T> to_vector() const {
    std::vector<T> all(size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = (*this)[i];
    return all;
  }
  friend bool operator==(const PixelArray& a, const PixelArray& b) { return a.to_vector() == b.to_vector(); }

 private:
  std::shared_ptr<const PixelGroups> groups_;
  const std::uint32_t* shifts_ = nullptr;  // of the groups
  std::vector<T> values_;                  // of the empty group, then of the others
};

}  // namespace lodestone
