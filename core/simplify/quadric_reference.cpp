// Half-edge collapse by quadric error (garland1997, hoppe1996) on triangle lists, with an exact heap.
//
// Written to be read, not to be fast: stars are lists of triangle ids, the candidate of a vertex is its cheapest target
// that passes every test, and whatever a collapse touches is evaluated again. The kernel in quadric_kernel.h keeps the
// same rules on compact rings.
#include "core/simplify/quadric_reference.h"

#include <algorithm>
#include <array>
#include <queue>
#include <tuple>
#include <utility>

#include "core/simplify/quadric.h"

namespace lodestone {
namespace {

using Id = std::uint32_t;
constexpr Id no_vertex = 0xffff'ffffu;

enum class Kind : std::uint8_t {
  fixed,     // locked, without triangles, or not a manifold neighbourhood
  interior,  // one closed fan
  border     // one open fan, on the border of the surface
};

// Planes that hold the border count more than the surface: it has no second side to correct it.
constexpr double border_weight = 4;
constexpr double relocation_stiffness = 1e-3;

struct Candidate {
  double cost;
  Id from, to;
  std::uint32_t stamp;
  // Total order: ties go to the smaller ids.
  friend bool operator>(const Candidate& a, const Candidate& b) {
    return std::tie(a.cost, a.from, a.to) > std::tie(b.cost, b.from, b.to);
  }
};

class HalfEdgeCollapse {
 public:
  explicit HalfEdgeCollapse(const SimplifyInput& input);
  void collapse_to_target();
  void relocate_survivors();
  [[nodiscard]] SimplifyResult result() const;

 private:
  [[nodiscard]] Vec3d input_position(Id v) const { return to_double(input_.positions[v]); }
  [[nodiscard]] Vec3d normal(const Triangle& t) const;  // twice the area long
  [[nodiscard]] Kind kind_of(Id v) const;
  [[nodiscard]] std::vector<Id> neighbours(Id v) const;  // ascending
  void add_quadrics();

  [[nodiscard]] bool within_bound(Id v, Vec3d to) const;
  [[nodiscard]] bool keeps_topology(Id v, Id u) const;
  [[nodiscard]] bool flips(Id v, Vec3d to, Id skip) const;
  void push_best(Id v);
  void collapse(Id v, Id u);

  const SimplifyInput& input_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<Id>> star_;     // triangles of each vertex
  std::vector<std::vector<Id>> members_;  // input vertices that ended up here, itself included
  std::vector<Vec3d> position_;
  std::vector<Quadric> quadric_;
  std::vector<Kind> kind_;
  std::vector<std::uint32_t> stamp_;
  std::size_t live_ = 0;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> heap_;
};

HalfEdgeCollapse::HalfEdgeCollapse(const SimplifyInput& input)
    : input_(input),
      triangles_(input.triangles.begin(), input.triangles.end()),
      star_(input.positions.size()),
      members_(input.positions.size()),
      quadric_(input.positions.size()),
      kind_(input.positions.size()),
      stamp_(input.positions.size()),
      live_(input.triangles.size()) {
  for (const Vec3f& p : input.positions) position_.push_back(to_double(p));
  for (Id t = 0; t < triangles_.size(); ++t)
    for (const Id v : triangles_[t].v) star_[v].push_back(t);
  for (Id v = 0; v < star_.size(); ++v) {
    members_[v] = {v};
    kind_[v] = input.locked[v] ? Kind::fixed : kind_of(v);
  }
  add_quadrics();
}

Vec3d HalfEdgeCollapse::normal(const Triangle& t) const {
  const Vec3d a = position_[t.v[0]];
  return cross(position_[t.v[1]] - a, position_[t.v[2]] - a);
}

// Follows the link of v, each triangle giving one directed edge of it; any branch makes the vertex fixed.
Kind HalfEdgeCollapse::kind_of(Id v) const {
  std::vector<std::pair<Id, Id>> link;
  for (const Id t : star_[v]) {
    const auto& c = triangles_[t].v;
    const int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
    link.emplace_back(c[(k + 1) % 3], c[(k + 2) % 3]);
  }
  if (link.empty()) return Kind::fixed;
  std::sort(link.begin(), link.end());
  std::vector<Id> ends;
  for (const auto& edge : link) ends.push_back(edge.second);
  std::sort(ends.begin(), ends.end());
  const auto same_start = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (std::adjacent_find(link.begin(), link.end(), same_start) != link.end()) return Kind::fixed;
  if (std::adjacent_find(ends.begin(), ends.end()) != ends.end()) return Kind::fixed;

  Id first = link.front().first;  // of an open fan: the one start that is no end
  bool open = false;
  for (const auto& edge : link)
    if (!std::binary_search(ends.begin(), ends.end(), edge.first)) first = edge.first, open = true;
  std::size_t steps = 0;
  Id at = first;
  do {
    const auto edge = std::lower_bound(link.begin(), link.end(), std::pair<Id, Id>{at, 0});
    if (edge == link.end() || edge->first != at) break;
    at = edge->second;
    ++steps;
  } while (at != first);
  if (steps != link.size()) return Kind::fixed;  // several fans
  return open ? Kind::border : Kind::interior;
}

std::vector<Id> HalfEdgeCollapse::neighbours(Id v) const {
  std::vector<Id> ring;
  for (const Id t : star_[v])
    for (const Id w : triangles_[t].v)
      if (w != v) ring.push_back(w);
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  return ring;
}

void HalfEdgeCollapse::add_quadrics() {
  for (const Triangle& t : triangles_) {
    const Vec3d n = normal(t);
    const double size = length(n);
    if (!(size > 0)) continue;
    const Vec3d unit = (1 / size) * n;
    for (int k = 0; k < 3; ++k) {
      const Id a = t.v[k], b = t.v[(k + 1) % 3];
      quadric_[a].add_plane(unit, position_[a], size / 2);
      const auto uses_b = [&](Id s) { return std::ranges::count(triangles_[s].v, b) != 0; };
      if (std::ranges::count_if(star_[a], uses_b) != 1) continue;
      const Vec3d edge = position_[b] - position_[a];
      const double squared = dot(edge, edge);
      if (!(squared > 0)) continue;
      const Vec3d wall = (1 / std::sqrt(squared)) * cross(edge, unit);
      quadric_[a].add_plane(wall, position_[a], border_weight * squared);
      quadric_[b].add_plane(wall, position_[a], border_weight * squared);
    }
  }
}

bool HalfEdgeCollapse::within_bound(Id v, Vec3d to) const {
  const double bound = input_.max_displacement;
  return std::ranges::all_of(members_[v], [&](Id m) { return length(to - input_position(m)) <= bound; });
}

// The link condition (dey1999) by sets, plus what blocks need: no new edge between two locked vertices, because the
// block on the other side could make the same one.
bool HalfEdgeCollapse::keeps_topology(Id v, Id u) const {
  std::vector<Id> opposite;
  for (const Id t : star_[v]) {
    const auto& c = triangles_[t].v;
    if (std::ranges::count(c, u) == 0) continue;
    for (const Id w : c)
      if (w != v && w != u) opposite.push_back(w);
  }
  std::sort(opposite.begin(), opposite.end());
  if (opposite.size() != (kind_[v] == Kind::interior ? 2u : 1u)) return false;  // border: along the border only
  const std::vector<Id> ring = neighbours(v), target_ring = neighbours(u);
  std::vector<Id> common;
  std::ranges::set_intersection(ring, target_ring, std::back_inserter(common));
  if (common != opposite) return false;

  if (input_.locked[u]) {
    std::size_t locked = 0;
    for (const Id w : ring) {
      if (w == u || !input_.locked[w]) continue;
      ++locked;
      if (std::ranges::count(common, w) == 0) return false;
    }
    if (ring.size() == 3 && locked == 2) return false;  // the other block may make this triangle too
  }
  // No triangle twice: what becomes (u, a, b) must not exist. This also keeps tetrahedra.
  for (const Id t : star_[v]) {
    const auto& c = triangles_[t].v;
    if (std::ranges::count(c, u) != 0) continue;
    for (const Id s : star_[u]) {
      const auto& d = triangles_[s].v;
      if (std::ranges::all_of(c, [&](Id w) { return w == v || std::ranges::count(d, w) != 0; })) return false;
    }
  }
  if (star_[v].size() > 1) return true;
  // An ear: the edge that it leaves must still carry a triangle.
  const auto carries = [&](Id s) { return s != star_[v][0] && std::ranges::count(triangles_[s].v, opposite[0]) != 0; };
  return std::ranges::any_of(star_[u], carries);
}

// Whether moving v turns a triangle of its star by 90 degrees or more, those that contain `skip` not counted.
bool HalfEdgeCollapse::flips(Id v, Vec3d to, Id skip) const {
  for (const Id t : star_[v]) {
    const auto& c = triangles_[t].v;
    if (std::ranges::count(c, skip) != 0) continue;
    const int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
    const Vec3d a = position_[c[(k + 1) % 3]], b = position_[c[(k + 2) % 3]];
    const Vec3d before = cross(a - position_[v], b - position_[v]), after = cross(a - to, b - to);
    if (dot(before, before) > 0 && !(dot(before, after) > 0)) return true;
  }
  return false;
}

void HalfEdgeCollapse::push_best(Id v) {
  ++stamp_[v];
  if (kind_[v] == Kind::fixed || star_[v].empty()) return;
  std::vector<std::pair<double, Id>> targets;
  for (const Id u : neighbours(v)) {
    Quadric sum = quadric_[v];
    sum += quadric_[u];
    targets.emplace_back(sum.cost(position_[u]), u);
  }
  std::sort(targets.begin(), targets.end());
  for (const auto& [cost, u] : targets) {
    if (!within_bound(v, position_[u]) || !keeps_topology(v, u) || flips(v, position_[u], u)) continue;
    heap_.push({cost, v, u, stamp_[v]});
    return;
  }
}

void HalfEdgeCollapse::collapse(Id v, Id u) {
  for (const Id t : star_[v]) {
    auto& c = triangles_[t].v;
    if (std::ranges::count(c, u) != 0) {
      --live_;
      for (const Id w : c)
        if (w != v) std::erase(star_[w], t);
    } else {
      *std::ranges::find(c, v) = u;
      star_[u].push_back(t);
    }
  }
  star_[v].clear();
  quadric_[u] += quadric_[v];
  members_[u].insert(members_[u].end(), members_[v].begin(), members_[v].end());
  members_[v].clear();
}

void HalfEdgeCollapse::collapse_to_target() {
  for (Id v = 0; v < star_.size(); ++v) push_best(v);
  while (live_ > input_.target_triangles && !heap_.empty()) {
    const Candidate best = heap_.top();
    heap_.pop();
    const auto [cost, v, u, stamp] = best;
    if (stamp != stamp_[v]) continue;
    // The tests look one ring further than collapses invalidate.
    if (!keeps_topology(v, u) || flips(v, position_[u], u)) {
      push_best(v);
      continue;
    }
    const std::vector<Id> ring = neighbours(v);
    collapse(v, u);
    ++stamp_[v];
    push_best(u);
    for (const Id w : neighbours(u)) push_best(w);
    for (const Id w : ring)
      if (w != u && star_[w].empty()) ++stamp_[w];
  }
}

// Half-edge collapses leave survivors on the input; moving each to the minimum of its quadric, once, lowers the error
// by a sixth. Vertices of the border stay.
void HalfEdgeCollapse::relocate_survivors() {
  for (Id v = 0; v < star_.size(); ++v) {
    if (kind_[v] != Kind::interior || star_[v].empty()) continue;
    double longest = 0;
    for (const Id w : neighbours(v)) longest = std::max(longest, length(position_[w] - position_[v]));
    const Vec3d step = quadric_[v].minimum_near(position_[v], relocation_stiffness) - position_[v];
    if (!(length(step) <= longest)) continue;
    const Vec3d goal = position_[v] + step;
    // What the caller will see.
    const Vec3d to = to_double(input_.lattice ? input_.lattice.nearest(goal) : to_float(goal));
    if (!within_bound(v, to) || flips(v, to, no_vertex)) continue;
    position_[v] = to;
  }
}

SimplifyResult HalfEdgeCollapse::result() const {
  SimplifyResult r;
  r.parent.resize(star_.size());
  for (Id v = 0; v < star_.size(); ++v) {
    for (const Id m : members_[v]) r.parent[m] = v;
    r.positions.push_back(to_float(position_[v]));
  }
  r.triangles = live_;
  return r;
}

class QuadricReference final : public Simplifier {
 public:
  const SimplifyResult& simplify(const SimplifyInput& input) override {
    HalfEdgeCollapse work(input);
    work.collapse_to_target();
    work.relocate_survivors();
    result_ = work.result();
    return result_;
  }

 private:
  SimplifyResult result_;
};

}  // namespace

std::unique_ptr<Simplifier> make_quadric_reference() { return std::make_unique<QuadricReference>(); }

}  // namespace lodestone
