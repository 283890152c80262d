// An advancing front from seam to seam: the incremental side of ball pivoting (bernardini1999) with the Delaunay choice
// of the third vertex, restricted to the borders of pieces that are there already (turklevoy1994 zips by clipping
// instead).
#include <algorithm>
#include <cmath>
#include <queue>

#include "render/reconstruct/seam_mesh.h"
#include "render/reconstruct/vertex_grid.h"

namespace lodestone {
namespace {

struct Point2 {
  float x = 0, y = 0;
};
inline Point2 operator-(Point2 a, Point2 b) { return {a.x - b.x, a.y - b.y}; }
inline float cross2(Point2 a, Point2 b) { return a.x * b.y - a.y * b.x; }

// A plane to judge a new triangle in.
class Plane {
 public:
  Plane(Vec3f origin, Vec3f normal) : origin_(origin), n_(normal) {
    const Vec3f aside = std::abs(n_.x) < 0.6f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0};
    u_ = cross(n_, aside);
    u_ = (1 / length(u_)) * u_;
    v_ = cross(n_, u_);
  }
  [[nodiscard]] Point2 at(Vec3f p) const { return {dot(p - origin_, u_), dot(p - origin_, v_)}; }
  [[nodiscard]] float height(Vec3f p) const { return dot(p - origin_, n_); }
  [[nodiscard]] Vec3f normal() const { return n_; }

 private:
  Vec3f origin_, n_, u_, v_;
};

// Counter-clockwise angle from a to b, in [0, 2 pi).
float turn(Point2 a, Point2 b) {
  const float angle = std::atan2(cross2(a, b), a.x * b.x + a.y * b.y);
  return angle < 0 ? angle + 6.2831853f : angle;
}

struct Proposal {
  float radius = 0;  // of the circumscribed circle
  std::uint32_t a = 0, b = 0, c = 0;
  friend bool operator<(const Proposal& s, const Proposal& t) {  // the queue gives the largest first
    return s.radius != t.radius ? s.radius > t.radius : s.a != t.a ? s.a > t.a : s.b > t.b;
  }
};

class Zipper {
 public:
  Zipper(SeamMesh& seam, const ZipConfig& config)
      : s_(seam), config_(config), reach_(config.reach * config.spacing), grid_(reach_) {
    gaps_.resize(seam.mesh.vertex_count());
    known_.resize(seam.mesh.vertex_count(), 0);
  }

  std::size_t run() {
    collect();
    std::size_t added = 0;
    while (!queue_.empty()) {
      const Proposal best = queue_.top();
      queue_.pop();
      if (!s_.is_border(best.a, best.b)) continue;
      Proposal now;
      if (!propose(best.a, best.b, now)) continue;
      if (now.radius > best.radius * 1.001f) {  // something came in between
        queue_.push(now);
        continue;
      }
      if (s_.mesh.add(now.b, now.a, now.c) == EditMesh::none) continue;
      ++added;
      known_[now.a] = known_[now.b] = known_[now.c] = 0;
      push(now.a, now.c), push(now.c, now.b);
    }
    return added;
  }

 private:
  void collect() {
    for (std::uint32_t v = 0; v < s_.mesh.vertex_count(); ++v) {
      if (!s_.border[v]) continue;
      bool border = false;
      for (const EditMesh::Gap& gap : gaps(v)) {
        if (gap.next == EditMesh::none || !s_.is_border(v, gap.next)) continue;
        border = true;
        if (config_.rims || !(s_.rim[v] && s_.rim[gap.next])) push(v, gap.next);
      }
      if (border) grid_.insert(v, s_.position[v]);
    }
  }

  void push(std::uint32_t a, std::uint32_t b) {
    Proposal p;
    if (s_.is_border(a, b) && propose(a, b, p)) queue_.push(p);
  }

  // The gaps of a vertex change only when a triangle comes to it.
  [[nodiscard]] const std::vector<EditMesh::Gap>& gaps(std::uint32_t v) const {
    if (!known_[v]) gaps_[v] = s_.mesh.gaps(v), known_[v] = 1;
    return gaps_[v];
  }

  // The best triangle at the border edge a -> b.
  bool propose(std::uint32_t a, std::uint32_t b, Proposal& result) {
    const Vec3f pa = s_.position[a], pb = s_.position[b], middle = 0.5f * (pa + pb);
    near_.clear();
    choices_.clear();
    grid_.for_near(middle, reach_, [&](std::uint32_t v) {
      const Vec3f d = s_.position[v] - middle;
      if (dot(d, d) > reach_ * reach_) return;
      near_.push_back(v);
      if (v == a || v == b) return;
      const Vec3f ca = pa - s_.position[v], cb = pb - s_.position[v];
      const float scale = std::sqrt(dot(ca, ca) * dot(cb, cb));
      choices_.push_back({scale > 0 ? dot(ca, cb) / scale : 1.0f, v});
    });
    std::sort(choices_.begin(), choices_.end());  // the largest angle first
    for (const auto& [cosine, c] : choices_) {
      const float sine = std::sqrt(std::max(1 - cosine * cosine, 0.0f));
      const float radius = sine > 0 ? 0.5f * length(pb - pa) / sine : reach_ * 2;
      if (radius > reach_ || !fits(a, b, c)) continue;
      result = {radius, a, b, c};
      return true;
    }
    return false;
  }

  [[nodiscard]] bool fits(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    if (s_.part[a] != s_.part[c] || s_.mesh.at(a, c) != EditMesh::none || s_.mesh.at(c, b) != EditMesh::none)
      return false;
    const Vec3f area = area_vector(s_, b, a, c);
    const float size = length(area);
    if (!(size > 0)) return false;
    const Vec3f normal = (1 / size) * area;
    for (const std::uint32_t v : {a, b, c})
      if (!(dot(normal, s_.normal[v]) > config_.least_cosine)) return false;
    return has_room(normal, a, b, c) && is_free(Plane(s_.position[c], normal), a, b, c);
  }

  // Half way between the fan at a vertex and the new triangle both are seen well.
  [[nodiscard]] Plane plane_at(std::uint32_t v, Vec3f normal) const {
    const Vec3f up = s_.normal[v] + normal;
    return {s_.position[v], (1 / length(up)) * up};
  }

  // Whether the corners' gaps hold the triangle.
  [[nodiscard]] bool has_room(Vec3f normal, std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const auto angle = [&](const Plane& plane, std::uint32_t from, std::uint32_t to) {
      return turn(plane.at(s_.position[from]), plane.at(s_.position[to]));
    };
    // From `previous` counter-clockwise to `next` it is empty.
    const auto place = [&](const Plane& plane, const EditMesh::Gap& gap, std::uint32_t x) {
      return x == gap.previous ? 0.0f : angle(plane, gap.previous, x);
    };
    const auto width = [&](const Plane& plane, const EditMesh::Gap& gap) {
      return gap.next == gap.previous ? 6.2831853f : angle(plane, gap.previous, gap.next);
    };
    bool room = false;
    const Plane at_a = plane_at(a, normal), at_b = plane_at(b, normal), at_c = plane_at(c, normal);
    for (const EditMesh::Gap& gap : gaps(a))
      if (gap.next == b) room = c == gap.previous || place(at_a, gap, c) < width(at_a, gap);
    if (!room) return false;
    room = false;
    for (const EditMesh::Gap& gap : gaps(b))
      if (gap.previous == a) room = c == gap.next || place(at_b, gap, c) < width(at_b, gap);
    if (!room) return false;
    for (const EditMesh::Gap& gap : gaps(c)) {
      if (gap.next == EditMesh::none || !s_.is_border(c, gap.next)) continue;
      const float all = width(at_c, gap), to_b = place(at_c, gap, b), to_a = a == gap.next ? all : place(at_c, gap, a);
      if (to_b < to_a && to_a <= all) return true;
    }
    return false;
  }

  // Whether no other vertex lies in the triangle and no border crosses its new edges.
  [[nodiscard]] bool is_free(const Plane& plane, std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Point2 qa = plane.at(s_.position[a]), qb = plane.at(s_.position[b]), qc = plane.at(s_.position[c]);
    const float depth = 0.8f * config_.spacing;
    const auto beside = [&](std::uint32_t v) {
      return std::abs(plane.height(s_.position[v])) < depth && dot(s_.normal[v], plane.normal()) > 0;
    };
    const auto crosses = [&](Point2 p, Point2 q, Point2 r, Point2 t) {
      return (cross2(q - p, r - p) > 0) != (cross2(q - p, t - p) > 0) &&
             (cross2(t - r, p - r) > 0) != (cross2(t - r, q - r) > 0);
    };
    for (const std::uint32_t v : near_) {
      const bool corner = v == a || v == b || v == c;
      const Point2 q = plane.at(s_.position[v]);
      if (!corner) {
        if (!beside(v)) continue;
        if (cross2(qa - qb, q - qb) > 0 && cross2(qc - qa, q - qa) > 0 && cross2(qb - qc, q - qc) > 0) return false;
      }
      for (const EditMesh::Gap& gap : gaps(v)) {
        const std::uint32_t w = gap.next;
        if (w == EditMesh::none || !beside(w)) continue;
        const Point2 r = plane.at(s_.position[w]);
        if (v != a && v != c && w != a && w != c && crosses(qa, qc, q, r)) return false;
        if (v != b && v != c && w != b && w != c && crosses(qb, qc, q, r)) return false;
      }
    }
    return true;
  }

  SeamMesh& s_;
  const ZipConfig& config_;
  float reach_;
  VertexGrid grid_;
  std::priority_queue<Proposal> queue_;
  mutable std::vector<std::vector<EditMesh::Gap>> gaps_;
  mutable std::vector<std::uint8_t> known_;
  std::vector<std::uint32_t> near_;
  std::vector<std::pair<float, std::uint32_t>> choices_;
};

}  // namespace

void mark_rims(std::span<const Vec3f> border, float distance, SeamMesh& seam) {
  VertexGrid grid(distance);
  for (std::uint32_t k = 0; k < border.size(); ++k) grid.insert(k, border[k]);
  for (std::uint32_t v = 0; v < seam.position.size(); ++v) {
    seam.rim[v] = 0;
    grid.for_near(seam.position[v], distance, [&](std::uint32_t k) {
      const Vec3f d = border[k] - seam.position[v];
      if (dot(d, d) <= distance * distance) seam.rim[v] = 1;
    });
  }
}

std::size_t zip_seams(SeamMesh& seam, const ZipConfig& config) { return Zipper(seam, config).run(); }

}  // namespace lodestone
