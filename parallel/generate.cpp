#include "parallel/generate.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/io/atomic_file.h"
#include "core/io/mesh_writer.h"

namespace lodestone {
namespace {

constexpr std::size_t grain = std::size_t{1} << 15;  // vertices or triangles per chunk

// What a worker fills and writes, again and again.
struct Buffers {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<std::byte> records;
};

}  // namespace

void generate_ply(const GenerateConfig& config, const std::filesystem::path& path, Scheduler& scheduler) {
  const std::unique_ptr<const GeneratedSurface> surface = generate_surface(config);
  AtomicFile file(path);
  const std::string header = ply_header(surface->vertex_count(), surface->triangle_count(), ScalarType::float32);
  file.write(std::as_bytes(std::span(header)));
  file.flush();
  std::vector<Buffers> buffers(static_cast<std::size_t>(scheduler.workers()));
  const auto mine = [&]() -> Buffers& { return buffers[static_cast<std::size_t>(scheduler.worker_index())]; };

  const std::uint64_t vertices_at = header.size();
  scheduler.for_chunks(surface->vertex_count(), grain, [&](ChunkRange range) {
    std::vector<Vec3f>& positions = mine().positions;
    positions.resize(range.end - range.begin);
    surface->positions(static_cast<std::uint32_t>(range.begin), positions);
    file.write_at(vertices_at + range.begin * sizeof(Vec3f), std::as_bytes(std::span(positions)));
  });
  const std::uint64_t triangles_at = vertices_at + surface->vertex_count() * sizeof(Vec3f);
  scheduler.for_chunks(surface->triangle_count(), grain, [&](ChunkRange range) {
    Buffers& buffer = mine();
    buffer.triangles.resize(range.end - range.begin);
    buffer.records.resize(buffer.triangles.size() * ply_triangle_bytes);
    surface->triangles(static_cast<std::uint32_t>(range.begin), buffer.triangles);
    encode_ply_triangles(buffer.triangles, buffer.records);
    file.write_at(triangles_at + range.begin * ply_triangle_bytes, buffer.records);
  });
  file.commit();
}

}  // namespace lodestone
