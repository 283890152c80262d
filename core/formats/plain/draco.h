// Draco compressed meshes, decoded by libdraco, as plain arrays for glTF and as files (.drc).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/files/byte_reader.h"
#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

// A mesh of *points*: one for each combination of attribute values that occurs.
class DracoMesh {
 public:
  // Throws InputError, at `place` of file `name`, for bytes that are not a valid mesh, and for more than 65,536 faces,
  // vertices or points and 64 more for each byte. Takes about 150 bytes of memory for each of them.
  DracoMesh(std::span<const char> bytes, const std::string& name, const std::string& place);
  ~DracoMesh();
  DracoMesh(DracoMesh&&) noexcept;
  DracoMesh& operator=(DracoMesh&&) = delete;

  enum class Kind : std::uint8_t { position, normal, colour, texture_coordinate };
  struct Attribute {
    int index = 0;  // in the mesh
    int components = 0;
    bool floating = false;
    double largest = 1;  // the integer that stands for 1 when integers stand for [0, 1]
  };
  // The first of its kind, or the one with the unique id that a glTF file gives.
  [[nodiscard]] std::optional<Attribute> find(Kind kind) const;
  [[nodiscard]] std::optional<Attribute> find(std::uint32_t unique_id) const;

  [[nodiscard]] std::size_t point_count() const;
  [[nodiscard]] std::vector<Triangle> triangles() const;  // of points; every id is in range

  // The first `components` values of each point, in order; missing ones are 0.
  [[nodiscard]] std::vector<double> values(const Attribute& attribute, int components) const;
  // The distinct values of an attribute, and the index of each point's value among them.
  [[nodiscard]] std::vector<Vec3d> distinct_values(const Attribute& attribute) const;
  [[nodiscard]] std::vector<std::uint32_t> value_of_points(const Attribute& attribute) const;

 private:
  struct Decoded;
  std::unique_ptr<Decoded> decoded_;
};

// Draco files (.drc). Attributes: the first normals, colours and texture coordinates.
[[nodiscard]] RawMesh read_draco(ByteReader& input, const ReadConfig& config = {});

}  // namespace lodestone
