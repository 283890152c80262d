#include "render/reconstruct/resample_attributes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/mesh/disjoint_sets.h"
#include "core/mesh/raw_mesh.h"
#include "core/mesh/wedges.h"

namespace lodestone {
namespace {

// Wedges that triangles join, over which texture coordinates go on without a seam: a number for each.
std::vector<std::uint32_t> label_charts(const IndexedMesh& mesh) {
  DisjointSets sets(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) sets.unite(t.v[0], t.v[1]), sets.unite(t.v[1], t.v[2]);
  std::vector<std::uint32_t> chart(sets.size());
  for (std::uint32_t v = 0; v < chart.size(); ++v) chart[v] = sets.find(v);
  return chart;
}

// Vertices that the maps have not seen take over from their neighbours, round by round.
void spread_sources(std::span<const Triangle> triangles, std::vector<std::uint32_t>& source) {
  for (bool changed = true; changed;) {
    changed = false;
    for (const Triangle& t : triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t.v[k], b = t.v[(k + 1) % 3];
        if (source[a] == no_source && source[b] != no_source) source[a] = source[b], changed = true;
        if (source[b] == no_source && source[a] != no_source) source[b] = source[a], changed = true;
      }
  }
}

class Resampler {
 public:
  Resampler(const IndexedMesh& from, const std::vector<std::uint32_t>& source, RawMesh& mesh)
      : from_(from), source_(source), mesh_(mesh), chart_(label_charts(from)) {}

  void run() {
    CornerAttributes corners;
    const WedgeAttributes& w = from_.wedges;
    const std::size_t count = mesh_.triangles.size();
    if (!w.uv.empty()) corners.uv_of.resize(count, no_values), corners.uv.reserve(3 * count);
    if (!w.normal.empty()) corners.normal_of.resize(count, no_values), corners.normal.reserve(3 * count);
    // One material for all is not named vertex by vertex.
    std::vector<std::uint32_t> material(w.materials.empty() ? 0 : count, w.material.empty() ? 0 : no_material);
    if (!w.colour.empty()) corners.colour.resize(mesh_.positions.size());
    for (std::size_t t = 0; t < count; ++t) {
      const auto& v = mesh_.triangles[t].v;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t seen = source_in_chart(v, k);
        if (seen == no_source) continue;
        const std::array<double, 3> share = shares(seen, mesh_.positions[v[k]]);
        if (!w.uv.empty()) add_uv(corners, t, k, seen, share);
        if (!w.normal.empty()) add_normal(corners, t, k, seen, share);
      }
      const std::uint32_t seen = source_[v[0]];
      if (!w.material.empty() && seen != no_source) material[t] = w.material[from_.triangles[seen].v[0]];
    }
    for (std::uint32_t v = 0; v < corners.colour.size(); ++v) corners.colour[v] = colour_of(v);
    mesh_.wedges = make_wedges(mesh_.triangles, mesh_.positions.size(), corners);
    mesh_.wedges.material = std::move(material);
    mesh_.materials = w.materials;
    mesh_.textures = w.textures;
  }

 private:
  [[nodiscard]] std::uint32_t chart_of(std::uint32_t triangle) const { return chart_[from_.triangles[triangle].v[0]]; }

  // What corner k takes its values from: its own source where that is in the chart of the triangle's first corner, else
  // the source of a corner that is.
  [[nodiscard]] std::uint32_t source_in_chart(const std::array<std::uint32_t, 3>& v, std::size_t k) const {
    const std::uint32_t first = source_[v[0]], own = source_[v[k]];
    if (first == no_source || own == no_source) return own == no_source ? first : own;
    if (chart_of(own) == chart_of(first)) return own;
    const std::uint32_t other = source_[v[3 - k]];  // k is 1 or 2 here
    return other != no_source && chart_of(other) == chart_of(first) ? other : first;
  }

  // Barycentric coordinates of the foot of a point on a triangle; beyond it, too, but not far: a triangle of the source
  // says little about what is many of its sizes away.
  [[nodiscard]] std::array<double, 3> shares(std::uint32_t triangle, Vec3d place) const {
    const Triangle& t = from_.triangles[triangle];
    const Vec3d p = (1 / from_.transform.scale) * (place - from_.transform.origin);
    const Vec3d a = to_double(from_.positions[t.v[0]]), ab = to_double(from_.positions[t.v[1]]) - a,
                ac = to_double(from_.positions[t.v[2]]) - a, ap = p - a, n = cross(ab, ac);
    const double area2 = dot(n, n);
    if (!(area2 > 0)) return {1, 0, 0};
    const double b = dot(cross(ap, ac), n) / area2, c = dot(cross(ab, ap), n) / area2;
    constexpr double most = 8;
    if (!(std::abs(b) <= most && std::abs(c) <= most && std::abs(1 - b - c) <= most))
      return {1.0 / 3, 1.0 / 3, 1.0 / 3};
    return {1 - b - c, b, c};
  }

  void add_uv(CornerAttributes& corners, std::size_t t, std::size_t k, std::uint32_t seen,
              const std::array<double, 3>& share) const {
    double u = 0, v = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec2f uv = from_.wedges.uv[from_.triangles[seen].v[i]];
      u += share[i] * uv.x, v += share[i] * uv.y;
    }
    corners.uv_of[t].v[k] = static_cast<std::uint32_t>(corners.uv.size());
    corners.uv.push_back({static_cast<float>(u), static_cast<float>(v)});
  }
  void add_normal(CornerAttributes& corners, std::size_t t, std::size_t k, std::uint32_t seen,
                  const std::array<double, 3>& share) const {
    Vec3d n;
    for (std::size_t i = 0; i < 3; ++i) n = n + share[i] * to_double(from_.wedges.normal[from_.triangles[seen].v[i]]);
    corners.normal_of[t].v[k] = static_cast<std::uint32_t>(corners.normal.size());
    corners.normal.push_back(unit_normal(n));
  }
  [[nodiscard]] Rgba8 colour_of(std::uint32_t v) const {
    if (source_[v] == no_source) return {};
    const std::array<double, 3> share = shares(source_[v], mesh_.positions[v]);
    const Triangle& t = from_.triangles[source_[v]];
    const auto mix = [&](auto part) {
      double sum = 0;
      for (std::size_t i = 0; i < 3; ++i) sum += share[i] * part(from_.wedges.colour[t.v[i]]);
      return static_cast<std::uint8_t>(std::clamp(sum, 0.0, 255.0) + 0.5);
    };
    return {mix([](Rgba8 c) { return c.r; }), mix([](Rgba8 c) { return c.g; }), mix([](Rgba8 c) { return c.b; }),
            mix([](Rgba8 c) { return c.a; })};
  }

  const IndexedMesh& from_;
  const std::vector<std::uint32_t>& source_;
  RawMesh& mesh_;
  std::vector<std::uint32_t> chart_;
};

}  // namespace

void resample_attributes(const IndexedMesh& from, std::vector<std::uint32_t> source, RawMesh& mesh) {
  const WedgeAttributes& w = from.wedges;
  if (w.uv.empty() && w.colour.empty() && w.normal.empty() && w.material.empty()) return;
  spread_sources(mesh.triangles, source);
  Resampler(from, source, mesh).run();
}

RawMesh split_wedges(const RawMesh& mesh) {
  if (mesh.wedges.corners.empty()) return mesh;
  RawMesh split = mesh;
  split.positions.assign(wedge_count(mesh), Vec3d{});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      split.positions[mesh.wedges.corners[t].v[k]] = mesh.positions[mesh.triangles[t].v[k]];
  split.triangles = mesh.wedges.corners;
  split.wedges.corners.clear();
  return split;
}

}  // namespace lodestone
