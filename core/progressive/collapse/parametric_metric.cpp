// The texture deviation of cohen1998: the maximum distance in space between points of equal texture coordinates before
// and after a collapse. Both surfaces are linear between the crossings of their edges on the texture, so the largest
// distance is at a crossing or at the vertex that goes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/error.h"
#include "core/progressive/collapse/collapse_metric.h"
#include "core/progressive/collapse/uv_star.h"

namespace lodestone::progressive {
namespace {

struct Corner {
  Vec2f uv;
  Vec3f position;
};

Vec3f between(Vec3f a, Vec3f b, double t) { return to_float((1 - t) * to_double(a) + t * to_double(b)); }

// The distance in space of two edges where they cross on the texture. Most do not, and nothing is divided.
float crossing(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  const double du = double{b.uv.x} - a.uv.x, dv = double{b.uv.y} - a.uv.y;
  const double eu = double{d.uv.x} - c.uv.x, ev = double{d.uv.y} - c.uv.y;
  const double ou = double{c.uv.x} - a.uv.x, ov = double{c.uv.y} - a.uv.y;
  const double det = du * ev - dv * eu, sign = det < 0 ? -1 : 1, size = sign * det;
  const double s = sign * (ou * ev - ov * eu), t = sign * (ou * dv - ov * du);
  // One branch instead of five.
  const int crosses = int{size > 0} & int{s >= 0} & int{s <= size} & int{t >= 0} & int{t <= size};
  if (crosses == 0) return 0;
  return length(between(a.position, b.position, s / size) - between(c.position, d.position, t / size));
}

// The place in space of a point of the texture within a triangle; empty outside.
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

  // The deviation so far and that of the step; a millionth of its length prefers short ones where nothing deviates.
  void rank(Id v, std::span<float> ranks) const override {
    const Ring& ring = rings_->ring(v);
    Fans fans;
    for (std::uint32_t k = 0; k < ring.size; ++k) {
      Collapse c{.vertex = v, .target = ring.ids[k]};
      const float way = length(rings_->position(c.target) - rings_->position(v));
      ranks[k] = rings_->follows_wedges(c) ? deviation_[v] + step(c, fans) + 1e-6f * way
                                           : std::numeric_limits<float>::infinity();
    }
  }

  [[nodiscard]] bool allows(const Collapse& c) const override { return !turns_texture(*rings_, uv_, c); }

  float collapse(const Collapse& c) override {
    Fans fans;
    const float error = deviation_[c.vertex] + step(c, fans);
    deviation_[c.target] = std::max(deviation_[c.target], error);
    return error;
  }

 private:
  // The surroundings of one wedge of a vertex: the neighbours' corners in its chart, and those of each triangle.
  struct Fan {
    Id wedge = no_id;
    Corner from;
    std::uint32_t spokes = 0, sectors = 0;
    Corner spoke[max_neighbours + 1];
    std::uint8_t first[max_neighbours], second[max_neighbours];
  };
  // The fans of the two wedges at an edge, found once for all targets of a vertex.
  struct Fans {
    Fan fan[2];
    std::uint32_t last = 0;
  };

  [[nodiscard]] Corner corner(Id vertex, Id wedge) const {
    return {uv_[rings_->source_of(wedge)], rings_->position(vertex)};
  }

  [[nodiscard]] float step(const Collapse& c, Fans& fans) const {
    float most = side(fan_of(c, 0, fans), c, 0);
    if (c.wedge[1] != c.wedge[0]) most = std::max(most, side(fan_of(c, 1, fans), c, 1));
    return most;
  }

  [[nodiscard]] const Fan& fan_of(const Collapse& c, int chart, Fans& fans) const {
    const Id wedge = c.wedge[chart];
    for (const Fan& fan : fans.fan)
      if (fan.wedge == wedge) return fan;
    Fan& fan = fans.fan[fans.last++ % 2];
    fan.wedge = wedge, fan.from = corner(c.vertex, wedge), fan.spokes = fan.sectors = 0;
    const Ring& ring = rings_->ring(c.vertex);
    const auto add = [&](Id vertex, Id of_vertex) {  // a spoke that two triangles share counts once
      const Corner end = corner(vertex, of_vertex);
      for (const std::uint32_t k : {fan.spokes - 1, 0u})
        if (k < fan.spokes && fan.spoke[k].position == end.position && fan.spoke[k].uv.x == end.uv.x &&
            fan.spoke[k].uv.y == end.uv.y)
          return static_cast<std::uint8_t>(k);
      fan.spoke[fan.spokes] = end;
      return static_cast<std::uint8_t>(fan.spokes++);
    };
    for (std::uint32_t k = 0; k < ring.sectors() && ring.size <= max_neighbours; ++k) {
      if (rings_->has_wedges() && ring.wedge(k) != wedge) continue;
      const Id a = ring.ids[k], b = ring.ids[ring.next(k)];
      if (fan.spokes + 2 > max_neighbours) break;
      fan.first[fan.sectors] = add(a, rings_->wedge_of(a, b));
      fan.second[fan.sectors++] = add(b, rings_->wedge_of(b, c.vertex));
    }
    return fan;
  }

  // The deviation in the chart of one wedge of v.
  [[nodiscard]] float side(const Fan& fan, const Collapse& c, int chart) const {
    const Corner to = corner(c.target, c.wedge_target[chart]);
    float most = 0;
    bool found = false;
    for (std::uint32_t k = 0; k < fan.sectors && !found; ++k)
      if (const auto there = point_at(fan.from.uv, to, fan.spoke[fan.first[k]], fan.spoke[fan.second[k]])) {
        most = length(*there - fan.from.position);
        found = true;
      }
    // Edges with an end in common meet there, where nothing deviates.
    for (std::uint32_t k = 0; k < fan.spokes; ++k)
      for (std::uint32_t m = 0; m < fan.spokes; ++m)
        if (m != k) most = std::max(most, crossing(to, fan.spoke[k], fan.from, fan.spoke[m]));
    // Outside the new triangles, along a seam or border that is not straight on the texture: at most the whole way.
    return found ? most : std::max(most, length(to.position - fan.from.position));
  }

  const RingMesh* rings_;
  std::span<const Vec2f> uv_;
  std::vector<float> deviation_;  // of what has collapsed into a vertex
};

}  // namespace

std::unique_ptr<CollapseMetric> make_parametric_metric(const RingMesh& rings, const IndexedMesh& mesh) {
  if (mesh.wedges.uv.empty())
    throw InputError(describe("", "", "the mesh has no texture coordinates, which the metric parametric needs",
                              "use --metric quadric"));
  return std::make_unique<ParametricMetric>(rings, mesh);
}

}  // namespace lodestone::progressive
