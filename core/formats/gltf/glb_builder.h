// What every writer of binary glTF needs: views, accessors, materials and textures, and the container around them.
#pragma once

#include <cstddef>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/attributes.h"

namespace lodestone {

// Numbers of the glTF specification.
enum class GltfComponent : int { unsigned_short = 5123, unsigned_int = 5125, floats = 5126 };
enum class GltfTarget : int { none = 0, vertices = 34962, indices = 34963 };

class GlbBuilder {
 public:
  GlbBuilder() { root["asset"] = {{"version", "2.0"}, {"generator", "Lodestone"}}; }

  nlohmann::json root;  // the document; what is not added below is the caller's

  // Bytes of a buffer view, at a multiple of four; returns its number.
  std::size_t add_view(std::span<const std::byte> bytes, GltfTarget target);

  // A view of its own for an array; `type` as in the specification. Returns the number of the accessor.
  template <class T>
  std::size_t add_accessor(std::span<const T> items, GltfComponent component, const char* type, GltfTarget target) {
    root["accessors"].push_back({{"bufferView", add_view(std::as_bytes(items), target)},
                                 {"componentType", static_cast<int>(component)},
                                 {"count", items.size()},
                                 {"type", type}});
    return root["accessors"].size() - 1;
  }
  // Unsigned integers of 16 bits per vertex, each at a multiple of four bytes as vertices have to be.
  std::size_t add_vertex_shorts(std::span<const std::uint16_t> items);
  // Positions with their least and largest values, as the specification asks for.
  std::size_t add_positions(std::span<const Vec3f> positions);
  // Indices of 16 bits where these can name all vertices.
  std::size_t add_indices(std::span<const std::uint32_t> ids, std::size_t vertex_count);

  // Textures of material.texture and normal_map are numbers of textures added, in order; others are left out.
  void add_material(const Material& material, std::size_t texture_count);
  // An image that lies in the file, or beside it under a relative URI.
  void add_embedded_texture(const Texture& texture);
  void add_linked_texture(const Texture& texture, const std::string& uri);

  // The file: header, JSON padded with spaces, binary chunk padded with zeros (12.3.3 and 4.4 of the specification).
  // Throws ResourceError for more than 4 GiB.
  [[nodiscard]] std::vector<std::byte> finish();
  // With the views of accessors compressed (EXT_meshopt_compression), without loss and in their order.
  [[nodiscard]] std::vector<std::byte> finish_compressed();

 private:
  void compress_view(nlohmann::json& view, const nlohmann::json& accessor, std::vector<std::byte>& packed) const;
  void add_texture(const Texture& texture, nlohmann::json image);

  std::vector<std::byte> binary_;
};

}  // namespace lodestone
