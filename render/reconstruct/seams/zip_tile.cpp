#include "render/reconstruct/seams/zip_tile.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>

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

constexpr float full_turn = 4;

// Grows with the counter-clockwise angle from a to b, in [0, full_turn): the way round a square.
float turn(Point2 a, Point2 b) {
  const float x = a.x * b.x + a.y * b.y, y = cross2(a, b), sum = std::abs(x) + std::abs(y);
  if (!(sum > 0)) return 0;
  const float t = y / sum;
  return x < 0 ? 2 - t : t < 0 ? 4 + t : t;
}

struct Proposal {
  float radius = 0;  // of the circumscribed circle
  VertexId a, b, c;
  friend bool operator<(const Proposal& s, const Proposal& t) {  // the queue gives the largest first
    return s.radius != t.radius ? s.radius > t.radius : s.a != t.a ? s.a > t.a : s.b > t.b;
  }
};

// The vertices of a tile by cubes of the reach, or larger ones where these would be many.
class TileGrid {
 public:
  TileGrid(const ZipBox& box, float cell, std::span<const Vec3f> positions)
      : corner_(box.corner),
        cell_(std::max(cell, box.side / 32)),
        count_(std::max(1, static_cast<int>(box.side / cell_))) {
    first_.assign(static_cast<std::size_t>(count_ * count_ * count_) + 1, 0);
    for (const Vec3f& p : positions) ++first_[index(p) + 1];
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
    listed_.resize(positions.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (VertexId v{0}; v < positions.size(); ++v) listed_[next[index(positions[v])]++] = v;
  }
  template <class Visit>
  void for_near(Vec3f p, float radius, const Visit& visit) const {
    const int x0 = along(p.x - radius - corner_.x), x1 = along(p.x + radius - corner_.x);
    const int y0 = along(p.y - radius - corner_.y), y1 = along(p.y + radius - corner_.y);
    const int z0 = along(p.z - radius - corner_.z), z1 = along(p.z + radius - corner_.z);
    for (int z = z0; z <= z1; ++z)
      for (int y = y0; y <= y1; ++y) {
        const auto row = static_cast<std::size_t>((z * count_ + y) * count_);
        const std::uint32_t end = first_[row + static_cast<std::size_t>(x1) + 1];
        for (std::uint32_t k = first_[row + static_cast<std::size_t>(x0)]; k < end; ++k) visit(listed_[k]);
      }
  }

 private:
  [[nodiscard]] int along(float d) const { return std::clamp(static_cast<int>(d / cell_), 0, count_ - 1); }
  [[nodiscard]] std::size_t index(Vec3f p) const {
    return static_cast<std::size_t>((along(p.z - corner_.z) * count_ + along(p.y - corner_.y)) * count_ +
                                    along(p.x - corner_.x));
  }
  Vec3f corner_;
  float cell_;
  int count_;
  std::vector<std::uint32_t> first_;
  std::vector<VertexId> listed_;
};

// Works on a copy of the borders in the box, vertices numbered anew: members first, then ghosts beyond the box, which
// are only ever looked at as the other end of an edge.
class TileZipper {
 public:
  TileZipper(const SeamMesh& seam, const BorderLoops& borders, const ZipConfig& config, const ZipTask& task)
      : seam_(seam),
        config_(config),
        box_(task.box),
        reach_(config.reach * config.spacing),
        members_(task.vertices.size()) {
    for (const VertexId v : task.vertices) add_vertex(v);
    grid_.emplace(box_, reach_, std::span(position_).first(members_));
    for (VertexId k{0}; k < members_; ++k)
      for (BorderEdgeId e = borders.first(global_[k]); e != BorderLoops::none; e = borders.edge(e).sibling)
        front_.add_edge(k, local(borders.edge(e).to));
    const auto leaving = static_cast<std::uint32_t>(front_.edge_count());
    for (BorderEdgeId f{0}; f < leaving; ++f) {
      const auto [from, to] = std::pair(front_.edge(f).from, front_.edge(f).to);
      const BorderLoops::Edge& whole = borders.edge(borders.find(global_[from], global_[to]));
      const VertexId before = local(borders.edge(whole.previous).from);
      BorderEdgeId arriving = front_.find(before, from);
      if (arriving == BorderLoops::none) arriving = front_.add_edge(before, from);
      front_.link(arriving, f);
    }
    for (const BorderEdgeId e : task.edges) push(local(borders.edge(e).from), local(borders.edge(e).to));
  }

  ZipResult run() {
    ZipResult result;
    float order = 0;
    while (!queue_.empty()) {
      const Proposal best = queue_.top();
      queue_.pop();
      const BorderEdgeId e = front_.find(best.a, best.b);
      if (e == BorderLoops::none) continue;
      find_near(best.a, best.b);
      if (!fits(e, best.c)) {  // something came in between
        if (Proposal now; propose(e, now)) queue_.push(now);
        continue;
      }
      order = std::max(order, best.radius);
      result.triangles.push_back({order, global_[best.a], global_[best.b], global_[best.c]});
      note_inner(best.a, best.b);
      const BorderLoops::Sides sides = front_.add_triangle(e, best.c);
      if (sides.left == BorderLoops::none) note_inner(best.a, best.c);
      if (sides.right == BorderLoops::none) note_inner(best.c, best.b);
      push(best.a, best.c), push(best.c, best.b);
    }
    for (BorderEdgeId e{0}; e < front_.edge_count(); ++e)
      if (front_.alive(e) && front_.edge(e).tried)
        result.tried.emplace_back(global_[front_.edge(e).from], global_[front_.edge(e).to]);
    return result;
  }

 private:
  VertexId add_vertex(VertexId v) {
    global_.push_back(v);
    position_.push_back(seam_.position[v]);
    normal_.push_back(seam_.normal[v]);
    inner_.push_back(none);
    return front_.add_vertex();
  }
  // Members are in ascending order; ghosts are few.
  VertexId local(VertexId v) {
    const auto members = std::span(global_).first(members_);
    const auto at = std::lower_bound(members.begin(), members.end(), v);
    if (at != members.end() && *at == v) return VertexId(at - members.begin());
    const auto ghost = std::find(global_.begin() + static_cast<std::ptrdiff_t>(members_), global_.end(), v);
    return ghost != global_.end() ? VertexId(ghost - global_.begin()) : add_vertex(v);
  }

  void push(VertexId a, VertexId b) {
    const BorderEdgeId e = front_.find(a, b);
    const Vec3f middle = 0.5f * (position_[a] + position_[b]);
    if (e == BorderLoops::none || !box_.holds_ball(middle, reach_)) return;
    front_.set_tried(e, true);
    if (a >= members_ || b >= members_) return;  // longer than any circle that is allowed
    find_near(a, b);
    if (Proposal p; propose(e, p)) queue_.push(p);
  }

  // Edges between two triangles that were added here: taken both ways.
  struct Inner {
    VertexId vertex;
    std::uint32_t next = 0;
  };
  void note_inner(VertexId a, VertexId b) {
    inner_edges_.push_back({b, inner_[a]});
    inner_[a] = static_cast<std::uint32_t>(inner_edges_.size() - 1);
    inner_edges_.push_back({a, inner_[b]});
    inner_[b] = static_cast<std::uint32_t>(inner_edges_.size() - 1);
  }
  [[nodiscard]] bool is_taken(VertexId a, VertexId b) const {
    for (std::uint32_t k = inner_[a]; k != none; k = inner_edges_[k].next)
      if (inner_edges_[k].vertex == b) return true;
    return front_.find(a, b) != BorderLoops::none || seam_.mesh.at(global_[a], global_[b]) != EditMesh::none;
  }

  void find_near(VertexId a, VertexId b) {
    const Vec3f middle = 0.5f * (position_[a] + position_[b]);
    near_.clear();
    grid_->for_near(middle, reach_, [&](VertexId v) {
      const Vec3f d = position_[v] - middle;
      if (front_.first(v) != BorderLoops::none && dot(d, d) <= reach_ * reach_) near_.push_back(v);
    });
  }

  // The best triangle at a border edge; near_ is that of the edge.
  bool propose(BorderEdgeId e, Proposal& result) {
    const VertexId a = front_.edge(e).from, b = front_.edge(e).to;
    const Vec3f pa = position_[a], pb = position_[b];
    choices_.clear();
    for (const VertexId v : near_) {
      if (v == a || v == b) continue;
      if (runs_against(e, v) && fits(e, v)) {
        result = {0, a, b, v};
        return true;
      }
      const Vec3f ca = pa - position_[v], cb = pb - position_[v];
      const float scale = std::sqrt(dot(ca, ca) * dot(cb, cb));
      choices_.push_back({scale > 0 ? dot(ca, cb) / scale : 1.0f, v});
    }
    std::sort(choices_.begin(), choices_.end());  // the largest angle first
    for (const auto& [cosine, c] : choices_) {
      const float sine = std::sqrt(std::max(1 - cosine * cosine, 0.0f));
      const float radius = sine > 0 ? 0.5f * length(pb - pa) / sine : reach_ * 2;
      if (radius > reach_ || !fits(e, c)) continue;
      result = {radius, a, b, c};
      return true;
    }
    return false;
  }

  [[nodiscard]] bool fits(BorderEdgeId e, VertexId c) const {
    const VertexId a = front_.edge(e).from, b = front_.edge(e).to;
    if (front_.first(c) == BorderLoops::none || seam_.part[global_[a]] != seam_.part[global_[c]]) return false;
    if (runs_against(e, c)) return !is_taken(a, c) && !is_taken(c, b);
    const Vec3f area = cross(position_[a] - position_[b], position_[c] - position_[b]);
    const float size = length(area);
    if (!(size > 0)) return false;
    const Vec3f normal = (1 / size) * area;
    for (const VertexId v : {a, b, c})
      if (!(dot(normal, normal_[v]) > config_.least_cosine)) return false;
    return has_room(normal, e, c) && is_free(Plane(position_[c], normal), a, b, c) && !is_taken(a, c) &&
           !is_taken(c, b) && is_on_model(a, b, c);
  }

  // Two views may sample almost the same point. True if c is that for a or b, and a border edge of another fan would
  // run against this one if they were the same: whatever side rounding has left them on, a triangle closes the seam.
  [[nodiscard]] bool runs_against(BorderEdgeId e, VertexId c) const {
    const VertexId a = front_.edge(e).from, b = front_.edge(e).to;
    const auto is_same = [&](VertexId v) {
      constexpr float nothing = 0.1f;  // of the spacing
      return length(position_[v] - position_[c]) < nothing * config_.spacing &&
             dot(normal_[v], normal_[c]) > config_.least_cosine;
    };
    const auto is_other = [&](BorderEdgeId f, BorderEdgeId own) { return f != BorderLoops::none && f != own; };
    return (is_same(b) && is_other(front_.find(c, a), front_.edge(e).previous)) ||
           (is_same(a) && is_other(front_.find(b, c), front_.edge(e).next));
  }

  // False if the triangle would span a gap of the model.
  [[nodiscard]] bool is_on_model(VertexId a, VertexId b, VertexId c) const {
    if (!seam_.model_border || !seam_.rim[global_[a]] || !seam_.rim[global_[b]] || !seam_.rim[global_[c]]) return true;
    return !seam_.model_border->is_beyond((1.0f / 3) * (position_[a] + position_[b] + position_[c]));
  }

  // Seen along the mean of both normals, the fan at a vertex and the new triangle are both well visible.
  [[nodiscard]] Plane plane_at(VertexId v, Vec3f normal) const {
    const Vec3f up = normal_[v] + normal;
    return {position_[v], (1 / length(up)) * up};
  }

  // True if the triangle fits into the corners' gaps. A gap of v lies between an edge that arrives, from `previous`,
  // and the one that leaves, to `next`; from `previous` counter-clockwise to `next` it is empty.
  [[nodiscard]] bool has_room(Vec3f normal, BorderEdgeId e, VertexId c) const {
    const VertexId a = front_.edge(e).from, b = front_.edge(e).to;
    const auto angle = [&](const Plane& plane, VertexId from, VertexId to) {
      return turn(plane.at(position_[from]), plane.at(position_[to]));
    };
    const auto width = [&](const Plane& plane, VertexId previous, VertexId next) {
      return next == previous ? full_turn : angle(plane, previous, next);
    };
    if (const VertexId previous = front_.edge(front_.edge(e).previous).from; c != previous) {
      const Plane at_a = plane_at(a, normal);
      if (!(angle(at_a, previous, c) < width(at_a, previous, b))) return false;
    }
    if (const VertexId next = front_.edge(front_.edge(e).next).to; c != next) {
      const Plane at_b = plane_at(b, normal);
      if (!(angle(at_b, a, c) < width(at_b, a, next))) return false;
    }
    const Plane at_c = plane_at(c, normal);
    for (BorderEdgeId f = front_.first(c); f != BorderLoops::none; f = front_.edge(f).sibling) {
      const VertexId next = front_.edge(f).to, previous = front_.edge(front_.edge(f).previous).from;
      const float all = width(at_c, previous, next), to_b = b == previous ? 0 : angle(at_c, previous, b),
                  to_a = a == next       ? all
                         : a == previous ? 0
                                         : angle(at_c, previous, a);
      if (to_b < to_a && to_a <= all) return true;
    }
    return false;
  }

  // True if no other vertex lies in the triangle and no border crosses its new edges.
  [[nodiscard]] bool is_free(const Plane& plane, VertexId a, VertexId b, VertexId c) const {
    const Point2 qa = plane.at(position_[a]), qb = plane.at(position_[b]), qc = plane.at(position_[c]);
    const float depth = 0.8f * config_.spacing;
    const auto beside = [&](VertexId v) {
      return std::abs(plane.height(position_[v])) < depth && dot(normal_[v], plane.normal()) > 0;
    };
    const auto crosses = [&](Point2 p, Point2 q, Point2 r, Point2 t) {
      return (cross2(q - p, r - p) > 0) != (cross2(q - p, t - p) > 0) &&
             (cross2(t - r, p - r) > 0) != (cross2(t - r, q - r) > 0);
    };
    for (const VertexId v : near_) {
      const bool corner = v == a || v == b || v == c;
      if (!corner && !beside(v)) continue;
      const Point2 q = plane.at(position_[v]);
      if (!corner && cross2(qa - qb, q - qb) > 0 && cross2(qc - qa, q - qa) > 0 && cross2(qb - qc, q - qc) > 0)
        return false;
      for (BorderEdgeId f = front_.first(v); f != BorderLoops::none; f = front_.edge(f).sibling) {
        const VertexId w = front_.edge(f).to;
        if (w == c || v == c || !beside(w)) continue;
        const Point2 r = plane.at(position_[w]);
        if (v != a && w != a && crosses(qa, qc, q, r)) return false;
        if (v != b && w != b && crosses(qb, qc, q, r)) return false;
      }
    }
    return true;
  }

  static constexpr std::uint32_t none = 0xFFFF'FFFFu;
  const SeamMesh& seam_;
  const ZipConfig& config_;
  ZipBox box_;
  float reach_;
  std::size_t members_;
  std::vector<VertexId> global_;
  std::vector<Vec3f> position_, normal_;
  BorderLoops front_;
  std::optional<TileGrid> grid_;
  std::priority_queue<Proposal> queue_;
  std::vector<std::uint32_t> inner_;  // of each vertex the first of its inner edges
  std::vector<Inner> inner_edges_;
  std::vector<VertexId> near_;
  std::vector<std::pair<float, VertexId>> choices_;
};

}  // namespace

ZipResult zip_tile(const SeamMesh& seam, const BorderLoops& borders, const ZipConfig& config, const ZipTask& task) {
  return TileZipper(seam, borders, config, task).run();
}

}  // namespace lodestone
