#include "core/hierarchy/construct/block_wedges.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/spatial/point_triangle.h"

namespace lodestone {
namespace {

constexpr std::uint32_t no_wedge = 0xffff'ffffu;

// The point of a triangle nearest to p, as weights of its corners that add up to 1. A triangle without area
// gives its corner nearest to p.
std::array<float, 3> weights_in(const std::array<Vec3d, 3>& corner, Vec3d p) {
  const Vec3d q = nearest_on_triangle(p, corner[0], corner[1], corner[2]).point;
  const Vec3d normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const double area2 = dot(normal, normal);
  if (!(area2 > 0)) {
    std::array<float, 3> weight{};
    const auto nearest = std::min_element(
        corner.begin(), corner.end(), [&](Vec3d a, Vec3d b) { return squared_length(p - a) < squared_length(p - b); });
    weight[static_cast<std::size_t>(nearest - corner.begin())] = 1;
    return weight;
  }
  const double b = std::clamp(dot(cross(q - corner[0], corner[2] - corner[0]), normal) / area2, 0.0, 1.0);
  const double c = std::clamp(dot(cross(corner[1] - corner[0], q - corner[0]), normal) / area2, 0.0, 1.0 - b);
  return {static_cast<float>(1 - b - c), static_cast<float>(b), static_cast<float>(c)};
}

}  // namespace

void BlockWedges::weld(std::span<const std::uint32_t> vertex_ids, std::span<const Vec3f> positions,
                       std::span<const Triangle> corners, std::span<std::uint8_t> locked) {
  corners_ = corners;
  vertices_.clear(vertex_ids.size());
  vertex_.resize(vertex_ids.size());
  vertices_.number(vertex_ids, vertex_.data());
  next_wedge_.resize(vertex_ids.size());
  first_wedge_.assign(vertices_.size(), no_wedge);
  positions_.resize(vertices_.size());
  locked_.assign(vertices_.size(), 0);
  for (std::uint32_t w = 0; w < vertex_ids.size(); ++w) {
    const std::uint32_t v = vertex_[w];
    if (first_wedge_[v] == no_wedge) positions_[v] = positions[w];
    locked_[v] |= locked[w];
    next_wedge_[w] = std::exchange(first_wedge_[v], w);
  }
  for (std::size_t w = 0; w < vertex_.size(); ++w) locked[w] = locked_[vertex_[w]];
  triangles_.resize(corners.size());
  for (std::size_t t = 0; t < corners.size(); ++t)
    triangles_[t] = {{vertex_[corners[t].v[0]], vertex_[corners[t].v[1]], vertex_[corners[t].v[2]]}};
}

const SimplifyResult& BlockWedges::simplify(Simplifier& simplifier, float max_displacement,
                                            std::size_t target_triangles, double least_share, Lattice lattice) {
  const bool knows_wedges = simplifier.knows_wedges();
  if (!knows_wedges) label_charts();
  SimplifyInput input{positions_, triangles_, locked_, max_displacement, target_triangles};
  input.lattice = lattice;
  input.least_share = least_share;
  if (knows_wedges) {
    input.corners = corners_;
    input.wedge_vertex = vertex_;
  } else {
    input.labels = labels_;
  }
  const SimplifyResult& by_vertex = simplifier.simplify(input);
  if (knows_wedges) {
    by_wedge_.parent = by_vertex.wedge_parent;
  } else {
    resolve_by_chart(by_vertex);
  }
  expand(by_vertex);
  find_moved(by_vertex);
  return by_wedge_;
}

// Vertices of one wedge have its chart as their label, others the set of their charts. Where a chart meets itself, P
// would not know its side: such vertices keep to themselves.
void BlockWedges::label_charts() {
  charts_ = DisjointSets(vertex_.size());
  for (const Triangle& t : corners_) charts_.unite(t.v[0], t.v[1]), charts_.unite(t.v[0], t.v[2]);
  labels_.resize(positions_.size());
  label_of_.clear();
  std::vector<std::uint32_t> charts;
  std::uint32_t next = static_cast<std::uint32_t>(vertex_.size());  // behind the charts, which are wedges
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    charts.clear();
    for (std::uint32_t w = first_wedge_[v]; w != no_wedge; w = next_wedge_[w]) charts.push_back(charts_.find(w));
    std::sort(charts.begin(), charts.end());
    if (charts.size() == 1) {
      labels_[v] = charts.front();
    } else if (std::adjacent_find(charts.begin(), charts.end()) != charts.end()) {
      labels_[v] = next++;
      locked_[v] = 1;
    } else {
      const auto [at, is_new] = label_of_.try_emplace(charts, next);
      next += is_new;
      labels_[v] = at->second;
    }
  }
}

// Each wedge becomes the one of its chart at the parent.
void BlockWedges::resolve_by_chart(const SimplifyResult& by_vertex) {
  by_wedge_.parent.resize(vertex_.size());
  for (std::uint32_t w = 0; w < vertex_.size(); ++w) {
    const std::uint32_t v = vertex_[w], u = by_vertex.parent[v];
    by_wedge_.parent[w] = w;
    if (u == v) continue;
    for (std::uint32_t x = first_wedge_[u]; x != no_wedge; x = next_wedge_[x])
      if (charts_.find(x) == charts_.find(w)) by_wedge_.parent[w] = x;
  }
}

void BlockWedges::expand(const SimplifyResult& by_vertex) {
  by_wedge_.positions.resize(vertex_.size());
  by_wedge_.distance.resize(by_vertex.distance.empty() ? 0 : vertex_.size());
  for (std::size_t w = 0; w < vertex_.size(); ++w) {
    by_wedge_.positions[w] = by_vertex.positions[vertex_[w]];
    if (!by_vertex.distance.empty()) by_wedge_.distance[w] = by_vertex.distance[vertex_[w]];
  }
  by_wedge_.triangles = by_vertex.triangles;
}

void BlockWedges::find_moved(const SimplifyResult& by_vertex) {
  moved_.clear();
  nearest_.assign(positions_.size(), -1);
  const auto has_moved = [&](std::uint32_t v) {
    return by_vertex.parent[v] == v && by_vertex.positions[v] != positions_[v];
  };
  moved_of_.resize(positions_.size());
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const auto& v = triangles_[t].v;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!has_moved(v[k])) continue;
      const std::array<Vec3d, 3> corner{to_double(positions_[v[0]]), to_double(positions_[v[1]]),
                                        to_double(positions_[v[2]])};
      const Vec3d p = to_double(by_vertex.positions[v[k]]);
      const double squared = nearest_on_triangle(p, corner[0], corner[1], corner[2]).squared_distance;
      if (nearest_[v[k]] >= 0 && squared >= nearest_[v[k]]) continue;
      if (nearest_[v[k]] < 0) {
        moved_of_[v[k]] = static_cast<std::uint32_t>(moved_.size());
        moved_.emplace_back();
      }
      nearest_[v[k]] = squared;
      moved_[moved_of_[v[k]]] = {corners_[t].v[k], t, weights_in(corner, p)};
    }
  }
}

}  // namespace lodestone
