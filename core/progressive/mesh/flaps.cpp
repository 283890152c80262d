#include "core/progressive/mesh/flaps.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

#include "core/base/disjoint_sets.h"
#include "core/math/vec3.h"

namespace lodestone::progressive {
namespace {

class FlapFinder {
 public:
  FlapFinder(const ProgressiveMesh& mesh, const std::vector<std::uint32_t>& groups, std::span<const Triangle> triangles)
      : mesh_(mesh),
        groups_(groups),
        triangles_(triangles),
        whole_(mesh.base_vertices, 1),
        parts_(mesh.base_vertices) {}

  void delay(std::span<std::uint32_t> activations) {
    find_parts();
    if (std::find(whole_.begin(), whole_.end(), 1) == whole_.end()) return;
    keep_those_on_others();
    const std::vector<std::uint32_t> starts = part_starts();
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (const std::uint32_t v = triangles_[t].v[0]; v < mesh_.base_vertices && is_whole(v))
        activations[t] = std::max(activations[t], starts[part(v)]);
  }

 private:
  [[nodiscard]] std::uint32_t part(std::uint32_t v) { return parts_.find(groups_[v]); }
  [[nodiscard]] bool is_whole(std::uint32_t v) { return whole_[part(v)] != 0; }

  // The parts of the base, and which of them have all their vertices there.
  void find_parts() {
    const std::uint32_t base = mesh_.base_vertices;
    std::vector<char> splits(base, 0);
    for (std::uint32_t v = base; v < mesh_.vertex_count(); ++v)
      if (mesh_.parents[v] < base) splits[groups_[mesh_.parents[v]]] = 1;
    for (const Triangle& t : triangles_) {
      if (std::min({t.v[0], t.v[1], t.v[2]}) >= base) continue;  // nearly all
      const bool inside = t.v[0] < base && t.v[1] < base && t.v[2] < base;
      for (const std::uint32_t v : t.v) {
        if (v >= base) continue;
        if (inside) parts_.unite(groups_[v], groups_[t.v[0]]);
        if (!inside) splits[groups_[v]] = 1;
      }
    }
    for (std::uint32_t v = 0; v < base; ++v)
      if (splits[v] != 0) whole_[part(v)] = 0;
  }

  // Keeps the whole parts that have a vertex on a vertex of a part that collapses.
  void keep_those_on_others() {
    using Key = std::tuple<float, float, float>;
    const auto key = [&](std::uint32_t v) {
      const Vec3f p = mesh_.positions[v];
      return Key(p.x, p.y, p.z);
    };
    std::vector<Key> wanted, found;
    for (std::uint32_t v = 0; v < mesh_.base_vertices; ++v)
      if (is_whole(v)) wanted.push_back(key(v));
    std::sort(wanted.begin(), wanted.end());
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v)
      if ((v >= mesh_.base_vertices || !is_whole(v)) && std::binary_search(wanted.begin(), wanted.end(), key(v)))
        found.push_back(key(v));
    std::sort(found.begin(), found.end());
    std::vector<char> touches(mesh_.base_vertices, 0);
    hangs_.assign(mesh_.base_vertices, 1);
    for (std::uint32_t v = 0; v < mesh_.base_vertices; ++v) {
      const bool held = std::binary_search(found.begin(), found.end(), key(v));
      (held ? touches : hangs_)[part(v)] = held ? 1 : 0;
    }
    for (std::uint32_t p = 0; p < mesh_.base_vertices; ++p) whole_[p] = whole_[p] != 0 && touches[p] != 0;
  }

  // By part: its triangles are in the levels of more vertices than this.
  [[nodiscard]] std::vector<std::uint32_t> part_starts() {
    std::vector<Box3f> boxes(mesh_.base_vertices);
    for (std::uint32_t v = 0; v < mesh_.base_vertices; ++v)
      if (is_whole(v)) boxes[part(v)].extend(mesh_.positions[v]);
    std::vector<std::uint32_t> starts(mesh_.base_vertices, 0);
    for (std::uint32_t v = 0; v < mesh_.base_vertices; ++v) {
      if (part(v) != v || !is_whole(v)) continue;
      const double extent = length(to_double(boxes[v].hi) - to_double(boxes[v].lo));
      const double far = (hangs_[v] != 0 ? 0.5 : 1) * extent;
      const auto& errors = mesh_.errors;
      const auto first = static_cast<std::size_t>(
          std::partition_point(errors.begin(), errors.end(), [&](float e) { return e >= far; }) - errors.begin());
      starts[v] = first <= mesh_.base_vertices ? 0 : groups_[first - 1];
    }
    return starts;
  }

  const ProgressiveMesh& mesh_;
  const std::vector<std::uint32_t>& groups_;
  std::span<const Triangle> triangles_;
  std::vector<char> whole_;  // by part: it does not collapse
  std::vector<char> hangs_;  // by part: all its vertices are on others
  DisjointSets parts_;       // of the groups of the base
};

}  // namespace

void delay_flaps(const ProgressiveMesh& mesh, const std::vector<std::uint32_t>& groups,
                 std::span<const Triangle> triangles, std::span<std::uint32_t> activations) {
  FlapFinder(mesh, groups, triangles).delay(activations);
}

}  // namespace lodestone::progressive
