// Writer of binary PLY.
#include <algorithm>
#include <cassert>
#include <cstring>
#include <vector>

#include "core/formats/common/lower_left.h"
#include "core/formats/ply/ply.h"

namespace lodestone {
namespace {

constexpr std::size_t block = 4096;  // items encoded at a time

// float32 keeps 24 bits of the largest coordinate; the model needs 22 of its extent.
ScalarType coordinate_type(const MeshView& mesh) {
  const auto [lo, hi] = box_of(mesh);
  const double extent = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
  const double largest = std::max({-lo.x, -lo.y, -lo.z, hi.x, hi.y, hi.z});
  const bool in_range = largest < 1e37 && extent > 1e-30;  // neither infinite nor subnormal as a float
  return in_range && largest <= 4 * extent ? ScalarType::float32 : ScalarType::float64;
}

// The properties of the vertices and faces of the file.
struct PlyForm {
  ScalarType coordinates{};
  bool normals = false, colours = false, alpha = false, uv = false;
  std::vector<std::string> textures{};  // names of the image files
  std::vector<std::int32_t> number{};   // by material: number of its texture, -1: none; empty: faces have no numbers
};

PlyForm form_of(const MeshView& mesh, MeshCompanions& companions) {
  PlyForm form{.coordinates = coordinate_type(mesh)};
  if (mesh.wedges == nullptr) return form;
  const RawWedges& w = *mesh.wedges;
  form.normals = !w.normal.empty();
  form.colours = !w.colour.empty();
  form.alpha = std::any_of(w.colour.begin(), w.colour.end(), [](Rgba8 c) { return c.a != 255; });
  form.uv = !w.uv.empty();
  if (!form.uv || w.material.empty() || !companions.possible()) return form;
  std::vector<std::int32_t> number_of(mesh.textures.size(), -1);
  for (const Material& m : mesh.materials) {
    form.number.push_back(-1);
    if (m.texture >= mesh.textures.size()) continue;
    std::int32_t& number = number_of[m.texture];
    if (number < 0) {
      number = static_cast<std::int32_t>(form.textures.size());
      form.textures.push_back(companions.add_texture(mesh.textures[m.texture], m.texture));
    }
    form.number.back() = number;
  }
  const auto number = [&](std::uint32_t m) { return m < form.number.size() ? form.number[m] : -1; };
  const bool one = std::all_of(w.material.begin(), w.material.end(), [&](std::uint32_t m) { return number(m) == 0; });
  if (form.textures.empty() || one) form.number.clear();
  return form;
}

std::string header_of(std::size_t vertices, std::size_t triangles, const PlyForm& form) {
  const std::string scalar = form.coordinates == ScalarType::float64 ? "double" : "float";
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& name : form.textures) text += "comment TextureFile " + name + "\n";
  const auto properties = [&](const std::string& type, std::initializer_list<const char*> names) {
    for (const char* name : names) text += "property " + type + " " + name + "\n";
  };
  text += "element vertex " + std::to_string(vertices) + "\n";
  properties(scalar, {"x", "y", "z"});
  if (form.normals) properties("float", {"nx", "ny", "nz"});
  if (form.colours) properties("uchar", {"red", "green", "blue"});
  if (form.alpha) properties("uchar", {"alpha"});
  if (form.uv) properties("float", {"s", "t"});
  text += "element face " + std::to_string(triangles) + "\n";
  properties("list uchar int", {"vertex_indices"});
  if (!form.number.empty()) properties("int", {"texnumber"});
  return text + "end_header\n";
}

// Packs values without alignment.
class Records {
 public:
  template <class T>
  void put(const T& value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  // Writes them out and clears the buffer.
  void write_to(AtomicFile& file) {
    file.write(bytes_);
    bytes_.clear();
  }

 private:
  std::vector<std::byte> bytes_;
};

template <class Scalar>
void write_vertices(AtomicFile& file, const MeshView& mesh, const PlyForm& form) {
  Records records;
  for (std::size_t i = 0; i < mesh.vertex_count; ++i) {
    const Vec3d p = mesh.position(i);
    records.put(std::array<Scalar, 3>{static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z)});
    if (form.normals) records.put(mesh.wedges->normal[i]);
    if (form.colours) {
      const Rgba8 c = mesh.wedges->colour[i];
      records.put(std::array{c.r, c.g, c.b});
      if (form.alpha) records.put(c.a);
    }
    if (form.uv) records.put(to_lower_left<float>(mesh.wedges->uv[i]));
    if (i % block == block - 1) records.write_to(file);
  }
  records.write_to(file);
}

void write_plain_faces(AtomicFile& file, const MeshView& mesh) {
  std::vector<std::byte> buffer(block * ply_triangle_bytes);
  for (std::size_t first = 0; first < mesh.triangles.size(); first += block) {
    const std::span<const Triangle> part =
        mesh.triangles.subspan(first, std::min(block, mesh.triangles.size() - first));
    const std::span<std::byte> out = std::span(buffer).first(part.size() * ply_triangle_bytes);
    encode_ply_triangles(part, out);
    file.write(out);
  }
}

void write_textured_faces(AtomicFile& file, const MeshView& mesh, const PlyForm& form) {
  Records records;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t material = mesh.wedges->material[t];
    records.put(std::uint8_t{3});
    records.put(mesh.triangles[t].v);
    records.put(material < form.number.size() ? form.number[material] : -1);
    if (t % block == block - 1) records.write_to(file);
  }
  records.write_to(file);
}

}  // namespace

void write_ply(AtomicFile& file, const MeshView& mesh, MeshCompanions& companions) {
  const PlyForm form = form_of(mesh, companions);
  const std::string header = header_of(mesh.vertex_count, mesh.triangles.size(), form);
  file.write(std::as_bytes(std::span(header)));
  form.coordinates == ScalarType::float32 ? write_vertices<float>(file, mesh, form)
                                          : write_vertices<double>(file, mesh, form);
  form.number.empty() ? write_plain_faces(file, mesh) : write_textured_faces(file, mesh, form);
}

std::string ply_header(std::size_t vertices, std::size_t triangles, ScalarType coordinates) {
  return header_of(vertices, triangles, {.coordinates = coordinates});
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
