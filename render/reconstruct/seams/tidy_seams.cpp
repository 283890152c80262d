#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "render/reconstruct/seams/seam_mesh.h"

namespace lodestone {
namespace {

class Tidier {
 public:
  Tidier(SeamMesh& seam, const TidyConfig& config) : s_(seam), config_(config) {}

  TidyResult run(Scheduler& scheduler) {
    TidyResult result;
    for (int round = 0; round < config_.rounds; ++round) {
      std::size_t changed = 0;
      for (const TriangleId t : find(scheduler, [&](TriangleId t) { return short_collapse(t).has_value(); }))
        if (const auto found = short_collapse(t)) collapse(*found), ++result.collapsed, ++changed;
      for (const TriangleId t : find(scheduler, [&](TriangleId t) { return better_flip(t).has_value(); }))
        if (const auto found = better_flip(t)) flip(*found), ++result.flipped, ++changed;
      for (const TriangleId t : find(scheduler, [&](TriangleId t) { return sliver_collapse(t).has_value(); }))
        if (const auto found = sliver_collapse(t)) collapse(*found), ++result.collapsed, ++changed;
      if (changed == 0) break;
    }
    return result;
  }

 private:
  [[nodiscard]] float aspect(VertexId a, VertexId b, VertexId c) const {
    return aspect_of(s_.position[a], s_.position[b], s_.position[c]);
  }
  [[nodiscard]] float squared(VertexId a, VertexId b) const {
    const Vec3f d = s_.position[b] - s_.position[a];
    return dot(d, d);
  }

  // True if a triangle agrees with the normals at its corners.
  [[nodiscard]] bool faces_out(VertexId a, VertexId b, VertexId c, float least) const {
    const Vec3f area = area_vector(s_, a, b, c), mean = s_.normal[a] + s_.normal[b] + s_.normal[c];
    return dot(area, mean) > least * length(area) * length(mean);
  }

  // Half a square has an aspect of 2: most triangles are round enough never to be examined again.
  static constexpr float round_enough = 2.5f;
  [[nodiscard]] bool is_candidate(TriangleId t) const {
    if (!s_.mesh.alive(t)) return false;
    const auto v = s_.mesh.corners(t);
    const float limit = config_.shortest * config_.spacing;
    return std::min({squared(v[0], v[1]), squared(v[1], v[2]), squared(v[2], v[0])}) < limit * limit ||
           !(aspect(v[0], v[1], v[2]) < round_enough);
  }
  // Judges the triangles that have come since.
  void find_candidates(Scheduler& scheduler) {
    const std::size_t first = std::exchange(known_, s_.mesh.triangle_count());
    filter(
        scheduler, known_ - first, candidates_, [&](std::size_t k) { return TriangleId(first + k); },
        [&](TriangleId t) { return is_candidate(t); });
  }
  // Candidates that pass, ascending: many to look at, few to change.
  template <class Test>
  [[nodiscard]] std::vector<TriangleId> find(Scheduler& scheduler, const Test& test) {
    find_candidates(scheduler);
    std::vector<TriangleId> found;
    filter(
        scheduler, candidates_.size(), found, [&](std::size_t k) { return candidates_[k]; }, test);
    return found;
  }
  template <class Item, class Test>
  static void filter(Scheduler& scheduler, std::size_t count, std::vector<TriangleId>& to, const Item& item,
                     const Test& test) {
    constexpr std::size_t grain = 1 << 12;
    std::vector<std::vector<TriangleId>> found(chunk_count(count, grain));
    scheduler.for_chunks(count, grain, [&](ChunkRange range) {
      for (std::size_t k = range.begin; k < range.end; ++k)
        if (const TriangleId t = item(k); test(t)) found[range.index].push_back(t);
    });
    for (const auto& part : found) to.insert(to.end(), part.begin(), part.end());
  }

  struct Collapse {
    VertexId from, to;
  };
  struct Flip {
    TriangleId first, second;
    VertexId a, b, c, d;  // a, b, c and b, a, d become a, d, c and d, b, c
  };

  [[nodiscard]] std::optional<Collapse> either_way(VertexId a, VertexId b, float least_facing) const {
    if (may_collapse(a, b, least_facing)) return Collapse{a, b};
    if (may_collapse(b, a, least_facing)) return Collapse{b, a};
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Collapse> short_collapse(TriangleId t) const {
    if (!s_.mesh.alive(t)) return std::nullopt;
    const float limit = config_.shortest * config_.spacing;
    const auto v = s_.mesh.corners(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId a = v[k], b = v[(k + 1) % 3];
      if (squared(a, b) >= limit * limit) continue;
      if (const auto found = either_way(a, b, 0.2f)) return found;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Collapse> sliver_collapse(TriangleId t) const {
    if (!s_.mesh.alive(t)) return std::nullopt;
    const auto v = s_.mesh.corners(t);
    if (aspect(v[0], v[1], v[2]) <= config_.worst_aspect) return std::nullopt;
    std::size_t shortest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (squared(v[k], v[(k + 1) % 3]) < squared(v[shortest], v[(shortest + 1) % 3])) shortest = k;
    for (std::size_t n = 0; n < 3; ++n) {
      const VertexId a = v[(shortest + n) % 3], b = v[(shortest + n + 1) % 3];
      if (squared(a, b) > 4 * config_.spacing * config_.spacing) continue;
      if (const auto found = either_way(a, b, 0.3f)) return found;
    }
    return std::nullopt;
  }

  // True if a is inside the surface, the link condition holds, and no remaining triangle gets much worse when a moves
  // to b.
  [[nodiscard]] bool may_collapse(VertexId a, VertexId b, float least_facing) const {
    if (s_.frozen[a] || s_.frozen[b] || !s_.mesh.gaps(a).empty()) return false;
    const TriangleId left = s_.mesh.at(a, b), right = s_.mesh.at(b, a);
    if (left == EditMesh::none || right == EditMesh::none) return false;
    std::size_t common = 0, moved = 0;
    for (const TriangleId t : s_.mesh.around(a))
      for (const VertexId w : s_.mesh.corners(t))
        if (w != a && w != b && s_.mesh.at(a, w) == t)
          common += s_.mesh.at(b, w) != EditMesh::none || s_.mesh.at(w, b) != EditMesh::none;
    if (common != 2) return false;
    float old_worst = 0, new_worst = 0;
    for (const TriangleId t : s_.mesh.around(a)) {
      const auto v = s_.mesh.corners(t);
      old_worst = std::max(old_worst, aspect(v[0], v[1], v[2]));
      if (t == left || t == right) continue;
      auto m = v;
      std::replace(m.begin(), m.end(), a, b);
      if (!faces_out(m[0], m[1], m[2], least_facing)) return false;
      const Vec3f was = area_vector(s_, v[0], v[1], v[2]), is = area_vector(s_, m[0], m[1], m[2]);
      if (dot(was, is) < 0.3f * length(was) * length(is)) return false;
      new_worst = std::max(new_worst, aspect(m[0], m[1], m[2]));
      ++moved;
    }
    return moved > 0 && !(new_worst > 8 && new_worst > old_worst);
  }
  void collapse(const Collapse& c) {
    const std::vector<TriangleId> gone(s_.mesh.around(c.from).begin(), s_.mesh.around(c.from).end());
    std::vector<std::array<VertexId, 3>> moved;
    for (const TriangleId t : gone) {
      moved.push_back(s_.mesh.corners(t));
      std::replace(moved.back().begin(), moved.back().end(), c.from, c.to);
      s_.mesh.remove(t);
    }
    for (const auto& m : moved) s_.mesh.add(m[0], m[1], m[2]);  // but the two that have shrunk
  }

  // Flips the longest edge where that makes the worse of the two triangles better and bends the surface little.
  [[nodiscard]] std::optional<Flip> better_flip(TriangleId t) const {
    if (!s_.mesh.alive(t)) return std::nullopt;
    const auto v = s_.mesh.corners(t);
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (squared(v[k], v[(k + 1) % 3]) > squared(v[longest], v[(longest + 1) % 3])) longest = k;
    const VertexId a = v[longest], b = v[(longest + 1) % 3], c = v[(longest + 2) % 3];
    if (aspect(a, b, c) < round_enough) return std::nullopt;
    const TriangleId other = s_.mesh.at(b, a);
    if (other == EditMesh::none) return std::nullopt;
    const VertexId d = s_.mesh.opposite(other, a, b);
    if (c == d || (s_.frozen[c] && s_.frozen[d])) return std::nullopt;
    const float before = std::max(aspect(a, b, c), aspect(b, a, d)), after = std::max(aspect(a, d, c), aspect(d, b, c));
    if (!(after < 0.8f * before)) return std::nullopt;
    const Vec3f n1 = area_vector(s_, a, b, c), n2 = area_vector(s_, b, a, d);
    const bool flat = dot(n1, n2) > 0.94f * length(n1) * length(n2);
    if (!flat && before < config_.worst_aspect) return std::nullopt;
    if (!faces_out(a, d, c, 0.3f) || !faces_out(d, b, c, 0.3f)) return std::nullopt;
    if (s_.mesh.at(c, d) != EditMesh::none || s_.mesh.at(d, c) != EditMesh::none) return std::nullopt;
    return Flip{t, other, a, b, c, d};
  }
  void flip(const Flip& f) {
    s_.mesh.remove(f.first);
    s_.mesh.remove(f.second);
    s_.mesh.add(f.a, f.d, f.c);
    s_.mesh.add(f.d, f.b, f.c);
  }

  SeamMesh& s_;
  const TidyConfig& config_;
  std::vector<TriangleId> candidates_;  // triangles that are short or thin, ascending; some are removed
  std::size_t known_ = 0;               // triangles that were judged
};

}  // namespace

float aspect_of(Vec3f a, Vec3f b, Vec3f c) {
  const Vec3f ab = b - a, bc = c - b, ca = a - c;
  const float longest2 = std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)}), area2 = length(cross(ab, ca));
  return area2 > 0 ? longest2 / area2 : std::numeric_limits<float>::infinity();
}

TidyResult tidy_seams(SeamMesh& seam, const TidyConfig& config, Scheduler& scheduler) {
  return Tidier(seam, config).run(scheduler);
}

}  // namespace lodestone
