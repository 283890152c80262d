#include "core/hierarchy/model/kept_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <vector>

namespace lodestone {
namespace {

constexpr std::uint64_t most_triangles = 30'000;

int most_excessive(const Hierarchy& hierarchy) {
  int worst = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (int l = 0; l < hierarchy.finest(); ++l) {
    const auto at = static_cast<std::size_t>(l);
    const double excess = static_cast<double>(hierarchy.levels[at].triangles) -
                          0.25 * static_cast<double>(hierarchy.levels[at + 1].triangles);
    if (excess > most) most = excess, worst = l;
  }
  return worst;
}

// An edge as one of its triangles uses it.
struct Side {
  std::uint32_t low, high;
  bool forward;
  friend auto operator<=>(const Side&, const Side&) = default;
};

class CellCensus {
 public:
  CellCensus(const Cell& cell, bool wedges, float bound) : cell_(cell), bound_(bound) {
    number_vertices(wedges);
    list_sides();
  }

  void add_to(KeptVertices& kept) {
    std::vector<char> shared(used_.size()), own(used_.size());
    for (std::uint32_t i = 0; i < vertex_.size(); ++i) (i < cell_.first_shared() ? own : shared)[vertex_[i]] = 1;
    find_edges();
    for (std::size_t v = 0; v < used_.size(); ++v) {
      if (!own[v] && !shared[v]) continue;
      ++kept.vertices;
      if (shared[v]) {
        ++kept.shared;
      } else if (non_manifold_[v]) {
        ++kept.non_manifold;
      } else if (border_[v]) {
        ++kept.border;
      } else if (wedges_[v] > 1) {
        ++kept.seams;
      } else if (used_[v] && !near_[v]) {
        ++kept.distant;
      }
    }
  }

 private:
  // Wedges of one position are one vertex.
  void number_vertices(bool wedges) {
    vertex_.resize(cell_.positions.size());
    std::iota(vertex_.begin(), vertex_.end(), 0u);
    if (wedges) {
      std::map<std::tuple<float, float, float>, std::uint32_t> known;
      for (std::uint32_t i = 0; i < vertex_.size(); ++i) {
        const Vec3f p = cell_.positions[i];
        vertex_[i] = known.try_emplace({p.x, p.y, p.z}, i).first->second;
      }
    }
    const std::size_t count = vertex_.size();
    used_.assign(count, 0), near_.assign(count, 0), border_.assign(count, 0), non_manifold_.assign(count, 0);
    wedges_.assign(count, 0);
    for (const std::uint32_t v : vertex_) ++wedges_[v];
  }

  void list_sides() {
    for (const Triangle& t : cell_.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = vertex_[t.v[k]], b = vertex_[t.v[(k + 1) % 3]];
        used_[a] = 1;
        sides_.push_back({std::min(a, b), std::max(a, b), a < b});
        const Vec3d way = to_double(cell_.positions[a]) - to_double(cell_.positions[b]);
        if (dot(way, way) <= double{bound_} * bound_) near_[a] = near_[b] = 1;
      }
    std::sort(sides_.begin(), sides_.end());
  }

  void find_edges() {
    for (std::size_t first = 0; first < sides_.size();) {
      std::size_t end = first;
      while (end < sides_.size() && sides_[end].low == sides_[first].low && sides_[end].high == sides_[first].high)
        ++end;
      const bool alike = end - first == 2 && sides_[first].forward == sides_[first + 1].forward;
      for (const std::uint32_t v : {sides_[first].low, sides_[first].high}) {
        if (end - first == 1) border_[v] = 1;
        if (end - first > 2 || alike) non_manifold_[v] = 1;
      }
      first = end;
    }
  }

  const Cell& cell_;
  float bound_;
  std::vector<std::uint32_t> vertex_;                      // of each wedge
  std::vector<char> used_, near_, border_, non_manifold_;  // by vertex
  std::vector<std::uint32_t> wedges_;                      // likewise
  std::vector<Side> sides_;
};

}  // namespace

KeptVertices find_kept(const Hierarchy& hierarchy) {
  KeptVertices kept{.level = most_excessive(hierarchy)};
  const float bound = hierarchy.displacement_bound(kept.level + 1);
  const std::span<const Cell> cells = hierarchy.cells_of(kept.level);
  const std::uint64_t all = hierarchy.levels[static_cast<std::size_t>(kept.level)].triangles;
  const std::size_t stride = 1 + static_cast<std::size_t>(all / most_triangles);
  for (std::size_t c = 0; c < cells.size(); c += stride)
    CellCensus(cells[c], hierarchy.attributes.wedges, bound).add_to(kept);
  return kept;
}

}  // namespace lodestone
