// The blocks that sweeps run over: neighbours in lanes, and what the surface contributes to the energy.
#pragma once

#include <algorithm>
#include <array>

#include "core/base/prefetch.h"
#include "core/spherical/parameterize/sphere_kernel.h"

namespace lodestone::spherical {
inline namespace LODESTONE_LANES {

// A face in four lanes: weights of the squared edges opposite the vertex, its next neighbour and the one after that,
// and that of the guard.
struct FaceConstants {
  Double4 vertex, first, second, guard;
};
static_assert(sizeof(FaceConstants) == 16 * sizeof(double));

// The guard takes a needle to be at least this much of its longest edge high.
inline constexpr double guard_height = 0.02;

[[nodiscard, gnu::always_inline]] inline FaceConstants face_constants(const Vec4x3& to_first, const Vec4x3& to_second,
                                                                      Double4 added) {
  const Vec4x3 across = to_second - to_first, normal = cross(to_first, to_second);
  const Double4 at_vertex = dot(to_first, to_second), at_first = all4d(0) - dot(to_first, across);
  const Double4 at_second = dot(to_second, across), half_squares = at_vertex + at_first + at_second;
  // The sum of two metrics: dot products add up, and 4 A^2 is the sum of their products by pairs.
  const Double4 four_squared = dot(normal, normal) + added * (all4d(2) * half_squares + all4d(3) * added);
  const Double4 area = all4d(0.5) * sqrt(four_squared), half = all4d(0.5) * area;
  const Double4 guarded = max(area, all4d(guard_height) * half_squares);
  const Double4 cube = guarded * guarded * guarded;
  return {half * (at_vertex + added), half * (at_first + added), half * (at_second + added),
          all4d(0.125) / (area * area * (cube * cube))};
}

// By the number of neighbours, so that lanes are alike; then as they come.
inline void sort_by_valence(const progressive::RingMesh& rings, std::span<const Id> vertices, std::vector<Id>& sorted) {
  constexpr std::uint32_t most = 32;
  std::array<std::uint32_t, most + 2> first{};
  const auto valence = [&](Id v) { return std::min(rings.ring(v).size, most); };
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    if (k + prefetch_distance < vertices.size()) prefetch(&rings.ring(vertices[k + prefetch_distance]));
    ++first[valence(vertices[k]) + 1];
  }
  for (std::uint32_t k = 1; k <= most + 1; ++k) first[k] += first[k - 1];
  sorted.resize(vertices.size());
  const std::uint32_t large = first[most];
  for (const Id v : vertices) sorted[first[valence(v)]++] = v;
  std::stable_sort(sorted.begin() + large, sorted.end(),
                   [&](Id a, Id b) { return rings.ring(a).size < rings.ring(b).size; });
}

// The neighbours of the vertices of a group, lane by lane. After the last one the first and the second take turns, so
// that the faces added have a determinant; they weigh nothing.
inline void add_neighbours(const progressive::RingMesh& rings, const SweepGroup& group, std::vector<Id>& neighbours) {
  const std::size_t begin = neighbours.size();
  neighbours.resize(begin + 4 * (group.faces + 1));
  for (std::uint32_t lane = 0; lane < 4; ++lane) {
    const progressive::Ring& ring = rings.ring(group.vertex[lane]);
    Id* to = neighbours.data() + begin + lane;
    for (std::uint32_t k = 0; k < ring.size; ++k) to[4 * k] = ring.ids[k];
    for (std::uint32_t k = ring.size; k <= group.faces; ++k) to[4 * k] = ring.ids[(k - ring.size) % 2];
  }
}

inline void add_constants(const SphereState& state, const SweepGroup& group, const Id* neighbours, Double4 added,
                          double* to) {
  const AlignedPoint4d* surface = state.surface.data();
  double lane_faces[4];
  for (int lane = 0; lane < 4; ++lane) lane_faces[lane] = state.rings.ring(group.vertex[lane]).size;
  const Double4 faces = load4(lane_faces), zero = all4d(0);
  const Vec4x3 centre = gather(surface, group.vertex);
  Vec4x3 first = gather(surface, neighbours) - centre;
  for (std::uint32_t k = 0; k < group.faces; ++k, to += 16) {
    const Vec4x3 second = gather(surface, neighbours + 4 * (k + 1)) - centre;
    const FaceConstants face = face_constants(first, second, added);
    const Mask4 real = all4d(k) < faces;
    store(to, select(real, face.vertex, zero)), store(to + 4, select(real, face.first, zero));
    store(to + 8, select(real, face.second, zero)), store(to + 12, select(real, face.guard, zero));
    first = second;
  }
}

inline void build_block(const SphereState& state, std::span<const Id> vertices, SweepBlock& block) {
  std::vector<Id> sorted;
  sort_by_valence(state.rings, vertices, sorted);
  block.groups.clear(), block.neighbours.clear();
  std::size_t faces = 0;
  for (std::size_t begin = 0; begin < sorted.size(); begin += 4) {
    SweepGroup group;
    group.count = static_cast<std::uint32_t>(std::min<std::size_t>(4, sorted.size() - begin));
    for (std::uint32_t lane = 0; lane < 4; ++lane) group.vertex[lane] = sorted[begin + std::min(lane, group.count - 1)];
    group.faces = state.rings.ring(group.vertex[3]).size;
    faces += group.faces;
    add_neighbours(state.rings, group, block.neighbours);
    block.groups.push_back(group);
  }
  block.constants.resize(16 * faces);
  // The dot products at the corners of an equilateral triangle are 2 / sqrt(3) of its area.
  const Double4 added = all4d(1.1547005383792515 * state.least_area);
  const Id* neighbours = block.neighbours.data();
  double* constants = block.constants.data();
  const Id* const end = neighbours + block.neighbours.size();
  for (const SweepGroup& group : block.groups) {
    const std::uint32_t ids = 4 * (group.faces + 1);
    if (neighbours + 3 * ids <= end)
      for (const Id* id = neighbours + 2 * ids; id != neighbours + 3 * ids; ++id) prefetch(&state.surface[*id]);
    add_constants(state, group, neighbours, added, constants);
    neighbours += 4 * (group.faces + 1), constants += 16 * group.faces;
  }
}

}  // namespace LODESTONE_LANES
}  // namespace lodestone::spherical
