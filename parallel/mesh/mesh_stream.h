// Mesh files that are read in pieces: again and again, or once and side by side.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"
#include "core/mesh/raw_mesh.h"

namespace lodestone {

// Vertices and triangles of a file, any piece at any time, from any number of threads. Memory: a mebibyte per piece
// that is being read.
class MeshStream {
 public:
  virtual ~MeshStream() = default;
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] std::uint64_t vertex_count() const { return vertices_; }
  [[nodiscard]] std::uint64_t triangle_count() const { return triangles_; }

  // Vertices [first, first + out.size()), and triangles likewise, every index below vertex_count(). Throw FileError
  // when the disk fails, InputError when the file has become shorter, or has something else than a triangle there.
  virtual void read_vertices(std::uint64_t first, std::span<Vec3d> out, RawWedges* wedges = nullptr) const = 0;
  virtual void read_triangles(std::uint64_t first, std::span<Triangle> out) const = 0;

  // True if vertices have attributes that the configuration asked for; then wedges() has room for those of all
  // vertices, and read_vertices fills the part of those that it reads.
  [[nodiscard]] bool has_attributes() const { return has_attributes_; }
  [[nodiscard]] virtual RawWedges wedges() const { return {}; }

  // Those that read_mesh (core/formats/mesh_file.h) gives.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  [[nodiscard]] Up up() const { return up_; }

  // Tells files apart: by size, time of the last change, and bytes here and there.
  [[nodiscard]] virtual std::uint64_t identity() const = 0;

 protected:
  std::uint64_t vertices_ = 0, triangles_ = 0;
  bool has_attributes_ = false;
  std::vector<std::string> warnings_;
  Up up_;
};

// Binary PLY of the common layout (vertices of fixed size, all faces triangles with 32-bit indices) and binary STL;
// nullptr for other files, which have to be read as a whole (read_mesh), also to say what is wrong with them.
[[nodiscard]] std::unique_ptr<MeshStream> open_mesh_stream(const std::filesystem::path& path,
                                                           const ReadConfig& config = {});

}  // namespace lodestone
