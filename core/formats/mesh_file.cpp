#include "core/formats/mesh_file.h"

#include <new>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/files/text_scanner.h"
#include "core/formats/common/float_range.h"
#include "core/formats/common/mesh_view.h"
#include "core/formats/gltf/gltf.h"
#include "core/formats/mesh_reader.h"
#include "core/formats/obj/obj.h"
#include "core/formats/plain/stl.h"
#include "core/formats/ply/ply.h"
#include "core/formats/terrain/height_grid.h"

namespace lodestone {
namespace {

// A folder without a tileset.json.
RawMesh read_folder(const std::filesystem::path& folder, const ReadConfig& config) {
  if (list_srtm_tiles(folder).empty())
    throw UnsupportedError(describe(folder.string(), "", "holds neither a tileset.json nor .hgt tiles",
                                    "give a file of a mesh, or a folder of tiles"));
  try {
    RawMesh mesh = read_srtm_folder(folder, config);
    mesh.up = up_of(MeshFormat::hgt, config);
    require_triangles(mesh, folder.string());
    return mesh;
  } catch (const std::bad_alloc&) {
    throw_out_of_memory(folder.string());
  }
}

}  // namespace

bool has_mesh_extension(const std::filesystem::path& path) { return format_of_extension(path).has_value(); }

RawMesh read_mesh(const std::filesystem::path& path, const ReadConfig& config) {
  const std::filesystem::path file = mesh_path(path);
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) return read_folder(file, config);
  ByteReader input = open_mesh_file(file, config);
  if (input.size() == 0) throw InputError(describe(input.name(), "", "is empty", "give a mesh with triangles"));
  return read_mesh(input, mesh_format(file, input, config), config);
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const RawMesh& mesh) {
  return write_mesh(path, view_of(mesh));
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const IndexedMesh& mesh) {
  return write_mesh(path, view_of(mesh));
}

std::vector<std::string> write_mesh(const std::filesystem::path& path, const MeshView& mesh) {
  const std::string extension = extension_of(path);
  if (extension != ".ply" && extension != ".obj" && extension != ".stl" && extension != ".glb")
    throw UnsupportedError(
        describe(path.string(), "", "cannot write a mesh of this format", "name a .ply, .obj, .stl or .glb file"));
  AtomicFile file(path);
  MeshCompanions companions(path);
  std::vector<std::string> notes;
  if (extension == ".ply") {
    write_ply(file, mesh, companions);
  } else if (extension == ".obj") {
    write_obj(file, mesh, companions);
  } else if (extension == ".glb") {
    if (mesh.vertex_count > 0) require_gltf_range(box_of(mesh), path.string(), "write a .ply or .obj file");
    file.write(encode_glb(mesh));
  } else if (std::string note = write_stl(file, mesh, path.string()); !note.empty()) {
    notes.push_back(std::move(note));
  }
  companions.commit();
  file.commit();
  return notes;
}

}  // namespace lodestone
