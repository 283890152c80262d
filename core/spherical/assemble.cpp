#include "core/spherical/assemble.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <map>
#include <utility>

#include "core/mesh/vertex_of.h"
#include "core/mesh/wedges.h"

namespace lodestone::spherical {
namespace {

// By wedge of the input.
std::vector<Vec3f> normals_of(const IndexedMesh& input) {
  if (!input.wedges.normal.empty()) return input.wedges.normal;
  std::vector<Vec3d> sums(input.positions.size());
  for (const Triangle& t : input.triangles) {
    const auto at = [&](std::size_t k) { return to_double(input.positions[t.v[k]]); };
    const Vec3d area = cross(at(1) - at(0), at(2) - at(0));
    for (const std::uint32_t wedge : t.v) sums[vertex_of(input, wedge)] = sums[vertex_of(input, wedge)] + area;
  }
  std::vector<Vec3f> normals(sums.size());
  for (std::uint32_t w = 0; w < normals.size(); ++w) {
    const Vec3d sum = sums[vertex_of(input, w)];
    const double size = length(sum);
    if (size > 0) normals[w] = to_float(1 / size * sum);
  }
  return normals;
}

// The normal at a point of a triangle; at a corner that of the corner, bit for bit.
Vec3f normal_at(const IndexedMesh& input, const std::vector<Vec3f>& normals, const Triangle& t, Vec3d p) {
  std::array<Vec3d, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = to_double(input.positions[t.v[k]]);
    if (corner[k] == p) return normals[t.v[k]];
  }
  const Vec3d area = cross(corner[1] - corner[0], corner[2] - corner[0]);
  Vec3d sum{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double weight = dot(cross(corner[(k + 1) % 3] - p, corner[(k + 2) % 3] - p), area);
    sum = sum + std::max(weight, 0.0) * to_double(normals[t.v[k]]);
  }
  const double size = length(sum);
  return size > 0 ? to_float(1 / size * sum) : Vec3f{};
}

// Where a vertex of the result is on the input: on the edge between two of its vertices, a < b, at (1 - t) a + t b; at
// a vertex (a == b); or within a triangle (a == no_source).
struct EdgePlace {
  std::uint32_t a = no_source, b = no_source;
  double t = 0;
  [[nodiscard]] bool is_vertex() const { return a == b && a != no_source; }
  [[nodiscard]] bool is_on_edge() const { return a != b; }
};
struct Edge {
  std::uint32_t a = no_source, b = no_source;
  friend auto operator<=>(const Edge&, const Edge&) = default;
};

// The edge of the input that both places are on; without ends if there is none.
Edge common_edge(const EdgePlace& p, const EdgePlace& q) {
  if (p.is_on_edge()) {
    const bool same = q.is_on_edge() ? q.a == p.a && q.b == p.b : q.is_vertex() && (q.a == p.a || q.a == p.b);
    return same ? Edge{p.a, p.b} : Edge{};
  }
  if (q.is_on_edge()) return common_edge(q, p);
  return p.is_vertex() && q.is_vertex() && p.a != q.a ? Edge{std::min(p.a, q.a), std::max(p.a, q.a)} : Edge{};
}
double along(const EdgePlace& p, const Edge& edge) { return p.is_on_edge() ? p.t : p.a == edge.b ? 1 : 0; }

// Copies of an edge, on both sides of a closed handle or of what was cut apart, lie in different places of the square,
// and the cut of the square splits them at different points. All copies are split at all of these points, so that the
// result has no crack.
class Assembly {
 public:
  explicit Assembly(const IndexedMesh& input)
      : input_(input), normals_(normals_of(input)), is_split_(input.positions.size(), 0) {}

  void add(const Surface& surface, const Unfolding& unfolding, const ImagePlace& place) {
    const auto first_vertex = static_cast<std::uint32_t>(places_.size());
    const auto first_uv = static_cast<std::uint32_t>(attributes_.uv.size());
    add_vertices(surface);
    add_split_vertices(unfolding, first_vertex);
    for (const SquarePoint& p : unfolding.place) {
      const SquarePoint at = place.of(p);
      attributes_.uv.push_back({static_cast<float>(at.s), static_cast<float>(at.t)});
    }
    for (std::size_t t = 0; t < unfolding.triangles.size(); ++t) {
      const std::uint32_t source = surface.source_triangle[unfolding.source[t]];
      if (source == no_source) continue;
      Triangle triangle = unfolding.triangles[t], uv = unfolding.corners[t];
      for (std::size_t k = 0; k < 3; ++k) triangle.v[k] += first_vertex, uv.v[k] += first_uv;
      add_triangle(triangle, uv, source, place.material);
    }
  }

  RawMesh finish() {
    share_points();
    for (std::size_t t = 0; t < out_.triangles.size(); ++t) {
      Triangle& normal = attributes_.normal_of.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        normal.v[k] = static_cast<std::uint32_t>(attributes_.normal.size());
        attributes_.normal.push_back(
            normal_at(input_, normals_, input_.triangles[sources_[t]], places_[out_.triangles[t].v[k]]));
      }
    }
    out_.up = input_.transform.up;
    out_.positions = std::move(places_);
    out_.wedges = make_wedges(out_.triangles, out_.positions.size(), attributes_);
    out_.wedges.material = std::move(materials_);
    return std::move(out_);
  }

 private:
  void add_triangle(const Triangle& triangle, const Triangle& uv, std::uint32_t source, std::uint32_t material) {
    out_.triangles.push_back(triangle);
    attributes_.uv_of.push_back(uv);
    sources_.push_back(source);
    materials_.push_back(material);
  }

  // Positions of the surface are those of the input, normalised.
  void add_vertices(const Surface& surface) {
    const std::size_t first = places_.size();
    places_.insert(places_.end(), surface.positions.begin(), surface.positions.end());
    edge_places_.resize(places_.size());
    for (std::size_t v = 0; v < surface.positions.size(); ++v) {
      const SourceVertex source = surface.source_vertex[v];
      if (source == no_source) continue;
      const std::uint32_t a = vertex_of(input_, source.a), b = vertex_of(input_, source.b);
      if (source.is_vertex()) edge_places_[first + v] = {a, a, 0};
      if (source.is_middle()) set_on_edge(first + v, {std::min(a, b), std::max(a, b)}, 0.5);
    }
  }

  void add_split_vertices(const Unfolding& unfolding, std::uint32_t first) {
    for (const AddedVertex& added : unfolding.added) {
      Vec3d p{};
      std::vector<std::pair<std::uint32_t, double>> ends;
      for (std::size_t k = 0; k < 3; ++k) {
        if (!(added.weight[k] > 0)) continue;
        ends.emplace_back(first + added.corner[k], added.weight[k]);
        p = p + added.weight[k] * places_[first + added.corner[k]];
      }
      places_.push_back(p);
      edge_places_.emplace_back();
      if (ends.size() != 2) continue;
      const EdgePlace &from = edge_places_[ends[0].first], &to = edge_places_[ends[1].first];
      if (const Edge edge = common_edge(from, to); edge.a != no_source)
        set_on_edge(places_.size() - 1, edge, ends[0].second * along(from, edge) + ends[1].second * along(to, edge));
    }
  }

  // The position follows from the edge and t, so that all copies of a point are equal.
  void set_on_edge(std::size_t vertex, const Edge& edge, double t) {
    edge_places_[vertex] = {edge.a, edge.b, t};
    places_[vertex] = (1 - t) * to_double(input_.positions[edge.a]) + t * to_double(input_.positions[edge.b]);
    points_[edge].emplace(t, static_cast<std::uint32_t>(vertex));
    is_split_[edge.a] = is_split_[edge.b] = 1;
  }

  void share_points() {
    for (std::size_t t = 0; t < out_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        while (split_side(t, k)) {
        }
  }

  // Splits side k of a triangle at the first point that it lacks; false if it has all.
  bool split_side(std::size_t t, std::size_t k) {
    const Triangle triangle = out_.triangles[t], uv = attributes_.uv_of[t];
    const std::size_t next = (k + 1) % 3;
    const std::uint32_t p = triangle.v[k], q = triangle.v[next];
    const Edge edge = common_edge(edge_places_[p], edge_places_[q]);
    if (edge.a == no_source || is_split_[edge.a] == 0 || is_split_[edge.b] == 0) return false;
    const auto found = points_.find(edge);
    if (found == points_.end()) return false;
    const double at_p = along(edge_places_[p], edge), at_q = along(edge_places_[q], edge);
    const double low = std::min(at_p, at_q), high = std::max(at_p, at_q);
    const auto point = found->second.upper_bound(low);
    if (point == found->second.end() || !(point->first < high)) return false;
    // The lower end first, for the same bits on both sides of the edge.
    const std::uint32_t from = at_p < at_q ? uv.v[k] : uv.v[next], to = at_p < at_q ? uv.v[next] : uv.v[k];
    const auto share = static_cast<float>((point->first - low) / (high - low));
    const Vec2f f = attributes_.uv[from], g = attributes_.uv[to];
    const auto middle = static_cast<std::uint32_t>(attributes_.uv.size());
    attributes_.uv.push_back({f.x + share * (g.x - f.x), f.y + share * (g.y - f.y)});
    Triangle rest = triangle, rest_uv = uv;
    rest.v[k] = point->second, rest_uv.v[k] = middle;
    out_.triangles[t].v[next] = point->second, attributes_.uv_of[t].v[next] = middle;
    add_triangle(rest, rest_uv, sources_[t], materials_[t]);
    return true;
  }

  const IndexedMesh& input_;
  std::vector<Vec3f> normals_;
  std::vector<Vec3d> places_;  // normalised
  std::vector<EdgePlace> edge_places_;
  std::map<Edge, std::map<double, std::uint32_t>> points_;  // by edge of the input: where copies of it are split
  std::vector<std::uint8_t> is_split_;                      // by vertex of the input: an edge of it is
  CornerAttributes attributes_;
  std::vector<std::uint32_t> materials_, sources_;  // by triangle
  RawMesh out_;
};

}  // namespace

RawMesh assemble(const IndexedMesh& input, std::span<const Surface> surfaces, std::span<const Unfolding> unfoldings,
                 std::span<const ImagePlace> places) {
  Assembly assembly(input);
  for (std::size_t k = 0; k < surfaces.size(); ++k) assembly.add(surfaces[k], unfoldings[k], places[k]);
  return assembly.finish();
}

}  // namespace lodestone::spherical
