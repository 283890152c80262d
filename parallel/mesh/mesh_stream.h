// Mesh files that are read again and again in pieces instead of into memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// Vertices and triangles of a file, any piece at any time, from any number of threads. Memory: a piece at a time.
class MeshStream {
 public:
  virtual ~MeshStream() = default;
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] std::uint64_t vertex_count() const { return vertices_; }
  [[nodiscard]] std::uint64_t triangle_count() const { return triangles_; }

  // Vertices [first, first + out.size()), and triangles likewise, every index below vertex_count(). Throw FileError
  // when the disk fails, InputError when the file has become shorter, or has something else than a triangle there.
  virtual void read_vertices(std::uint64_t first, std::span<Vec3d> out) const = 0;
  virtual void read_triangles(std::uint64_t first, std::span<Triangle> out) const = 0;

  // Tells files apart: by size, time of the last change, and bytes here and there.
  [[nodiscard]] virtual std::uint64_t identity() const = 0;

 protected:
  std::uint64_t vertices_ = 0, triangles_ = 0;
};

// Binary PLY of the common layout without attributes that `config` asks for, and binary STL; nullptr for other files,
// which have to be read into memory as a whole (load_mesh), also to say what is wrong with them.
[[nodiscard]] std::unique_ptr<MeshStream> open_mesh_stream(const std::filesystem::path& path,
                                                           const ReadConfig& config = {});

}  // namespace lodestone
