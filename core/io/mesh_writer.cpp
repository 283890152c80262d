#include "core/io/mesh_writer.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/io/glb_writer.h"

namespace lodestone {
namespace {

constexpr std::size_t block = 4096;  // items encoded at a time

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

// float32 keeps 24 bits of the largest coordinate; the model needs 22 of its extent.
ScalarType coordinate_type(const MeshView& mesh) {
  const auto [lo, hi] = box_of(mesh);
  const double extent = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
  const double largest = std::max({-lo.x, -lo.y, -lo.z, hi.x, hi.y, hi.z});
  const bool in_range = largest < 1e37 && extent > 1e-30;  // neither infinite nor subnormal as a float
  return in_range && largest <= 4 * extent ? ScalarType::float32 : ScalarType::float64;
}

template <class Scalar>
void write_positions(AtomicFile& file, const MeshView& mesh) {
  std::vector<std::array<Scalar, 3>> buffer;
  for (std::size_t first = 0; first < mesh.vertex_count; first += block) {
    buffer.resize(std::min(block, mesh.vertex_count - first));
    for (std::size_t i = 0; i < buffer.size(); ++i) {
      const Vec3d p = mesh.position(first + i);
      buffer[i] = {static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z)};
    }
    file.write(std::as_bytes(std::span(buffer)));
  }
}

void write_ply(AtomicFile& file, const MeshView& mesh) {
  const ScalarType type = coordinate_type(mesh);
  file.write(bytes_of(ply_header(mesh.vertex_count, mesh.triangles.size(), type)));
  type == ScalarType::float32 ? write_positions<float>(file, mesh) : write_positions<double>(file, mesh);
  std::vector<std::byte> buffer(block * ply_triangle_bytes);
  for (std::size_t first = 0; first < mesh.triangles.size(); first += block) {
    const std::span<const Triangle> part =
        mesh.triangles.subspan(first, std::min(block, mesh.triangles.size() - first));
    const std::span<std::byte> out = std::span(buffer).first(part.size() * ply_triangle_bytes);
    encode_ply_triangles(part, out);
    file.write(out);
  }
}

// A line of text put together in place: a keyword and numbers.
class Line {
 public:
  explicit Line(char keyword) { text_[length_++] = keyword; }
  template <class Number>
  Line& operator<<(Number value) {
    text_[length_++] = ' ';
    const auto [end, error] = std::to_chars(text_.data() + length_, text_.data() + text_.size() - 1, value);
    assert(error == std::errc{});
    length_ = static_cast<std::size_t>(end - text_.data());
    return *this;
  }
  [[nodiscard]] std::span<const std::byte> bytes() {
    text_[length_] = '\n';
    return std::as_bytes(std::span(text_).first(length_ + 1));
  }

 private:
  std::array<char, 128> text_;  // three doubles take at most 25 characters each
  std::size_t length_ = 0;
};

void write_obj(AtomicFile& file, const MeshView& mesh) {
  for (std::size_t i = 0; i < mesh.vertex_count; ++i) {
    const Vec3d p = mesh.position(i);
    file.write((Line('v') << p.x << p.y << p.z).bytes());
  }
  for (const Triangle& t : mesh.triangles)
    file.write(
        (Line('f') << std::uint64_t{t.v[0]} + 1 << std::uint64_t{t.v[1]} + 1 << std::uint64_t{t.v[2]} + 1).bytes());
}

Vec3d unit_normal(Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d normal = cross(b - a, c - a);
  const double size = length(normal);
  return size > 0 ? (1 / size) * normal : Vec3d{};  // readers take (0,0,0) as "compute it"
}

void write_stl(AtomicFile& file, const MeshView& mesh) {
  std::array<char, 80> header{};
  std::strcpy(header.data(), "binary STL by Lodestone");
  file.write(std::as_bytes(std::span(header)));
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  file.write(std::as_bytes(std::span(&count, 1)));
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.position(t.v[0]), b = mesh.position(t.v[1]), c = mesh.position(t.v[2]);
    std::array<std::byte, 50> record{};
    const std::array<Vec3f, 4> vectors{to_float(unit_normal(a, b, c)), to_float(a), to_float(b), to_float(c)};
    std::memcpy(record.data(), vectors.data(), sizeof vectors);
    file.write(record);
  }
}

}  // namespace

MeshView view_of(const RawMesh& mesh) {
  return {mesh.positions.size(), [&mesh](std::size_t i) { return mesh.positions[i]; },
          mesh.triangles,        mesh.wedges.corners.empty() ? &mesh.wedges : nullptr,
          mesh.materials,        mesh.textures};
}

MeshView view_of(const IndexedMesh& mesh) {
  return {mesh.positions.size(), [&mesh](std::size_t i) { return mesh.transform.to_model(mesh.positions[i]); },
          mesh.triangles};
}

Box3d box_of(const MeshView& mesh) {
  constexpr double far = std::numeric_limits<double>::max();
  Box3d box{{far, far, far}, {-far, -far, -far}};
  for (std::size_t i = 0; i < mesh.vertex_count; ++i) {
    const Vec3d p = mesh.position(i);
    box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y), std::min(box.lo.z, p.z)};
    box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y), std::max(box.hi.z, p.z)};
  }
  return box;
}

void write_mesh(const std::filesystem::path& path, const MeshView& mesh) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  void (*const write)(AtomicFile&, const MeshView&) = extension == ".ply"   ? write_ply
                                                      : extension == ".obj" ? write_obj
                                                      : extension == ".stl" ? write_stl
                                                      : extension == ".glb" ? write_glb
                                                                            : nullptr;
  if (!write)
    throw UnsupportedError(
        describe(path.string(), "", "cannot write a mesh of this format", "name a .ply, .obj, .stl or .glb file"));
  if (write == write_stl && mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(path.string(), "", "more triangles than an STL file can count", "write a .ply file"));
  AtomicFile file(path);
  write(file, mesh);
  file.commit();
}

std::string ply_header(std::size_t vertices, std::size_t triangles, ScalarType coordinates) {
  const std::string scalar = coordinates == ScalarType::float64 ? "double" : "float";
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text += "element vertex " + std::to_string(vertices) + "\n";
  for (const char axis : {'x', 'y', 'z'}) text += "property " + scalar + " " + axis + "\n";
  text += "element face " + std::to_string(triangles) + "\n";
  return text + "property list uchar int vertex_indices\nend_header\n";
}

void encode_ply_triangles(std::span<const Triangle> triangles, std::span<std::byte> out) {
  assert(out.size() == triangles.size() * ply_triangle_bytes);
  std::byte* record = out.data();
  for (const Triangle& t : triangles) {
    record[0] = std::byte{3};
    std::memcpy(record + 1, t.v.data(), sizeof t.v);
    record += ply_triangle_bytes;
  }
}

}  // namespace lodestone
