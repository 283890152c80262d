#include "core/simplify/contract/collapse_mesh.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/base/sort_unique.h"

namespace lodestone {
namespace {

using Id = CollapseMesh::Id;
constexpr Id no_vertex = 0xffff'ffffu;

bool uses(const Triangle& t, Id v) { return t.v[0] == v || t.v[1] == v || t.v[2] == v; }
bool holds(const std::vector<Id>& sorted, Id v) { return std::binary_search(sorted.begin(), sorted.end(), v); }

// The number of the corner at v.
int corner(const Triangle& t, Id v) { return t.v[0] == v ? 0 : t.v[1] == v ? 1 : 2; }

}  // namespace

void CollapseMesh::start(const SimplifyInput& input) {
  const std::size_t n = input.positions.size();
  input_ = input;
  triangles_.assign(input.triangles.begin(), input.triangles.end());
  live_ = triangles_.size();
  for (auto& star : star_) star.clear();
  star_.resize(n);
  for (Id t = 0; t < triangles_.size(); ++t)
    for (const Id v : triangles_[t].v) star_[v].push_back(t);
  position_.clear();
  for (const Vec3f& p : input.positions) position_.push_back(to_double(p));
  fan_.resize(n);
  next_member_.assign(n, no_vertex);
  last_member_.resize(n);
  for (Id v = 0; v < n; ++v) {
    fan_[v] = fan_of(v);
    last_member_[v] = v;
  }
}

// Follows the link of v, of which each triangle gives one directed edge; with any branch it is not a fan.
CollapseMesh::Fan CollapseMesh::fan_of(Id v) const {
  std::vector<std::pair<Id, Id>> link;
  for (const Id t : star_[v]) {
    const auto& c = triangles_[t].v;
    const int k = corner(triangles_[t], v);
    link.emplace_back(c[(k + 1) % 3], c[(k + 2) % 3]);
  }
  if (link.empty()) return Fan::none;
  std::sort(link.begin(), link.end());
  std::vector<Id> ends;
  for (const auto& edge : link) ends.push_back(edge.second);
  std::sort(ends.begin(), ends.end());
  const auto same_start = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (std::adjacent_find(link.begin(), link.end(), same_start) != link.end()) return Fan::none;
  if (std::adjacent_find(ends.begin(), ends.end()) != ends.end()) return Fan::none;

  Id first = link.front().first;  // of an open fan: the one start that is not an end
  bool open = false;
  for (const auto& edge : link)
    if (!holds(ends, edge.first)) first = edge.first, open = true;
  std::size_t steps = 0;
  Id at = first;
  do {
    const auto edge = std::lower_bound(link.begin(), link.end(), std::pair<Id, Id>{at, 0});
    if (edge == link.end() || edge->first != at) break;
    at = edge->second;
    ++steps;
  } while (at != first);
  if (steps != link.size()) return Fan::none;  // several fans
  return open ? Fan::open : Fan::closed;
}

void CollapseMesh::gather_neighbours(Id v, std::vector<Id>& ring) const {
  ring.clear();
  for (const Id t : star_[v])
    for (const Id w : triangles_[t].v)
      if (w != v) ring.push_back(w);
  sort_unique(ring);
}

std::size_t CollapseMesh::count_movable() const {
  std::size_t count = 0;
  for (Id v = 0; v < fan_.size(); ++v) count += is_movable(v);
  return count;
}

std::vector<Id> CollapseMesh::neighbours(Id v) const {
  std::vector<Id> ring;
  gather_neighbours(v, ring);
  return ring;
}

bool CollapseMesh::within_bound(Id v, Vec3d to) const {
  const double bound = input_.max_displacement;
  for (Id m = v; m != no_vertex; m = next_member_[m])
    if (!(length(to - to_double(input_.positions[m])) <= bound)) return false;
  return true;
}

bool CollapseMesh::keeps_topology(Id v, Id u) const {
  opposite_.clear();
  for (const Id t : star_[v]) {
    if (!uses(triangles_[t], u)) continue;
    for (const Id w : triangles_[t].v)
      if (w != v && w != u) opposite_.push_back(w);
  }
  std::sort(opposite_.begin(), opposite_.end());
  if (opposite_.size() != (fan_[v] == Fan::closed ? 2u : 1u)) return false;  // border: along the border only
  gather_neighbours(v, ring_);
  gather_neighbours(u, target_ring_);
  common_.clear();
  std::ranges::set_intersection(ring_, target_ring_, std::back_inserter(common_));
  if (common_ != opposite_) return false;
  if (input_.locked[u] && makes_locked_chord(u, ring_)) return false;
  if (doubles_triangle(v, u)) return false;
  if (star_[v].size() > 1) return true;
  // An ear: the edge that it leaves must still carry a triangle.
  return std::ranges::any_of(star_[u], [&](Id s) { return s != star_[v][0] && uses(triangles_[s], opposite_[0]); });
}

// Blocks need that no edge between two locked vertices is made, because the block on the other side could make the
// same one; nor a triangle of three.
bool CollapseMesh::makes_locked_chord(Id u, const std::vector<Id>& ring) const {
  std::size_t locked = 0;
  for (const Id w : ring) {
    if (w == u || !input_.locked[w]) continue;
    ++locked;
    if (!holds(common_, w)) return true;
  }
  return ring.size() == 3 && locked == 2;
}

// A triangle (v, a, b) becomes (u, a, b), which must not exist. This also keeps tetrahedra.
bool CollapseMesh::doubles_triangle(Id v, Id u) const {
  for (const Id t : star_[v]) {
    if (uses(triangles_[t], u)) continue;
    const auto& c = triangles_[t].v;
    const int k = corner(triangles_[t], v);
    const Id a = c[(k + 1) % 3], b = c[(k + 2) % 3];
    for (const Id s : star_[u])
      if (uses(triangles_[s], a) && uses(triangles_[s], b)) return true;
  }
  return false;
}

bool CollapseMesh::flips(Id v, Vec3d to, Id skip) const {
  for (const Id t : star_[v]) {
    if (uses(triangles_[t], skip)) continue;
    const auto& c = triangles_[t].v;
    const int k = corner(triangles_[t], v);
    const Vec3d a = position_[c[(k + 1) % 3]], b = position_[c[(k + 2) % 3]];
    const Vec3d before = cross(a - position_[v], b - position_[v]), after = cross(a - to, b - to);
    if (dot(before, before) > 0 && !(dot(before, after) > 0)) return true;
  }
  return false;
}

void CollapseMesh::collapse(Id v, Id u) {
  for (const Id t : star_[v]) {
    Triangle& triangle = triangles_[t];
    if (uses(triangle, u)) {
      --live_;
      for (const Id w : triangle.v)
        if (w != v) std::erase(star_[w], t);
    } else {
      star_[u].push_back(t);
    }
    triangle.v[corner(triangle, v)] = u;
  }
  star_[v].clear();
  next_member_[last_member_[u]] = v;
  last_member_[u] = last_member_[v];
}

void CollapseMesh::write_result(SimplifyResult& result) const {
  result.parent.resize(star_.size());
  result.positions.resize(star_.size());
  result.distance.clear();
  result.wedge_parent.clear();
  // A vertex that no list continues to is a survivor, and begins a list.
  std::vector<std::uint8_t> is_member(star_.size(), 0);
  for (const Id m : next_member_)
    if (m != no_vertex) is_member[m] = 1;
  for (Id v = 0; v < star_.size(); ++v) {
    result.positions[v] = to_float(position_[v]);
    if (is_member[v]) continue;
    for (Id m = v; m != no_vertex; m = next_member_[m]) result.parent[m] = v;
  }
  result.triangles = live_;
}

}  // namespace lodestone
