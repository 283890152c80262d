#include "core/progressive/mesh/activation.h"

#include <bit>
#include <utility>
#include <vector>

#include "core/progressive/mesh/flaps.h"

namespace lodestone::progressive {
namespace {

bool same_place(Vec3f a, Vec3f b) {
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
  return bits(a.x) == bits(b.x) && bits(a.y) == bits(b.y) && bits(a.z) == bits(b.z);
}

}  // namespace

std::vector<std::uint32_t> group_starts(const ProgressiveMesh& mesh) {
  std::vector<std::uint32_t> groups(mesh.positions.size());
  for (std::uint32_t v = 0; v < groups.size(); ++v) {
    const bool near = v > 0 && v != mesh.base_vertices && same_place(mesh.positions[v], mesh.positions[v - 1]);
    const bool joins = near && (v < mesh.base_vertices || groups[mesh.parents[v]] == groups[mesh.parents[v - 1]]);
    groups[v] = joins ? groups[v - 1] : v;
  }
  return groups;
}

// Follows the corner that became active last to its parent until it meets another corner: that activates the triangle.
std::uint32_t activation_of(const Triangle& t, const ProgressiveMesh& mesh, const std::vector<std::uint32_t>& groups) {
  std::uint32_t a = groups[t.v[0]], b = groups[t.v[1]], c = groups[t.v[2]];
  if (a == b || b == c || c == a) return mesh.vertex_count();
  while (true) {
    if (a < b) std::swap(a, b);
    if (a < c) std::swap(a, c);
    if (a < mesh.base_vertices) return 0;
    const std::uint32_t next = groups[mesh.parents[a]];
    if (next == b || next == c) return a;
    a = next;
  }
}

void sort_by_activation(std::span<const Triangle> triangles, std::span<const std::uint32_t> activations,
                        std::size_t vertex_count, Triangle* sorted) {
  std::vector<std::uint32_t> place(vertex_count + 2, 0);
  for (const std::uint32_t a : activations) ++place[a + 1];
  for (std::size_t v = 1; v < place.size(); ++v) place[v] += place[v - 1];
  for (std::size_t t = 0; t < activations.size(); ++t) sorted[place[activations[t]]++] = triangles[t];
}

void sort_by_activation(ProgressiveMesh& mesh) {
  const std::vector<std::uint32_t> groups = group_starts(mesh);
  std::vector<std::uint32_t> activations;
  for (const Triangle& t : mesh.triangles) activations.push_back(activation_of(t, mesh, groups));
  const std::vector<Triangle> unsorted = mesh.triangles;
  delay_flaps(mesh, groups, unsorted, activations);
  sort_by_activation(unsorted, activations, mesh.positions.size(), mesh.triangles.data());
}

}  // namespace lodestone::progressive
