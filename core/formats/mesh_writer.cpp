#include "core/formats/mesh_writer.h"

#include <array>
#include <cctype>
#include <cstring>
#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/formats/common/mesh_companions.h"
#include "core/formats/gltf/glb_writer.h"
#include "core/formats/obj/obj_writer.h"
#include "core/formats/ply/ply_writer.h"

namespace lodestone {
namespace {

Vec3d unit_normal(Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d normal = cross(b - a, c - a);
  const double size = length(normal);
  return size > 0 ? (1 / size) * normal : Vec3d{};  // readers take (0,0,0) as "compute it"
}

void write_stl(AtomicFile& file, const MeshView& mesh, MeshCompanions& /*none*/) {
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

void write_mesh(const std::filesystem::path& path, const MeshView& mesh) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  using Write = void (*)(AtomicFile&, const MeshView&, MeshCompanions&);
  const Write write =
      extension == ".ply"   ? write_ply
      : extension == ".obj" ? write_obj
      : extension == ".stl" ? write_stl
      : extension == ".glb"
          ? Write{[](AtomicFile& file, const MeshView& view, MeshCompanions&) { write_glb(file, view); }}
          : nullptr;
  if (!write)
    throw UnsupportedError(
        describe(path.string(), "", "cannot write a mesh of this format", "name a .ply, .obj, .stl or .glb file"));
  if (write == write_stl && mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(path.string(), "", "more triangles than an STL file can count", "write a .ply file"));
  AtomicFile file(path);
  MeshCompanions companions(path);
  write(file, mesh, companions);
  companions.commit();
  file.commit();
}

}  // namespace lodestone
