// A mesh to be written, wherever it is stored, and the files beside it: its material library and its images.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/files/atomic_file.h"
#include "core/math/box3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Positions are in the space of the file.
struct MeshView {
  std::size_t vertex_count = 0;
  std::function<Vec3d(std::size_t)> position;
  std::span<const Triangle> triangles;
  // Attributes by vertex, for formats that have them; null: none.
  const RawWedges* wedges = nullptr;
  std::span<const Material> materials{};
  std::span<const Texture> textures{};
  Up up{};  // of the space of the file
};

// The mesh has to outlive its view. Wedges that are not the vertices are left out.
[[nodiscard]] MeshView view_of(const RawMesh& mesh);
[[nodiscard]] MeshView view_of(const IndexedMesh& mesh);  // in the space of the file that it was read from

// Box of all vertices; empty when there are none.
[[nodiscard]] Box3d box_of(const MeshView& mesh);

// Names of companions begin with the stem of the mesh file, in which characters that would end a name in a mesh file
// (blanks, '#', quotes, backslashes, control characters) become '_'. A mesh written to a pipe or device has none.
class MeshCompanions {
 public:
  explicit MeshCompanions(const std::filesystem::path& mesh);

  [[nodiscard]] bool possible() const { return possible_; }
  // Writes the file STEM + suffix and returns its name. The file appears with commit(), and not at all without.
  std::string add(const std::string& suffix, std::span<const std::byte> bytes);
  std::string add_texture(const Texture& texture, std::size_t number);
  void commit();

 private:
  std::filesystem::path folder_;
  std::string stem_;
  bool possible_;
  std::vector<std::unique_ptr<AtomicFile>> files_;
};

// ".jpg" and so on, by the media type.
[[nodiscard]] std::string image_extension(const std::string& media_type);

}  // namespace lodestone
