#include "render/reconstruct/finish/survey.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "core/base/disjoint_sets.h"
#include "render/reconstruct/finish/label_parts.h"

namespace lodestone {
namespace {

// Vertices of more triangles are left to sorting, and to count_handles().
constexpr std::size_t most_around = 256;

// The ends of the edges that the triangles around a vertex have with it: each runs from `prev` to the vertex to `next`.
struct Around {
  std::vector<std::uint32_t> next, prev;
  [[nodiscard]] std::size_t size() const { return next.size(); }
  void clear() { next.clear(), prev.clear(); }
  [[nodiscard]] std::size_t index_of_next(std::uint32_t vertex) const {
    return static_cast<std::size_t>(std::find(next.begin(), next.end(), vertex) - next.begin());
  }
};

// How the triangles around a vertex meet.
enum class Fan : std::uint8_t { closed, open, several };

// The vertex's edges are those of at most two triangles, in opposite directions. Follows the triangles from the one
// whose `next` is on no other triangle, if there is one, round the vertex.
Fan fan_of(const Around& around) {
  std::size_t start = 0, starts = 0;
  for (std::size_t i = 0; i < around.size(); ++i)
    if (std::find(around.prev.begin(), around.prev.end(), around.next[i]) == around.prev.end()) start = i, ++starts;
  if (starts > 1) return Fan::several;
  std::size_t steps = 1, at = around.index_of_next(around.prev[start]);
  for (; at < around.size() && at != start && steps < around.size(); ++steps)
    at = around.index_of_next(around.prev[at]);
  if (steps < around.size()) return Fan::several;
  return starts == 0 ? Fan::closed : Fan::open;
}

class Surveyor {
 public:
  Surveyor(std::span<const Triangle> triangles, std::size_t vertices)
      : triangles_(triangles), first_(vertices + 1, 0), corners_(3 * triangles.size()) {
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t.v) ++first_[v + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) corners_[next[triangles[t].v[k]]++] = 3 * t + k;
  }

  void run() {
    const auto vertices = static_cast<std::uint32_t>(first_.size() - 1);
    Around around;
    for (std::uint32_t v = 0; v < vertices; ++v) {
      if (first_[v] == first_[v + 1]) continue;
      ++used_;
      gather(v, around);
      count_edges_of(v, around);
      if (census.non_manifold + census.inconsistent > 0 || has_pinch_) continue;
      has_pinch_ = around.size() > most_around || fan_of(around) == Fan::several;
    }
  }

  EdgeCensus census;

  [[nodiscard]] bool has_pinch() const { return has_pinch_; }

  // The triangles make one fan at each vertex.
  [[nodiscard]] std::size_t handles() const {
    DisjointSets pieces(first_.size() - 1), loops(first_.size() - 1);
    for (const Triangle& t : triangles_) pieces.unite(t.v[0], t.v[1]), pieces.unite(t.v[1], t.v[2]);
    std::size_t piece_count = 0, holes = 0;
    for (std::uint32_t v = 0; v + 1 < first_.size(); ++v)
      piece_count += first_[v] < first_[v + 1] && pieces.find(v) == v;
    for (const auto& [from, to] : border_) loops.unite(from, to);
    for (const auto& [from, to] : border_) holes += loops.find(from) == from;
    // 2 pieces - 2 handles - holes = vertices - edges + triangles.
    return (2 * piece_count + census.edges - holes - used_ - triangles_.size()) / 2;
  }

 private:
  void gather(std::uint32_t v, Around& around) const {
    around.clear();
    for (std::uint32_t k = first_[v]; k < first_[v + 1]; ++k) {
      const std::uint32_t triangle = corners_[k] / 3, corner = corners_[k] - 3 * triangle;
      const auto& ends = triangles_[triangle].v;
      around.next.push_back(ends[corner == 2 ? 0 : corner + 1]);
      around.prev.push_back(ends[corner == 0 ? 2 : corner - 1]);
    }
  }

  // Counts edges to larger vertices.
  void count_edges_of(std::uint32_t v, const Around& around) {
    const bool is_small = around.size() <= most_around;
    if (is_small && has_regular_edges(around)) {
      for (const std::uint32_t u : around.next) census.edges += u > v;
      return;
    }
    keys_.clear();
    for (const std::uint32_t u : around.next)
      if (u > v) keys_.push_back(half_edge_key(u, true));
    for (const std::uint32_t u : around.prev)
      if (u > v) keys_.push_back(half_edge_key(u, false));
    count_edges_of_vertex(keys_, census);
    for (std::size_t i = 0; is_small && i < around.size(); ++i)
      if (std::find(around.prev.begin(), around.prev.end(), around.next[i]) == around.prev.end())
        border_.emplace_back(v, around.next[i]);
  }

  // True if each edge has two triangles, in opposite directions.
  static bool has_regular_edges(const Around& around) {
    for (const std::uint32_t vertex : around.next)
      if (std::count(around.prev.begin(), around.prev.end(), vertex) != 1 ||
          std::count(around.next.begin(), around.next.end(), vertex) != 1)
        return false;
    return true;
  }

  std::span<const Triangle> triangles_;
  std::vector<std::uint32_t> first_, corners_;  // by vertex: of its corners, 3 times the triangle and which one
  std::vector<std::uint64_t> keys_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> border_;  // edges of one triangle, in its direction
  std::size_t used_ = 0;                                         // vertices
  bool has_pinch_ = false;
};

}  // namespace

Survey survey(const IndexedMesh& mesh) {
  std::vector<Triangle> copies;
  std::span<const Triangle> triangles = mesh.triangles;
  if (!mesh.wedges.vertex.empty() || std::ranges::any_of(triangles, is_degenerate)) {
    copies = mesh.triangles;
    if (!mesh.wedges.vertex.empty())
      for (Triangle& t : copies)
        for (std::uint32_t& v : t.v) v = mesh.wedges.vertex[v];
    std::erase_if(copies, is_degenerate);
    triangles = copies;
  }
  Surveyor surveyor(triangles, mesh.positions.size());
  surveyor.run();
  const EdgeCensus& census = surveyor.census;
  if (census.non_manifold + census.inconsistent > 0) return {census, std::nullopt};
  return {census, surveyor.has_pinch() ? count_handles(mesh) : surveyor.handles()};
}

}  // namespace lodestone
