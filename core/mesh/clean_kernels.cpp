#include "core/mesh/clean_kernels.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>

namespace lodestone {
namespace {

// Chunks of triangles share vertices, and several may mark the same one with the same value: the access has to be
// atomic, its order does not matter.
VertexState state_of(std::span<VertexState> states, std::uint32_t id) {
  return std::atomic_ref(states[id]).load(std::memory_order_relaxed);
}
void set_used(std::span<VertexState> states, std::uint32_t id) {
  std::atomic_ref(states[id]).store(VertexState::used, std::memory_order_relaxed);
}

constexpr Triangle dropped{{0, 0, 0}};

std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
  std::uint64_t h = a * 0x9E3779B97F4A7C15u;
  h = (h ^ (h >> 32) ^ b) * 0xD6E8FEB86659FD93u;
  h = (h ^ (h >> 32)) * 0xD6E8FEB86659FD93u;
  return h ^ (h >> 32);
}

}  // namespace

std::uint64_t classify_vertices(std::span<const Vec3d> positions, std::span<VertexState> states) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const bool finite = is_finite(positions[i]);
    states[i] = finite ? VertexState::unused : VertexState::not_finite;
    count += !finite;
  }
  return count;
}

std::uint64_t drop_non_finite(std::span<Triangle> triangles, std::span<VertexState> states) {
  std::uint64_t count = 0;
  for (Triangle& t : triangles) {
    bool finite = true;
    for (const std::uint32_t id : t.v) finite &= state_of(states, id) != VertexState::not_finite;
    if (finite) {
      for (const std::uint32_t id : t.v) set_used(states, id);
    } else {
      t = dropped;
      ++count;
    }
  }
  return count;
}

void mark_corners(std::span<const Triangle> triangles, std::span<VertexState> states) {
  for (const Triangle& t : triangles)
    for (const std::uint32_t id : t.v) set_used(states, id);
}

void extend_box(std::span<const Vec3d> positions, std::span<const VertexState> states, Box3d& box) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (states[i] == VertexState::used) box.extend(positions[i]);
  }
}

void normalise_vertices(const Transform& transform, std::span<const Vec3d> positions,
                        std::span<const VertexState> states, std::span<Vec3f> out) {
  for (std::size_t i = 0; i < positions.size(); ++i)
    out[i] = states[i] == VertexState::used ? normalise(transform, positions[i]) : Vec3f{};
}

std::uint64_t hash_of(Vec3f p) {
  return mix(std::bit_cast<std::uint32_t>(p.x) | std::uint64_t{std::bit_cast<std::uint32_t>(p.y)} << 32,
             std::bit_cast<std::uint32_t>(p.z));
}

std::uint64_t hash_of(const Triangle& triangle) {
  const Triangle t = canonical(triangle);
  return mix(t.v[0] | std::uint64_t{t.v[1]} << 32, t.v[2]);
}

std::uint64_t weld_triangles(std::span<const std::uint32_t> representative, std::span<Triangle> triangles) {
  std::uint64_t degenerate = 0;
  for (Triangle& t : triangles) {
    t = {{representative[t.v[0]], representative[t.v[1]], representative[t.v[2]]}};
    if (!is_degenerate(t)) continue;
    t = dropped;
    ++degenerate;
  }
  return degenerate;
}

std::uint64_t drop_degenerate(std::span<Triangle> triangles) {
  std::uint64_t degenerate = 0;
  for (Triangle& t : triangles) {
    if (!is_degenerate(t)) continue;
    t = dropped;
    ++degenerate;
  }
  return degenerate;
}

void mark_used(std::span<const Triangle> triangles, std::span<VertexState> states) {
  for (const Triangle& t : triangles) {
    if (is_degenerate(t)) continue;
    for (const std::uint32_t id : t.v) set_used(states, id);
  }
}

std::size_t compact_vertices(std::span<const VertexState> states, std::span<Vec3f> positions) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (states[i] == VertexState::used) positions[kept++] = positions[i];
  return kept;
}

void number_vertices(std::span<const VertexState> states, std::uint32_t first, std::span<std::uint32_t> numbers) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    numbers[i] = first;
    if (states[i] == VertexState::used) ++first;
  }
}

std::size_t compact_triangles(std::span<const std::uint32_t> numbers, std::span<Triangle> triangles) {
  std::size_t kept = 0;
  for (const Triangle& t : triangles) {
    if (is_degenerate(t)) continue;
    triangles[kept++] = {{numbers[t.v[0]], numbers[t.v[1]], numbers[t.v[2]]}};
  }
  return kept;
}

}  // namespace lodestone
