// Half-edge collapse by quadric error (garland1997, hoppe1996) on triangle lists, with an exact heap.
//
// Written to be read, not to be fast: the candidate of a vertex is its cheapest target that passes every test of
// CollapseMesh, and everything that a collapse touches is evaluated again. The kernel in quadric_kernel.h does the same
// on compact rings.
#include "core/simplify/quadric/quadric_reference.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>
#include <utility>

#include "core/math/quadric.h"
#include "core/simplify/contract/collapse_mesh.h"

namespace lodestone {
namespace {

using Id = CollapseMesh::Id;
using Fan = CollapseMesh::Fan;
constexpr Id no_vertex = 0xffff'ffffu;

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
  explicit HalfEdgeCollapse(const SimplifyInput& input)
      : lattice_(input.lattice), quadric_(input.positions.size()), stamp_(input.positions.size()) {
    mesh_.start(input);
    target_ = triangles_to_keep(input, mesh_.count_movable());
    add_quadrics();
  }
  void collapse_to_target();
  void relocate_survivors();
  void write_result(SimplifyResult& result) const { mesh_.write_result(result); }

 private:
  [[nodiscard]] Id vertices() const { return static_cast<Id>(quadric_.size()); }
  void add_quadrics();
  void push_best(Id v);

  Lattice lattice_;
  CollapseMesh mesh_;
  std::size_t target_ = 0;
  std::vector<Quadric> quadric_;
  std::vector<std::uint32_t> stamp_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> heap_;
};

void HalfEdgeCollapse::add_quadrics() {
  for (const Triangle& t : mesh_.triangles()) {
    const Vec3d origin = mesh_.position(t.v[0]);
    const Vec3d normal = cross(mesh_.position(t.v[1]) - origin, mesh_.position(t.v[2]) - origin);
    const double size = length(normal);
    if (!(size > 0)) continue;
    const Vec3d unit = (1 / size) * normal;
    for (int k = 0; k < 3; ++k) {
      const Id a = t.v[k], b = t.v[(k + 1) % 3];
      const Vec3d from = mesh_.position(a);
      quadric_[a].add_plane(unit, from, size / 2);
      const auto uses_b = [&](Id s) { return std::ranges::count(mesh_.triangles()[s].v, b) != 0; };
      if (std::ranges::count_if(mesh_.star(a), uses_b) != 1) continue;
      const Vec3d edge = mesh_.position(b) - from;
      const double squared = dot(edge, edge);
      if (!(squared > 0)) continue;
      const Vec3d wall = (1 / std::sqrt(squared)) * cross(edge, unit);
      quadric_[a].add_plane(wall, from, border_weight * squared);
      quadric_[b].add_plane(wall, from, border_weight * squared);
    }
  }
}

void HalfEdgeCollapse::push_best(Id v) {
  ++stamp_[v];
  if (!mesh_.is_movable(v) || mesh_.star(v).empty()) return;
  std::vector<std::pair<double, Id>> targets;
  // Cost of what has collapsed into v; a large flat target would hide what the tip of a small feature loses. Between
  // the sum of the squared distances and their mean (decision 0013).
  const double share = std::sqrt(std::sqrt(quadric_[v].weight));
  for (const Id u : mesh_.neighbours(v)) targets.emplace_back(share * quadric_[v].cost(mesh_.position(u)), u);
  std::sort(targets.begin(), targets.end());
  for (const auto& [cost, u] : targets) {
    if (!mesh_.allows(v, u)) continue;
    heap_.push({cost, v, u, stamp_[v]});
    return;
  }
}

void HalfEdgeCollapse::collapse_to_target() {
  for (Id v = 0; v < vertices(); ++v) push_best(v);
  while (mesh_.live() > target_ && !heap_.empty()) {
    const auto [cost, v, u, stamp] = heap_.top();
    heap_.pop();
    if (stamp != stamp_[v]) continue;
    // The tests look one ring further than collapses invalidate.
    if (!mesh_.allows(v, u)) {
      push_best(v);
      continue;
    }
    const std::vector<Id> ring = mesh_.neighbours(v);
    mesh_.collapse(v, u);
    quadric_[u] += quadric_[v];
    ++stamp_[v];
    push_best(u);
    for (const Id w : mesh_.neighbours(u)) push_best(w);
    for (const Id w : ring)
      if (w != u && mesh_.star(w).empty()) ++stamp_[w];
  }
}

// Half-edge collapses leave survivors on the input; moving each to the minimum of its quadric, once, lowers the error
// by a sixth. Vertices of the border are kept.
void HalfEdgeCollapse::relocate_survivors() {
  for (Id v = 0; v < vertices(); ++v) {
    if (!mesh_.is_movable(v) || mesh_.fan(v) != Fan::closed || mesh_.star(v).empty()) continue;
    const Vec3d from = mesh_.position(v);
    double longest = 0;
    for (const Id w : mesh_.neighbours(v)) longest = std::max(longest, length(mesh_.position(w) - from));
    const Vec3d step = quadric_[v].minimum_near(from, relocation_stiffness) - from;
    if (!(length(step) <= longest)) continue;
    const Vec3d goal = from + step;
    // As the caller will see it.
    const Vec3d to = to_double(lattice_ ? lattice_.nearest(goal) : to_float(goal));
    if (mesh_.within_bound(v, to) && !mesh_.flips(v, to, no_vertex)) mesh_.move(v, to);
  }
}

class QuadricReference final : public Simplifier {
 public:
  const SimplifyResult& simplify(const SimplifyInput& input) override {
    HalfEdgeCollapse work(input);
    work.collapse_to_target();
    work.relocate_survivors();
    work.write_result(result_);
    return result_;
  }

 private:
  SimplifyResult result_;
};

}  // namespace

std::unique_ptr<Simplifier> make_quadric_reference() { return std::make_unique<QuadricReference>(); }

}  // namespace lodestone
