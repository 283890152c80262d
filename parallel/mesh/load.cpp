#include "parallel/mesh/load.h"

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/formats/mesh_reader.h"
#include "core/formats/tiles/tileset.h"
#include "core/mesh/raw_mesh.h"
#include "parallel/mesh/joined_stream.h"
#include "parallel/mesh/mesh_stream.h"
#include "parallel/scheduler/first_touch.h"

namespace lodestone {
namespace {

// Reads the pieces side by side. Empty when the file has something else than its header promises: the general reader
// knows more and says what.
std::optional<RawMesh> drain(const MeshStream& stream, Scheduler& scheduler) {
  constexpr std::size_t grain = 3 << 14;  // vertices or triangles: whole facets of STL, and less than a buffer
  RawMesh mesh;
  const auto part = [](auto& all, ChunkRange range) {
    return std::span(all).subspan(range.begin, range.end - range.begin);
  };
  try {
    resize_in_parallel(mesh.triangles, stream.triangle_count(), scheduler);
    scheduler.for_chunks(mesh.triangles.size(), grain,
                         [&](ChunkRange range) { stream.read_triangles(range.begin, part(mesh.triangles, range)); });
    resize_in_parallel(mesh.positions, stream.vertex_count(), scheduler);
    mesh.wedges = stream.wedges();
    scheduler.for_chunks(mesh.positions.size(), grain, [&](ChunkRange range) {
      stream.read_vertices(range.begin, part(mesh.positions, range), &mesh.wedges);
    });
  } catch (const InputError&) {
    return std::nullopt;
  }
  mesh.warnings = stream.warnings();
  mesh.up = stream.up();
  return mesh;
}

// The same, and ends the reading of a file from front to back when a watched scheduler is cancelled: it looks at its
// flag at the beginning of every loop, be it empty.
ReadConfig watched(const ReadConfig& config, Scheduler& scheduler) {
  ReadConfig out = config;
  out.progress = [&scheduler, inner = config.progress](double share) {
    scheduler.for_chunks(0, 1, [](ChunkRange) {});
    if (inner) inner(share);
  };
  return out;
}

// Reads tiles side by side and puts them together in their order, so many at a time that images which they share are
// not held for each of them. If there are several errors, that of the first tile is thrown.
RawMesh load_tileset(ByteReader& head, ReadConfig config, Scheduler& scheduler) {
  constexpr std::size_t at_a_time = 64;
  config.progress = {};  // the scheduler is watched
  TileList list = list_tiles(head);
  RawMesh mesh;
  mesh.warnings = std::move(list.warnings);
  for (std::size_t first = 0; first < list.tiles.size(); first += at_a_time) {
    const std::span<const Tile> tiles =
        std::span(std::as_const(list.tiles)).subspan(first, std::min(at_a_time, list.tiles.size() - first));
    std::vector<RawMesh> parts(tiles.size());
    std::vector<std::exception_ptr> errors(tiles.size());
    scheduler.for_chunks(tiles.size(), 1, [&](ChunkRange range) {
      try {
        parts[range.index] = read_tile(tiles[range.index], config);
      } catch (...) {
        errors[range.index] = std::current_exception();
      }
    });
    for (const std::exception_ptr& error : errors)
      if (error) std::rethrow_exception(error);
    for (RawMesh& part : parts) append_mesh(mesh, std::move(part), head.name());
  }
  mesh.up = config.up ? up_of(MeshFormat::tileset, config) : up_of_tiles(finite_box(mesh.positions));
  return mesh;
}

}  // namespace

RawMesh load_mesh(const std::filesystem::path& given, Scheduler& scheduler, const ReadConfig& asked) {
  const std::filesystem::path path = mesh_path(given);
  const ReadConfig config = watched(asked, scheduler);
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return read_mesh(path, config);
  ByteReader head = open_mesh_file(path, config);
  if (head.size() == 0) return read_mesh(path, config);
  try {
    std::optional<RawMesh> mesh;
    if (const auto stream = open_mesh_stream(path, config)) mesh = drain(*stream, scheduler);
    if (mesh_format(path, head, config) == MeshFormat::tileset) mesh = load_tileset(head, config, scheduler);
    if (!mesh) return read_mesh(path, config);
    require_triangles(*mesh, head.name());
    return std::move(*mesh);
  } catch (const std::bad_alloc&) {
    throw_out_of_memory(head.name());
  }
}

RawMesh load_meshes(std::span<const std::filesystem::path> files, Scheduler& scheduler, const ReadConfig& config) {
  RawMesh mesh = load_mesh(files.front(), scheduler, config);
  for (const std::filesystem::path& file : files.subspan(1)) {
    RawMesh part = load_mesh(file, scheduler, config);
    require_same_up(mesh.up, part.up, file.string());
    append_mesh(mesh, std::move(part), file.string());
  }
  return mesh;
}

}  // namespace lodestone
