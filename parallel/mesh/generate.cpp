#include "parallel/mesh/generate.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "core/files/atomic_file.h"
#include "core/formats/mesh_file.h"
#include "core/formats/ply/ply.h"
#include "parallel/scheduler/first_touch.h"

namespace lodestone {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they stand in memory");

constexpr std::size_t entry_grain = 1 << 16;
constexpr std::size_t vertex_bytes = 3 * sizeof(float);

}  // namespace

RawMesh generate_mesh(const GenerateConfig& config, Scheduler& scheduler) {
  const GeneratedSurface surface(config);
  const std::size_t vertices = surface.vertex_count(), triangles = surface.triangle_count();
  RawMesh mesh;
  resize_in_parallel(mesh.positions, vertices, scheduler);
  resize_in_parallel(mesh.triangles, triangles, scheduler);
  scheduler.name_work("generating");
  scheduler.for_chunks(vertices + triangles, entry_grain, [&](ChunkRange range) {
    for (std::size_t i = range.begin; i < std::min(range.end, vertices); ++i)
      mesh.positions[i] = to_double(surface.vertex(i));
    for (std::size_t i = std::max(range.begin, vertices); i < range.end; ++i)
      mesh.triangles[i - vertices] = surface.triangle(i - vertices);
  });
  return mesh;
}

GenerateResult generate_ply(const GenerateConfig& config, const std::filesystem::path& target, Scheduler& scheduler,
                            const CancelFlag* cancel, const std::function<void(double)>& progress) {
  const GeneratedSurface surface(config);
  AtomicFile file(target);
  const std::string head = ply_header(surface.vertex_count(), surface.triangle_count(), ScalarType::float32);
  const std::uint64_t first_face = head.size() + surface.vertex_count() * vertex_bytes;
  file.reserve(first_face + surface.triangle_count() * ply_triangle_bytes);
  file.write_at(0, std::as_bytes(std::span(head)));

  const std::uint64_t records = surface.vertex_count() + surface.triangle_count();
  std::atomic<std::uint64_t> done{0};
  std::mutex reporting;
  const auto write_chunk = [&](std::uint64_t offset, std::span<const std::byte> bytes, std::size_t count) {
    if (cancel && *cancel) throw Cancelled{};
    file.write_at(offset, bytes);
    const std::uint64_t now = done += count;
    if (const std::unique_lock lock(reporting, std::try_to_lock); lock && progress)
      progress(static_cast<double>(now) / static_cast<double>(records));
  };
  scheduler.for_chunks(surface.vertex_count(), entry_grain, [&](ChunkRange range) {
    std::vector<Vec3f> vertices;
    vertices.reserve(range.end - range.begin);
    for (std::size_t i = range.begin; i < range.end; ++i) vertices.push_back(surface.vertex(i));
    write_chunk(head.size() + range.begin * vertex_bytes, std::as_bytes(std::span(vertices)), vertices.size());
  });
  scheduler.for_chunks(surface.triangle_count(), entry_grain, [&](ChunkRange range) {
    std::vector<Triangle> triangles;
    triangles.reserve(range.end - range.begin);
    for (std::size_t i = range.begin; i < range.end; ++i) triangles.push_back(surface.triangle(i));
    std::vector<std::byte> faces(triangles.size() * ply_triangle_bytes);
    encode_ply_triangles(triangles, faces);
    write_chunk(first_face + range.begin * ply_triangle_bytes, faces, range.end - range.begin);
  });
  file.commit();
  return {surface.vertex_count(), surface.triangle_count(), first_face + surface.triangle_count() * ply_triangle_bytes};
}

}  // namespace lodestone
