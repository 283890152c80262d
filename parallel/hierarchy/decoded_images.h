// Pixels of the textures of a hierarchy as its levels show them, kept while there is room for tasks of all workers.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "core/hierarchy/model/hierarchy.h"
#include "core/texture/image_codec.h"

namespace lodestone {

class DecodedImages {
 public:
  // At least one image is kept, however large. The hierarchy outlives this.
  DecodedImages(const Hierarchy& hierarchy, std::size_t most_bytes) : hierarchy_(hierarchy), most_bytes_(most_bytes) {}

  // Null: it cannot be decoded. May be called from any thread.
  [[nodiscard]] std::shared_ptr<const PixelImage> get(std::uint32_t texture, int level);

 private:
  struct Entry {
    std::shared_ptr<const PixelImage> image;
    std::uint64_t last_used = 0;
  };
  [[nodiscard]] std::shared_ptr<const PixelImage> decode(std::uint32_t texture, int level) const;
  void make_room();

  const Hierarchy& hierarchy_;
  std::size_t most_bytes_, bytes_ = 0;
  std::uint64_t time_ = 0;
  std::mutex mutex_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Entry> entries_;  // by texture and halvings
};

}  // namespace lodestone
