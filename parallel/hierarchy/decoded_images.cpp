#include "parallel/hierarchy/decoded_images.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/hierarchy/model/level_mesh.h"

namespace lodestone {

// Two workers may decode an image at the same time: they get the same pixels.
std::shared_ptr<const PixelImage> DecodedImages::get(std::uint32_t texture, int level) {
  const TextureCopy* copy = texture_copy(hierarchy_, texture, level);
  const std::pair key{texture, copy ? std::uint32_t{copy->halvings} : 0u};
  {
    const std::scoped_lock lock(mutex_);
    if (const auto known = entries_.find(key); known != entries_.end()) {
      known->second.last_used = ++time_;
      return known->second.image;
    }
  }
  std::shared_ptr<const PixelImage> image = decode(texture, level);
  const std::scoped_lock lock(mutex_);
  const auto [entry, fresh] = entries_.try_emplace(key, Entry{image, 0});
  entry->second.last_used = ++time_;
  if (fresh && image) bytes_ += image->pixels.size();
  make_room();
  return image;
}

std::shared_ptr<const PixelImage> DecodedImages::decode(std::uint32_t texture, int level) const {
  const Texture& source = hierarchy_.textures[texture];
  const TextureCopy* copy = texture_copy(hierarchy_, texture, level);
  try {
    return std::make_shared<PixelImage>(decode_image(
        copy ? std::span<const char>(copy->bytes) : std::span<const char>(source.bytes), source.media_type));
  } catch (const Error&) {
    return nullptr;
  }
}

void DecodedImages::make_room() {
  while (bytes_ > most_bytes_ && entries_.size() > 1) {
    const auto oldest = std::ranges::min_element(entries_, {}, [](const auto& e) { return e.second.last_used; });
    if (oldest->second.image) bytes_ -= oldest->second.image->pixels.size();
    entries_.erase(oldest);
  }
}

}  // namespace lodestone
