#include "parallel/generate.h"

#include <atomic>
#include <bit>
#include <cstring>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "core/io/atomic_file.h"

namespace lodestone {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they stand in memory");

constexpr std::size_t grain = 1 << 16;
constexpr std::size_t vertex_bytes = 12, face_bytes = 13;

std::string header(const GeneratedSurface& surface) {
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(surface.vertex_count()) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
         std::to_string(surface.triangle_count()) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

GenerateResult generate_ply(const GenerateConfig& config, const std::filesystem::path& target, Scheduler& scheduler,
                            const CancelFlag* cancel, const std::function<void(double)>& progress) {
  const GeneratedSurface surface(config);
  AtomicFile file(target);
  const std::string head = header(surface);
  file.write_at(0, std::as_bytes(std::span(head)));
  const std::uint64_t first_face = head.size() + surface.vertex_count() * vertex_bytes;

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
  scheduler.for_chunks(surface.vertex_count(), grain, [&](ChunkRange range) {
    std::vector<Vec3f> vertices;
    vertices.reserve(range.end - range.begin);
    for (std::size_t i = range.begin; i < range.end; ++i) vertices.push_back(surface.vertex(i));
    write_chunk(head.size() + range.begin * vertex_bytes, std::as_bytes(std::span(vertices)), vertices.size());
  });
  scheduler.for_chunks(surface.triangle_count(), grain, [&](ChunkRange range) {
    std::vector<std::byte> faces((range.end - range.begin) * face_bytes, std::byte{3});
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const Triangle t = surface.triangle(i);
      std::memcpy(faces.data() + (i - range.begin) * face_bytes + 1, t.v.data(), sizeof(t.v));
    }
    write_chunk(first_face + range.begin * face_bytes, faces, range.end - range.begin);
  });
  file.commit();
  return {surface.vertex_count(), surface.triangle_count(), first_face + surface.triangle_count() * face_bytes};
}

}  // namespace lodestone
