// meshopt_simplify as a proposal, carried out collapse by collapse as far as the contract allows (decision 0007).
//
// The library returns triangles alone: no map of the vertices, no locks, no bound on displacements. Two properties of
// it are used. It keeps the order and the corners of the triangles that it does not drop; so a marker triangle after
// each of ours tells which of ours an output triangle is the image of, and its corners tell where ours have gone. And a
// vertex with several open edges is kept; so markers are kept, and further markers lock what has to be locked.
#include <meshoptimizer.h>

#include <algorithm>

#include "core/math/vec3.h"
#include "core/simplify/contract/collapse_mesh.h"
#include "core/simplify/peers/peers.h"

namespace lodestone {
namespace {

using Id = CollapseMesh::Id;
constexpr Id unknown = 0xffff'ffffu;
constexpr std::size_t markers_per_group = 8;  // they share three vertices
constexpr float any_error = 1e9f;
// Rounds that carry out less than a hundredth of what is missing are idle; after so many of them it stops.
constexpr std::size_t least_progress = 100;
constexpr int idle_rounds = 8;

class MeshoptSimplifier final : public Simplifier {
 public:
  const SimplifyResult& simplify(const SimplifyInput& input) override {
    mesh_.start(input);
    target_ = triangles_to_keep(input, mesh_.count_movable());
    refused_.clear();
    for (int idle = 0; idle < idle_rounds && mesh_.live() > target_;) {
      const std::size_t before = mesh_.live(), missing = before - target_;
      if (!propose(input)) break;
      carry_out();
      if (pending_.empty() && mesh_.live() == before) break;
      const bool moves_on = (before - mesh_.live()) * least_progress > missing;
      if (moves_on) refused_.clear();
      refused_.insert(refused_.end(), pending_.begin(), pending_.end());
      idle += !moves_on;
    }
    mesh_.write_result(result_);
    return result_;
  }

 private:
  bool propose(const SimplifyInput& input);
  void make_request(const SimplifyInput& input);
  void add_marker(Id a, Id b, Id c) { request_.insert(request_.end(), {a, b, c}); }
  void place_markers(const SimplifyInput& input, std::size_t groups);
  bool read_images(std::size_t vertices);
  void settle_vanished(Id v);
  void carry_out();
  [[nodiscard]] bool is_adjacent(Id v, Id u) const;

  CollapseMesh mesh_;
  std::size_t target_ = 0;
  std::vector<Id> triangles_;             // that are left, ascending
  std::vector<Id> refused_;               // proposed since the last round that moved on, but not allowed: locked
  std::vector<Vec3f> places_;             // of vertices and markers, in the unit cube
  std::vector<unsigned> request_, made_;  // indices, in and out
  std::size_t markers_ = 0;
  std::vector<Id> destination_;  // proposed for each vertex
  std::vector<Id> pending_;
  SimplifyResult result_;
};

// Finds destinations for the vertices; false if the library did not return what was expected.
bool MeshoptSimplifier::propose(const SimplifyInput& input) {
  make_request(input);
  const std::size_t added = request_.size() / 3 - triangles_.size();
  made_.resize(request_.size());
  made_.resize(meshopt_simplify(made_.data(), request_.data(), request_.size(), &places_[0].x, places_.size(),
                                sizeof(Vec3f), 3 * (target_ + added), any_error, 0, nullptr));
  return read_images(input.positions.size());
}

// Lists each triangle and a marker after it, then the markers that lock: two at each vertex that must be kept.
void MeshoptSimplifier::make_request(const SimplifyInput& input) {
  const auto n = static_cast<Id>(input.positions.size());
  triangles_.clear();
  for (Id t = 0; t < mesh_.triangles().size(); ++t)
    if (!is_degenerate(mesh_.triangles()[t])) triangles_.push_back(t);
  const std::size_t groups = triangles_.size() / markers_per_group + 1;
  place_markers(input, groups);
  const auto marker = [&](std::size_t group) { return n + 3 * static_cast<Id>(group); };

  request_.clear();
  markers_ = 0;
  for (; markers_ < groups * markers_per_group; ++markers_) {
    if (markers_ < triangles_.size()) {
      const auto& v = mesh_.triangles()[triangles_[markers_]].v;
      request_.insert(request_.end(), v.begin(), v.end());
    }
    const Id m = marker(markers_ / markers_per_group);
    add_marker(m, m + 1, m + 2);
  }
  std::size_t group = 0;
  const auto lock = [&](Id v) {
    const Id m = marker(group++ % groups);
    add_marker(v, m, m + 1);
    add_marker(v, m, m + 1);
  };
  for (Id v = 0; v < n; ++v)
    if (!mesh_.is_movable(v) && !mesh_.star(v).empty()) lock(v);
  for (const Id v : refused_) lock(v);
}

// Positions lie in the unit cube, where single precision is best; the markers form a row through its middle, each at a
// place of its own, for the library takes vertices at one place for one vertex.
void MeshoptSimplifier::place_markers(const SimplifyInput& input, std::size_t groups) {
  Box3f box;
  for (const Vec3f& p : input.positions)
    if (is_finite(p)) box.extend(p);
  const Vec3d origin = to_double(box.lo), extent = to_double(box.hi) - origin;
  const double longest = std::max({extent.x, extent.y, extent.z});
  places_.clear();
  for (const Vec3f& p : input.positions)
    places_.push_back(is_finite(p) && longest > 0 ? to_float((1 / longest) * (to_double(p) - origin)) : Vec3f{});
  const std::size_t count = 3 * groups;
  for (std::size_t k = 0; k < count; ++k)
    places_.push_back({(static_cast<float>(k) + 0.5f) / static_cast<float>(count), 0.5f, 0.5f});
}

// Walks through the result, counting markers: the triangle before marker i is the image of triangle i.
bool MeshoptSimplifier::read_images(std::size_t vertices) {
  destination_.assign(vertices, unknown);
  std::size_t passed = 0;
  for (std::size_t at = 0; at < made_.size(); at += 3) {
    if (made_[at] >= vertices) {
      ++passed;
      continue;
    }
    if (passed >= triangles_.size()) break;  // markers that lock
    const Triangle& t = mesh_.triangles()[triangles_[passed]];
    for (int k = 0; k < 3; ++k) {
      destination_[t.v[k]] = made_[at + k];
      destination_[made_[at + k]] = made_[at + k];
    }
  }
  if (passed < triangles_.size()) return false;
  for (Id v = 0; v < vertices; ++v)
    if (destination_[v] == unknown) settle_vanished(v);
  return true;
}

// A vertex that has lost all its triangles went to the destination of a neighbour at which they vanish.
void MeshoptSimplifier::settle_vanished(Id v) {
  const auto vanish_at = [&](Id place) {
    return std::ranges::all_of(mesh_.star(v), [&](Id t) {
      Triangle image = mesh_.triangles()[t];
      for (Id& w : image.v) w = w == v ? place : destination_[w];
      return is_degenerate(image);
    });
  };
  for (const Id w : mesh_.neighbours(v)) {
    if (destination_[w] == unknown || !vanish_at(destination_[w])) continue;
    destination_[v] = destination_[w];
    return;
  }
  destination_[v] = v;
}

bool MeshoptSimplifier::is_adjacent(Id v, Id u) const {
  return std::ranges::any_of(mesh_.star(v), [&](Id t) { return std::ranges::count(mesh_.triangles()[t].v, u) != 0; });
}

// Survivors take in their neighbours of the same destination, until nothing more is allowed. The image of the input
// depends on P alone: when all are taken in, the mesh is the proposed one, whatever the order.
void MeshoptSimplifier::carry_out() {
  pending_.clear();
  for (Id v = 0; v < destination_.size(); ++v)
    if (destination_[v] != v && !mesh_.star(v).empty()) pending_.push_back(v);
  for (bool again = true; again;) {
    again = false;
    std::erase_if(pending_, [&](Id v) {
      const Id u = destination_[v];
      if (!is_adjacent(v, u) || !mesh_.allows(v, u)) return false;
      mesh_.collapse(v, u);
      return again = true;
    });
  }
}

}  // namespace

std::unique_ptr<Simplifier> make_meshopt_simplifier() { return std::make_unique<MeshoptSimplifier>(); }

}  // namespace lodestone
