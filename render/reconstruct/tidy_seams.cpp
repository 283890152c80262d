#include <algorithm>
#include <cmath>
#include <limits>

#include "render/reconstruct/seam_mesh.h"

namespace lodestone {
namespace {

class Tidier {
 public:
  Tidier(SeamMesh& seam, const TidyConfig& config) : s_(seam), config_(config) {}

  // As if every triangle were looked at in every round, in their order, new ones last: only few can be changed.
  TidyResult run(Scheduler& scheduler) {
    find_candidates(scheduler);
    TidyResult result;
    for (int round = 0; round < config_.rounds; ++round) {
      const std::size_t before = result.collapsed + result.flipped, count = candidates_.size();
      for (std::size_t k = 0; k < count; ++k) result.collapsed += collapse_short(candidates_[k]);
      note_new();
      for (std::size_t k = 0; k < candidates_.size(); ++k)
        if (flip(candidates_[k])) ++result.flipped, note_new();
      const std::size_t after = candidates_.size();
      for (std::size_t k = 0; k < after; ++k) result.collapsed += collapse_sliver(candidates_[k]);
      note_new();
      if (result.collapsed + result.flipped == before) break;
    }
    return result;
  }

 private:
  [[nodiscard]] float aspect(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return aspect_of(s_.position[a], s_.position[b], s_.position[c]);
  }
  [[nodiscard]] float squared(std::uint32_t a, std::uint32_t b) const {
    const Vec3f d = s_.position[b] - s_.position[a];
    return dot(d, d);
  }

  // Whether a triangle faces where the normals at its corners say.
  [[nodiscard]] bool faces_out(std::uint32_t a, std::uint32_t b, std::uint32_t c, float least) const {
    const Vec3f area = area_vector(s_, a, b, c), mean = s_.normal[a] + s_.normal[b] + s_.normal[c];
    return dot(area, mean) > least * length(area) * length(mean);
  }

  // Half a square has an aspect of 2.
  static constexpr float round_enough = 2.5f;

  [[nodiscard]] bool may_change(std::uint32_t t) const {
    if (!s_.mesh.alive(t)) return false;
    const auto& v = s_.mesh.triangle(t).v;
    const float limit = config_.shortest * config_.spacing;
    return std::min({squared(v[0], v[1]), squared(v[1], v[2]), squared(v[2], v[0])}) < limit * limit ||
           !(aspect(v[0], v[1], v[2]) < round_enough);
  }
  void find_candidates(Scheduler& scheduler) {
    constexpr std::size_t grain = 1 << 14;
    known_ = s_.mesh.triangle_count();
    std::vector<std::vector<std::uint32_t>> found(chunk_count(known_, grain));
    scheduler.for_chunks(known_, grain, [&](ChunkRange range) {
      for (std::size_t t = range.begin; t < range.end; ++t)
        if (may_change(static_cast<std::uint32_t>(t))) found[range.index].push_back(static_cast<std::uint32_t>(t));
    });
    for (const auto& part : found) candidates_.insert(candidates_.end(), part.begin(), part.end());
  }
  void note_new() {
    for (; known_ < s_.mesh.triangle_count(); ++known_)
      if (may_change(static_cast<std::uint32_t>(known_))) candidates_.push_back(static_cast<std::uint32_t>(known_));
  }

  bool collapse_short(std::uint32_t t) {
    if (!s_.mesh.alive(t)) return false;
    const float limit = config_.shortest * config_.spacing;
    const Triangle v = s_.mesh.triangle(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v.v[k], b = v.v[(k + 1) % 3];
      if (squared(a, b) < limit * limit && (collapse(a, b, 0.2f) || collapse(b, a, 0.2f))) return true;
    }
    return false;
  }

  bool collapse_sliver(std::uint32_t t) {
    if (!s_.mesh.alive(t)) return false;
    const Triangle v = s_.mesh.triangle(t);
    if (aspect(v.v[0], v.v[1], v.v[2]) <= config_.worst_aspect) return false;
    std::size_t shortest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (squared(v.v[k], v.v[(k + 1) % 3]) < squared(v.v[shortest], v.v[(shortest + 1) % 3])) shortest = k;
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = v.v[(shortest + n) % 3], b = v.v[(shortest + n + 1) % 3];
      if (squared(a, b) > 4 * config_.spacing * config_.spacing) continue;
      if (collapse(a, b, 0.3f) || collapse(b, a, 0.3f)) return true;
    }
    return false;
  }

  // Moves a to b when a is inside the surface, the link condition holds, and no triangle that stays gets much worse.
  bool collapse(std::uint32_t a, std::uint32_t b, float least_facing) {
    if (s_.frozen[a] || s_.frozen[b] || !s_.mesh.gaps(a).empty()) return false;
    const std::uint32_t left = s_.mesh.at(a, b), right = s_.mesh.at(b, a);
    if (left == EditMesh::none || right == EditMesh::none) return false;
    std::size_t common = 0;
    for (const std::uint32_t t : s_.mesh.around(a))
      for (const std::uint32_t w : s_.mesh.triangle(t).v)
        if (w != a && w != b && s_.mesh.at(a, w) == t)
          common += s_.mesh.at(b, w) != EditMesh::none || s_.mesh.at(w, b) != EditMesh::none;
    if (common != 2) return false;
    float old_worst = 0, new_worst = 0;
    moved_.clear();
    for (const std::uint32_t t : s_.mesh.around(a)) {
      const Triangle v = s_.mesh.triangle(t);
      old_worst = std::max(old_worst, aspect(v.v[0], v.v[1], v.v[2]));
      if (t == left || t == right) continue;
      Triangle m = v;
      std::replace(m.v.begin(), m.v.end(), a, b);
      if (!faces_out(m.v[0], m.v[1], m.v[2], least_facing)) return false;
      const Vec3f was = area_vector(s_, v.v[0], v.v[1], v.v[2]), is = area_vector(s_, m.v[0], m.v[1], m.v[2]);
      if (dot(was, is) < 0.3f * length(was) * length(is)) return false;
      new_worst = std::max(new_worst, aspect(m.v[0], m.v[1], m.v[2]));
      moved_.push_back(m);
    }
    if (moved_.empty() || (new_worst > 8 && new_worst > old_worst)) return false;
    const std::vector<std::uint32_t> gone(s_.mesh.around(a).begin(), s_.mesh.around(a).end());
    for (const std::uint32_t t : gone) s_.mesh.remove(t);
    for (const Triangle& m : moved_) s_.mesh.add(m.v[0], m.v[1], m.v[2]);
    return true;
  }

  // Flips the longest edge where that makes the worse of the two triangles better and bends the surface little.
  bool flip(std::uint32_t t) {
    if (!s_.mesh.alive(t)) return false;
    const Triangle v = s_.mesh.triangle(t);
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (squared(v.v[k], v.v[(k + 1) % 3]) > squared(v.v[longest], v.v[(longest + 1) % 3])) longest = k;
    const std::uint32_t a = v.v[longest], b = v.v[(longest + 1) % 3], c = v.v[(longest + 2) % 3];
    if (aspect(a, b, c) < round_enough) return false;
    const std::uint32_t other = s_.mesh.at(b, a);
    if (other == EditMesh::none) return false;
    const std::uint32_t d = s_.mesh.opposite(other, a, b);
    if (c == d || (s_.frozen[c] && s_.frozen[d])) return false;
    if (s_.mesh.at(c, d) != EditMesh::none || s_.mesh.at(d, c) != EditMesh::none) return false;
    const float before = std::max(aspect(a, b, c), aspect(b, a, d)), after = std::max(aspect(a, d, c), aspect(d, b, c));
    if (!(after < 0.8f * before)) return false;
    const Vec3f n1 = area_vector(s_, a, b, c), n2 = area_vector(s_, b, a, d);
    const bool flat = dot(n1, n2) > 0.94f * length(n1) * length(n2);
    if (!flat && before < config_.worst_aspect) return false;
    if (!faces_out(a, d, c, 0.3f) || !faces_out(d, b, c, 0.3f)) return false;
    s_.mesh.remove(t);
    s_.mesh.remove(other);
    s_.mesh.add(a, d, c);
    s_.mesh.add(d, b, c);
    return true;
  }

  SeamMesh& s_;
  const TidyConfig& config_;
  std::vector<Triangle> moved_;
  std::vector<std::uint32_t> candidates_;  // triangles that are short or thin
  std::size_t known_ = 0;                  // triangles that were judged
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
