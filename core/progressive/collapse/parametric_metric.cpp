// The texture deviation of cohen1998: the maximum distance in space between points of equal texture coordinates before
// and after a collapse. Both surfaces are linear between the crossings of their edges on the texture, so the largest
// distance is at a crossing or at the vertex that goes.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

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

// From a point of the texture to another, and the cross product of two such vectors.
struct Way {
  double u = 0, v = 0;
};
Way way(const Corner& a, const Corner& b) { return {double{b.uv.x} - a.uv.x, double{b.uv.y} - a.uv.y}; }
double cross(Way a, Way b) { return a.u * b.v - a.v * b.u; }

class ParametricMetric final : public CollapseMetric {
 public:
  ParametricMetric(const RingMesh& rings, const IndexedMesh& mesh)
      : rings_(&rings), uv_(mesh.wedges.uv), deviation_(rings.vertex_count(), 0) {}

  void start(std::size_t, std::size_t) override {}

  // The deviation so far and that of the step; a millionth of its length prefers short ones where nothing deviates.
  //
  // Most of the work is to look for crossings, so that they are looked for last: the deviation of the vertex itself is
  // a lower bound, and only neighbours that nothing else rules out go further.
  [[nodiscard]] Cheapest cheapest(Id v, std::uint64_t places,
                                  const std::function<bool(std::uint32_t)>& allowed) const override {
    Fans fans;
    float ranks[max_neighbours];
    Collapse collapses[max_neighbours];
    for (std::uint64_t left = places; left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      collapses[k] = {.vertex = v, .target = rings_->ring(v).ids[k]};
      ranks[k] = rings_->follows_wedges(collapses[k]) ? rank_of(collapses[k], own_deviation(collapses[k], fans))
                                                      : std::numeric_limits<float>::infinity();
    }
    for (std::uint64_t whole = 0; places != 0;) {
      const std::uint32_t k = lowest_place({ranks, max_neighbours}, places);
      if (!(ranks[k] < std::numeric_limits<float>::infinity())) break;
      const std::uint64_t bit = std::uint64_t{1} << k;
      if ((whole & bit) != 0) return {k, ranks[k]};
      if (allowed(k)) {
        ranks[k] = rank_of(collapses[k], step(collapses[k], fans));
        whole |= bit;
      } else {
        places &= ~bit;
      }
    }
    return {};
  }

  [[nodiscard]] bool allows(const Collapse& c) const override { return !turns_texture(*rings_, uv_, c); }

  float collapse(const Collapse& c) override {
    Fans fans;
    const float error = deviation_[c.vertex] + step(c, fans);
    deviation_[c.target] = std::max(deviation_[c.target], error);
    return error;
  }

 private:
  // Ranks are not found one by one.
  void rank(Id, std::span<float, max_neighbours>) const override {}

  // The surroundings of one wedge of a vertex: the neighbours' corners in its chart, and those of each triangle.
  struct Fan {
    Id wedge = no_id;
    Corner from;
    std::uint32_t spokes = 0, sectors = 0;
    Corner spoke[max_neighbours + 1];
    Way out[max_neighbours + 1];  // from the vertex to its neighbours
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

  [[nodiscard]] float rank_of(const Collapse& c, float deviation) const {
    return deviation_[c.vertex] + deviation + 1e-6f * length(rings_->position(c.target) - rings_->position(c.vertex));
  }

  // The deviation where the vertex was, on both sides of the edge.
  [[nodiscard]] float own_deviation(const Collapse& c, Fans& fans) const {
    float most = own_deviation(fan_of(c, 0, fans), c, 0);
    if (c.wedge[1] != c.wedge[0]) most = std::max(most, own_deviation(fan_of(c, 1, fans), c, 1));
    return most;
  }
  // The largest deviation, on both sides of the edge.
  [[nodiscard]] float step(const Collapse& c, Fans& fans) const {
    float most = deviation(fan_of(c, 0, fans), c, 0);
    if (c.wedge[1] != c.wedge[0]) most = std::max(most, deviation(fan_of(c, 1, fans), c, 1));
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
      fan.out[fan.spokes] = way(fan.from, end);
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

  // The distance in space between the vertex and the point of the new triangles with its texture coordinates.
  [[nodiscard]] float own_deviation(const Fan& fan, const Collapse& c, int chart) const {
    const Corner to = corner(c.target, c.wedge_target[chart]);
    const Way back = way(to, fan.from);
    for (std::uint32_t k = 0; k < fan.sectors; ++k) {
      const Corner &a = fan.spoke[fan.first[k]], &b = fan.spoke[fan.second[k]];
      const Way to_a = way(to, a), to_b = way(to, b);
      const double area = cross(to_a, to_b), of_to = cross(fan.out[fan.first[k]], fan.out[fan.second[k]]);
      const double of_a = cross(back, to_b), size = std::abs(area), sign = area < 0 ? -1 : 1;
      // Far outside, as most are; without a division.
      if (!(sign * of_to >= -2e-6 * size) || !(sign * of_a >= -2e-6 * size) || area == 0) continue;
      const double w = of_to / area, wa = of_a / area, wb = 1 - w - wa;
      constexpr double least = -1e-6;
      if (w < least || wa < least || wb < least) continue;
      return length(to_float(w * to_double(to.position) + wa * to_double(a.position) + wb * to_double(b.position)) -
                    fan.from.position);
    }
    // Outside the new triangles, along a seam or border that is not straight on the texture: at most the whole way.
    return length(to.position - fan.from.position);
  }

  // The largest deviation in the chart of one wedge of the vertex: there, or where a new edge crosses an old one. Edges
  // with an end in common meet there, where nothing deviates.
  [[nodiscard]] float deviation(const Fan& fan, const Collapse& c, int chart) const {
    const Corner to = corner(c.target, c.wedge_target[chart]);
    const Way back = way(to, fan.from);
    double at_old[max_neighbours + 1];
    for (std::uint32_t m = 0; m < fan.spokes; ++m) at_old[m] = cross(back, fan.out[m]);
    float most = own_deviation(fan, c, chart);
    for (std::uint32_t k = 0; k < fan.spokes; ++k) {
      const Way edge = way(to, fan.spoke[k]);
      const double at_new = cross(back, edge);
      for (std::uint32_t m = 0; m < fan.spokes; ++m) {
        const double det = cross(edge, fan.out[m]), sign = det < 0 ? -1 : 1, size = sign * det;
        const double s = sign * at_old[m], t = sign * at_new;
        // One branch instead of six; most do not cross, and nothing is divided.
        const int crosses = int{m != k} & int{size > 0} & int{s >= 0} & int{s <= size} & int{t >= 0} & int{t <= size};
        if (crosses != 0)
          most = std::max(most, length(between(to.position, fan.spoke[k].position, s / size) -
                                       between(fan.from.position, fan.spoke[m].position, t / size)));
      }
    }
    return most;
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
