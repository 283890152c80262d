// The parts that all writers of binary glTF use: views, accessors, materials and textures, and the container.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/files/json.h"
#include "core/mesh/attributes.h"
#include "core/mesh/up_axis.h"

namespace lodestone {

// Numbers of the glTF specification.
enum class GltfComponent : int { unsigned_short = 5123, unsigned_int = 5125, floats = 5126 };
enum class GltfTarget : int { none = 0, vertices = 34962, indices = 34963 };

class GlbBuilder {
 public:
  GlbBuilder() { root["asset"] = {{"version", "2.0"}, {"generator", "Lodestone"}}; }

  Json root;  // the document; the caller adds what is not added below

  // The document has one node and one mesh, at this place: a point of the model, turned y up as glTF has it.
  void add_node(Vec3d place, double scale, UpAxis up);

  // Adds the bytes of a buffer view, at a multiple of four; returns its number.
  std::size_t add_view(std::span<const std::byte> bytes, GltfTarget target);

  // Adds an array in a view of its own; `type` as in the specification. Returns the number of the accessor.
  template <class T>
  std::size_t add_accessor(std::span<const T> items, GltfComponent component, const char* type, GltfTarget target) {
    root["accessors"].push_back({{"bufferView", add_view(std::as_bytes(items), target)},
                                 {"componentType", static_cast<int>(component)},
                                 {"count", items.size()},
                                 {"type", type}});
    return root["accessors"].size() - 1;
  }
  // Adds unsigned 16-bit integers per vertex, each at a multiple of four bytes as vertices have to be.
  std::size_t add_vertex_shorts(std::span<const std::uint16_t> items);
  // Adds positions with their minimum and maximum, which the specification requires.
  std::size_t add_positions(std::span<const Vec3f> positions);
  // Adds indices, of 16 bits if these can name all vertices.
  std::size_t add_indices(std::span<const std::uint32_t> ids, std::size_t vertex_count);

  // Textures of the material are numbers in the order in which they are added; others are left out.
  void add_material(const Material& material, std::size_t texture_count);
  // Gives the primitives that have no material a white one without metal: the default of glTF is a metal, which viewers
  // show dark grey. To be called once all materials and primitives are there.
  void complete_materials();
  // Adds an image inside the file, in a view of its own or in the one given, or beside it under a relative URI.
  void add_embedded_texture(const Texture& texture);
  void add_embedded_texture(const Texture& texture, std::size_t view);
  void add_linked_texture(const Texture& texture, const std::string& uri);

  // Returns the file: header, JSON padded with spaces, binary chunk padded with zeros (12.3.3 and 4.4 of the
  // specification). Throws ResourceError for more than 4 GiB.
  [[nodiscard]] std::vector<std::byte> finish();
  // The same with the views of accessors compressed (EXT_meshopt_compression), without loss and in their order.
  [[nodiscard]] std::vector<std::byte> finish_compressed();

 private:
  void compress_view(Json& view, const Json& accessor, std::vector<std::byte>& packed) const;
  void add_texture(const Texture& texture, Json image);

  std::vector<std::byte> binary_;
};

}  // namespace lodestone
