#include "core/simplify/quadric/nonmanifold_stars.h"

#include <algorithm>
#include <limits>

#include "core/simplify/quadric/distance_bound.h"

namespace lodestone::quadric {
namespace {

bool has(NonmanifoldStars::Edge e, Id u) { return e.from == u || e.to == u; }
bool joins(NonmanifoldStars::Edge e, Id a, Id b) { return (e.from == a && e.to == b) || (e.from == b && e.to == a); }

}  // namespace

void NonmanifoldStars::reset(const SimplifyInput& input, const Arrays& arrays, bool any_movable) {
  lists_ = 0;
  if (!any_movable) return;
  list_of_.assign(input.positions.size(), no_list);
  for (std::size_t v = 0; v < input.positions.size(); ++v) {
    const Ring& ring = arrays.ring[v];
    if (ring.has(nonmanifold) && !ring.has(crowded)) begin(static_cast<Id>(v));
  }
  for (const Triangle& t : input.triangles)
    for (int k = 0; k < 3; ++k)
      if (list_of_[t.v[k]] != no_list)
        add(static_cast<Id>(t.v[k]), {static_cast<Id>(t.v[(k + 1) % 3]), static_cast<Id>(t.v[(k + 2) % 3])});
}

unsigned NonmanifoldStars::uses(Id v, Id u) const {
  return static_cast<unsigned>(std::ranges::count_if(triangles(v), [u](Edge e) { return has(e, u); }));
}

unsigned NonmanifoldStars::border_lanes(Id v, const Ring& ring, unsigned degree) const {
  const auto is_border = [&](Id u) {
    Id third = none;
    for (const Edge e : triangles(v)) {
      if (!has(e, u)) continue;
      const Id other = e.from == u ? e.to : e.from;
      if (third != none && third != other) return false;
      third = other;
    }
    return third != none;
  };
  unsigned lanes = 0;
  for (unsigned k = 0; k < degree; ++k)
    if (is_border(ring.lane[k])) lanes |= 1u << k;
  return lanes;
}

bool NonmanifoldStars::has_triangle(Id v, Id a, Id b) const {
  return std::ranges::any_of(triangles(v), [a, b](Edge e) { return joins(e, a, b); });
}

float NonmanifoldStars::squared_distance(Id v, Vec3f point, const AlignedPoint* points) const {
  float nearest = std::numeric_limits<float>::infinity();
  for (const auto& [a, b] : triangles(v))
    nearest = std::min(nearest, squared_distance_bound(point, points[v], points[a], points[b]));
  return nearest;
}

void NonmanifoldStars::begin(Id v) {
  if (lists_ == list_.size()) list_.emplace_back();
  list_[lists_].clear();
  list_of_[v] = static_cast<std::uint32_t>(lists_++);
}

void NonmanifoldStars::add(Id v, Edge e) { list_[list_of_[v]].push_back(e); }

void NonmanifoldStars::replace(Id v, Id from, Id to) {
  for (Edge& e : list_[list_of_[v]]) {
    if (e.from == from) e.from = to;
    if (e.to == from) e.to = to;
  }
}

void NonmanifoldStars::remove(Id v, Id u) {
  std::erase_if(list_[list_of_[v]], [u](Edge e) { return has(e, u); });
}

void NonmanifoldStars::remove(Id v, Id a, Id b) {
  std::erase_if(list_[list_of_[v]], [a, b](Edge e) { return joins(e, a, b); });
}

}  // namespace lodestone::quadric
