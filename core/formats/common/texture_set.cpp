#include "core/formats/common/texture_set.h"

#include <utility>

#include "core/base/error.h"
#include "core/files/text_scanner.h"

namespace lodestone {
namespace {

constexpr const char* no_image = "is no PNG, JPEG, WebP or KTX2 image";

}  // namespace

std::uint32_t TextureSet::add_file(const std::string& name, const std::string& place, TextureWraps wraps) {
  const std::optional<std::filesystem::path> path = files_.find(name);
  const auto [known, is_new] = known_.try_emplace({path ? path->string() : name, wraps.u, wraps.v}, no_texture);
  if (!is_new) return known->second;
  if (!path) return refuse(name, place, "cannot be found");
  try {
    ByteReader input(*path);
    if (image_media_type(input.window(16)).empty()) return refuse(name, place, no_image);
    known->second = add_bytes(name, place, read_all(input), wraps);
  } catch (const FileError&) {
    return refuse(name, place, "cannot be read");
  }
  return known->second;
}

std::uint32_t TextureSet::add_bytes(const std::string& name, const std::string& place, std::vector<char> bytes,
                                    TextureWraps wraps) {
  std::string type = image_media_type({bytes.data(), bytes.size()});
  if (type.empty()) return refuse(name, place, no_image);
  mesh_->textures.push_back({name, std::move(type), wraps.u, wraps.v, std::move(bytes)});
  return static_cast<std::uint32_t>(mesh_->textures.size() - 1);
}

std::uint32_t TextureSet::refuse(const std::string& name, const std::string& place, const std::string& why) {
  mesh_->warnings.push_back(describe(file_, place, "texture " + quote(name) + " " + why + " and is left out"));
  return no_texture;
}

}  // namespace lodestone
