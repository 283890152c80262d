#include "parallel/mesh/load.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/formats/plain/stl.h"
#include "core/formats/ply/ply_header.h"
#include "core/formats/ply/ply_layout.h"
#include "core/formats/tiles/tileset.h"
#include "core/mesh/raw_mesh.h"
#include "parallel/scheduler/first_touch.h"

namespace lodestone {
namespace {

constexpr std::size_t chunk_bytes = std::size_t{1} << 20;

// A run of records of fixed size in a file.
struct Records {
  std::uint64_t offset = 0, count = 0;
  std::size_t stride = 0;
};

// True if the file holds them and a buffer holds one: checked before memory is allocated for them.
bool readable(const Records& records, const InputFile& file) {
  return records.stride > 0 && records.stride <= chunk_bytes && records.offset <= file.size() &&
         records.count <= (file.size() - records.offset) / records.stride;
}

// Reads and decodes records in chunks, with one buffer per worker. `decode(bytes, first, count)` returns false when the
// records are not what the layout promised; then no further chunk is read and the result is false.
template <class Decode>
[[nodiscard]] bool read_records(const InputFile& file, const Records& records, Scheduler& scheduler,
                                const Decode& decode) {
  std::vector<std::unique_ptr<char[]>> buffers(static_cast<std::size_t>(scheduler.workers()));
  std::atomic<bool> sound = true;
  scheduler.for_chunks(records.count, chunk_bytes / records.stride, [&](ChunkRange range) {
    if (!sound.load(std::memory_order_relaxed)) return;
    std::unique_ptr<char[]>& buffer = buffers[static_cast<std::size_t>(scheduler.worker_index())];
    if (!buffer) buffer = std::make_unique_for_overwrite<char[]>(chunk_bytes);
    const std::size_t count = range.end - range.begin;
    const std::span<char> bytes(buffer.get(), count * records.stride);
    const bool complete = file.read_at(records.offset + range.begin * records.stride, bytes) == bytes.size();
    if (!complete || !decode(std::span<const char>(bytes), range.begin, count)) sound = false;
  });
  return sound;
}

// Each of these is empty when the file is of another layout, or damaged: the general reader knows more and says what.
std::optional<RawMesh> load_ply(const InputFile& file, ByteReader& head, const ReadConfig& config,
                                Scheduler& scheduler) {
  const PlyHeader header = read_ply_header(head);
  if (config.attributes && (header.has_textured_faces() || !header.textures.empty())) return std::nullopt;
  const std::optional<PlyFixedLayout> layout = fixed_layout(header);
  if (!layout) return std::nullopt;
  const VertexAttributeLayout attributes = config.attributes ? layout->attributes : VertexAttributeLayout{};
  const Records triangles{layout->triangle_offset, layout->triangle_count, layout->triangles.stride};
  const Records vertices{layout->vertex_offset, layout->vertex_count, layout->vertices.stride};
  if (!readable(triangles, file) || !readable(vertices, file) || layout->end > file.size()) return std::nullopt;
  RawMesh mesh;
  resize_in_parallel(mesh.triangles, triangles.count, scheduler);
  const auto vertex_count = static_cast<std::uint32_t>(vertices.count);
  const bool triangles_only =
      read_records(file, triangles, scheduler, [&](auto bytes, std::size_t first, std::size_t count) {
        const std::span<Triangle> out = std::span(mesh.triangles).subspan(first, count);
        return decode_triangles(layout->triangles, bytes, vertex_count, out) == count;
      });
  if (!triangles_only) return std::nullopt;
  resize_in_parallel(mesh.positions, vertices.count, scheduler);
  resize_attributes(attributes, vertices.count, mesh.wedges);
  const bool complete = read_records(file, vertices, scheduler, [&](auto bytes, std::size_t first, std::size_t count) {
    decode_vertices(layout->vertices, bytes, std::span(mesh.positions).subspan(first, count));
    if (!attributes.empty()) decode_attributes(attributes, bytes, first, count, mesh.wedges);
    return true;
  });
  if (!complete) return std::nullopt;
  add_ply_warnings(header, head.name(), config.attributes, file.size() - layout->end, mesh.warnings);
  return mesh;
}

std::optional<RawMesh> load_stl(const InputFile& file, ByteReader& head, Scheduler& scheduler) {
  const std::string_view header = head.window(stl_header_bytes);
  if (header.size() < stl_header_bytes || !is_binary_stl(header, head.size())) return std::nullopt;
  const Records facets{stl_header_bytes, declared_stl_facets(header), stl_facet_bytes};
  if (!readable(facets, file) || 3 * facets.count > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  RawMesh mesh;
  resize_in_parallel(mesh.positions, 3 * facets.count, scheduler);
  resize_in_parallel(mesh.triangles, facets.count, scheduler);
  const bool complete = read_records(file, facets, scheduler, [&](auto bytes, std::size_t first, std::size_t count) {
    decode_stl_corners(bytes, std::span(mesh.positions).subspan(3 * first, 3 * count));
    number_corners(std::span(mesh.triangles).subspan(first, count), 3 * first);
    return true;
  });
  if (!complete) return std::nullopt;
  return mesh;
}

// Reads tiles side by side and puts them together in their order, so many at a time that images which they share are
// not held for each of them. If there are several errors, that of the first tile is thrown.
RawMesh load_tileset(ByteReader& head, const ReadConfig& config, Scheduler& scheduler) {
  constexpr std::size_t at_a_time = 64;
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
  return mesh;
}

}  // namespace

RawMesh load_mesh(const std::filesystem::path& given, Scheduler& scheduler, const ReadConfig& config) {
  const std::filesystem::path path = mesh_path(given);
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return read_mesh(path, config);
  ByteReader head(path);
  if (head.size() == 0) return read_mesh(path, config);
  const MeshFormat format = mesh_format(path, head, config);
  try {
    const InputFile file(path);
    std::optional<RawMesh> mesh;
    if (format == MeshFormat::ply) mesh = load_ply(file, head, config, scheduler);
    if (format == MeshFormat::stl) mesh = load_stl(file, head, scheduler);
    if (format == MeshFormat::tileset) mesh = load_tileset(head, config, scheduler);
    if (!mesh) return read_mesh(path, config);
    require_triangles(*mesh, head.name());
    return std::move(*mesh);
  } catch (const std::bad_alloc&) {
    throw_out_of_memory(head.name());
  }
}

}  // namespace lodestone
