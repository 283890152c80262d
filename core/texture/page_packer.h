// Places of rectangles on pages of one size: shelf by shelf, each as high as the first rectangle on it.
#pragma once

#include <cassert>
#include <cstdint>
#include <vector>

#include "core/texture/image_codec.h"

namespace lodestone {

struct PagePlace {
  std::uint32_t page = 0, x = 0, y = 0;
};

class PagePacker {
 public:
  explicit PagePacker(PixelSize page) : page_(page) {}

  // No larger than a page. The first shelf that is high enough and has room, else a new one, else a new page.
  [[nodiscard]] PagePlace add(PixelSize size) {
    assert(size.width <= page_.width && size.height <= page_.height);
    for (Shelf& shelf : shelves_)
      if (size.height <= shelf.height && size.width <= page_.width - shelf.used) return put(shelf, size);
    for (std::uint32_t page = 0; page <= used_.size(); ++page) {
      if (page == used_.size()) used_.push_back(0);
      if (size.height > page_.height - used_[page]) continue;
      shelves_.push_back({page, used_[page], size.height, 0});
      used_[page] += size.height;
      return put(shelves_.back(), size);
    }
    return {};
  }
  [[nodiscard]] std::uint32_t pages() const { return static_cast<std::uint32_t>(used_.size()); }
  [[nodiscard]] PixelSize page_size() const { return page_; }

 private:
  struct Shelf {
    std::uint32_t page = 0, y = 0, height = 0, used = 0;
  };
  [[nodiscard]] static PagePlace put(Shelf& shelf, PixelSize size) {
    const PagePlace place{shelf.page, shelf.used, shelf.y};
    shelf.used += size.width;
    return place;
  }

  PixelSize page_;
  std::vector<Shelf> shelves_;
  std::vector<std::uint32_t> used_;  // height of the shelves, by page
};

// So large that any texture up to this size has room on one page with all its levels, the second in size and those
// after it in a row below the first: nine tenths of it are used then.
[[nodiscard]] constexpr PixelSize page_for(PixelSize largest) {
  constexpr std::uint32_t borders = 2 * 16;  // of the levels
  return {largest.width + borders, largest.height + (largest.height + 1) / 2 + borders};
}

}  // namespace lodestone
