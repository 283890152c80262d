// The texture deviation of cohen1998: how far points of equal texture coordinates are apart in space, at most, before
// and after a collapse. Both surfaces are linear between the crossings of their edges on the texture, so the largest
// distance is at a crossing or at the vertex that goes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/error.h"
#include "core/progressive/collapse_metric.h"
#include "core/progressive/uv_star.h"

namespace lodestone::progressive {
namespace {

struct Corner {
  Vec2f uv;
  Vec3f position;
};

Vec3f between(Vec3f a, Vec3f b, double t) { return to_float((1 - t) * to_double(a) + t * to_double(b)); }

// Where two edges cross on the texture, the distance in space between them.
float crossing(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  const double du = double{b.uv.x} - a.uv.x, dv = double{b.uv.y} - a.uv.y;
  const double eu = double{d.uv.x} - c.uv.x, ev = double{d.uv.y} - c.uv.y;
  const double det = du * ev - dv * eu, ou = double{c.uv.x} - a.uv.x, ov = double{c.uv.y} - a.uv.y;
  if (det == 0) return 0;
  const double s = (ou * ev - ov * eu) / det, t = (ou * dv - ov * du) / det;
  if (s < 0 || s > 1 || t < 0 || t > 1) return 0;
  return length(between(a.position, b.position, s) - between(c.position, d.position, t));
}

// Of a point of the texture within a triangle; empty outside.
std::optional<Vec3f> point_at(Vec2f uv, const Corner& a, const Corner& b, const Corner& c) {
  const double area = uv_area(a.uv, b.uv, c.uv);
  if (area == 0) return std::nullopt;
  const double wa = uv_area(uv, b.uv, c.uv) / area, wb = uv_area(a.uv, uv, c.uv) / area, wc = 1 - wa - wb;
  constexpr double least = -1e-6;
  if (wa < least || wb < least || wc < least) return std::nullopt;
  return to_float(wa * to_double(a.position) + wb * to_double(b.position) + wc * to_double(c.position));
}

class ParametricMetric final : public CollapseMetric {
 public:
  ParametricMetric(const RingMesh& rings, const IndexedMesh& mesh)
      : rings_(&rings), uv_(mesh.wedges.uv), deviation_(rings.vertex_count(), 0) {}

  void start(std::size_t, std::size_t) override {}

  // What v stands for already, and the step; a millionth of its length prefers short ones where nothing deviates.
  void rank(Id v, std::span<float> ranks) const override {
    const Ring& ring = rings_->ring(v);
    for (std::uint32_t k = 0; k < ring.size; ++k) {
      Collapse c{.vertex = v, .target = ring.ids[k]};
      const float way = length(rings_->position(c.target) - rings_->position(v));
      ranks[k] =
          rings_->follows_wedges(c) ? deviation_[v] + step(c) + 1e-6f * way : std::numeric_limits<float>::infinity();
    }
  }

  [[nodiscard]] bool allows(const Collapse& c) const override { return !turns_texture(*rings_, uv_, c); }

  float collapse(const Collapse& c) override {
    const float error = deviation_[c.vertex] + step(c);
    deviation_[c.target] = std::max(deviation_[c.target], error);
    return error;
  }

 private:
  [[nodiscard]] Corner corner(Id vertex, Id wedge) const {
    return {uv_[rings_->source_of(wedge)], rings_->position(vertex)};
  }

  [[nodiscard]] float step(const Collapse& c) const {
    float most = side(c, 0);
    if (c.wedge[1] != c.wedge[0]) most = std::max(most, side(c, 1));
    return most;
  }

  // In the chart of one wedge of v.
  [[nodiscard]] float side(const Collapse& c, int chart) const {
    const Ring& ring = rings_->ring(c.vertex);
    const Corner from = corner(c.vertex, c.wedge[chart]), to = corner(c.target, c.wedge_target[chart]);
    Corner ends[2 * most_neighbours];  // of the edge of each sector that lies opposite v
    std::uint32_t count = 0;
    for (std::uint32_t k = 0; k < ring.sectors() && ring.size <= most_neighbours; ++k) {
      if (rings_->has_wedges() && ring.wedge(k) != c.wedge[chart]) continue;
      const Id a = ring.ids[k], b = ring.ids[ring.next(k)];
      ends[count++] = corner(a, rings_->wedge_of(a, b));
      ends[count++] = corner(b, rings_->wedge_of(b, c.vertex));
    }
    float most = 0;
    bool found = false;
    for (std::uint32_t k = 0; k < count; k += 2) {
      if (!found)
        if (const auto there = point_at(from.uv, to, ends[k], ends[k + 1])) {
          most = std::max(most, length(*there - from.position));
          found = true;
        }
      for (std::uint32_t m = 0; m < count; ++m) most = std::max(most, crossing(to, ends[k], from, ends[m]));
    }
    // Outside of the new triangles, along a seam or border that is not straight on the texture: at most the whole way.
    return found ? most : std::max(most, length(to.position - from.position));
  }

  const RingMesh* rings_;
  std::span<const Vec2f> uv_;
  std::vector<float> deviation_;  // of what has collapsed into a vertex
};

}  // namespace

std::unique_ptr<CollapseMetric> make_parametric_metric(const RingMesh& rings, const IndexedMesh& mesh) {
  if (mesh.wedges.uv.empty())
    throw InputError(describe("", "", "the mesh has no texture coordinates, which the metric parametric measures by",
                              "take --metric quadric"));
  return std::make_unique<ParametricMetric>(rings, mesh);
}

}  // namespace lodestone::progressive
