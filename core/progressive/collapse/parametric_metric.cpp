// The texture deviation of cohen1998: the maximum distance in space between points of equal texture coordinates before
// and after a collapse. Both surfaces are linear between the crossings of their edges on the texture, so the largest
// distance is at a crossing or at the vertex that goes.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/progressive/collapse/collapse_kernel.h"
#include "core/progressive/collapse/texture_fan.h"
#include "core/progressive/collapse/uv_star.h"

namespace lodestone::progressive {
namespace {

struct Corner {
  Vec2f uv;
  Vec3f position;
};

Vec3f between(Vec3f a, Vec3f b, double t) { return to_float((1 - t) * to_double(a) + t * to_double(b)); }

Way way(Vec2f uv) { return {double{uv.x}, double{uv.y}}; }

class ParametricMetric final : public CollapseMetric {
 public:
  ParametricMetric(const RingMesh& rings, const IndexedMesh& mesh, const CollapseKernel& kernel)
      : rings_(&rings), kernel_(&kernel), uv_(mesh.wedges.uv), deviation_(rings.vertex_count(), 0) {}

  void start(std::size_t, std::size_t) override {}

  // The deviation so far and that of the step; a millionth of its length prefers short ones where nothing deviates.
  //
  // Most of the work is to look for crossings, so that they are looked for last: the deviation of the vertex itself is
  // a lower bound, and only neighbours that nothing else rules out go further.
  [[nodiscard]] Cheapest cheapest(Id v, std::uint64_t places,
                                  const std::function<bool(std::uint32_t)>& allowed) const override {
    Fans fans;
    float ranks[max_neighbours];
    const auto collapse = [&](std::uint32_t k) { return Collapse{.vertex = v, .target = rings_->ring(v).ids[k]}; };
    for (std::uint64_t left = places; left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      Collapse c = collapse(k);
      ranks[k] =
          rings_->follows_wedges(c) ? rank_of(c, own_deviation(c, fans)) : std::numeric_limits<float>::infinity();
    }
    for (std::uint64_t whole = 0; places != 0;) {
      const std::uint32_t k = lowest_place({ranks, max_neighbours}, places);
      if (!(ranks[k] < std::numeric_limits<float>::infinity())) break;
      const std::uint64_t bit = std::uint64_t{1} << k;
      if ((whole & bit) != 0) return {k, ranks[k]};
      if (allowed(k)) {
        Collapse c = collapse(k);
        (void)rings_->follows_wedges(c);
        ranks[k] = rank_of(c, step(c, fans));
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
    TextureFan texture;
    Id spoke[TextureFan::max_spokes];  // without initial values, as all of it, for speed
    std::uint8_t first[TextureFan::max_spokes], second[TextureFan::max_spokes];
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
    fill(fan, c.vertex, wedge);
    return fan;
  }

  void fill(Fan& fan, Id vertex, Id wedge) const {
    TextureFan& texture = fan.texture;
    fan.wedge = wedge, fan.from = corner(vertex, wedge), texture.spokes = texture.sectors = 0;
    const Ring& ring = rings_->ring(vertex);
    const auto add = [&](Id neighbour, Id of_neighbour) {  // a spoke that two triangles share counts once
      const Corner end = corner(neighbour, of_neighbour);
      const Way uv = way(end.uv);
      for (const std::uint32_t k : {texture.spokes - 1, 0u})
        if (k < texture.spokes && rings_->position(fan.spoke[k]) == end.position && texture.spoke.u[k] == uv.u &&
            texture.spoke.v[k] == uv.v)
          return k;
      fan.spoke[texture.spokes] = neighbour;
      texture.spoke.set(texture.spokes, uv);
      texture.out.set(texture.spokes, uv - way(fan.from.uv));
      return texture.spokes++;
    };
    for (std::uint32_t k = 0; k < ring.sectors() && ring.size <= max_neighbours; ++k) {
      if (rings_->has_wedges() && ring.wedge(k) != wedge) continue;
      const Id a = ring.ids[k], b = ring.ids[ring.next(k)];
      if (texture.spokes + 2 > max_neighbours) break;
      const std::uint32_t first = add(a, rings_->wedge_of(a, b)), second = add(b, rings_->wedge_of(b, vertex));
      fan.first[texture.sectors] = static_cast<std::uint8_t>(first);
      fan.second[texture.sectors] = static_cast<std::uint8_t>(second);
      texture.first.set(texture.sectors, texture.spoke[first]);
      texture.second.set(texture.sectors, texture.spoke[second]);
      texture.of_vertex[texture.sectors++] = cross(texture.out[first], texture.out[second]);
    }
    texture.finish();
  }

  // The distance in space between the vertex and the point of the new triangles with its texture coordinates.
  [[nodiscard]] float own_deviation(const Fan& fan, const Collapse& c, int chart) const {
    const Corner to = corner(c.target, c.wedge_target[chart]);
    const TextureStep step{way(to.uv), way(fan.from.uv) - way(to.uv)};
    for (std::uint64_t left = kernel_->sectors_near(fan.texture, step); left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      const Way to_a = fan.texture.first[k] - step.to, to_b = fan.texture.second[k] - step.to;
      const double area = cross(to_a, to_b);
      const double w = fan.texture.of_vertex[k] / area, wa = cross(step.back, to_b) / area, wb = 1 - w - wa;
      constexpr double least = -1e-6;
      if (w < least || wa < least || wb < least) continue;
      return length(to_float(w * to_double(to.position) + wa * to_double(rings_->position(fan.spoke[fan.first[k]])) +
                             wb * to_double(rings_->position(fan.spoke[fan.second[k]]))) -
                    fan.from.position);
    }
    // Outside the new triangles, along a seam or border that is not straight on the texture: at most the whole way.
    return length(to.position - fan.from.position);
  }

  // The largest deviation in the chart of one wedge of the vertex: there, or where a new edge crosses an old one.
  [[nodiscard]] float deviation(const Fan& fan, const Collapse& c, int chart) const {
    const Corner to = corner(c.target, c.wedge_target[chart]);
    const TextureStep step{way(to.uv), way(fan.from.uv) - way(to.uv)};
    std::uint64_t crossed[TextureFan::max_spokes];
    kernel_->find_crossings(fan.texture, step, crossed);
    float most = own_deviation(fan, c, chart);
    for (std::uint32_t k = 0; k < fan.texture.spokes; ++k)
      for (std::uint64_t left = crossed[k]; left != 0; left &= left - 1) {
        const auto m = static_cast<std::uint32_t>(std::countr_zero(left));
        const Way edge = fan.texture.spoke[k] - step.to, out = fan.texture.out[m];
        const double det = cross(edge, out), s = cross(step.back, out) / det, t = cross(step.back, edge) / det;
        most = std::max(most, length(between(to.position, rings_->position(fan.spoke[k]), s) -
                                     between(fan.from.position, rings_->position(fan.spoke[m]), t)));
      }
    return most;
  }

  const RingMesh* rings_;
  const CollapseKernel* kernel_;
  std::span<const Vec2f> uv_;
  std::vector<float> deviation_;  // of what has collapsed into a vertex
};

}  // namespace

std::unique_ptr<CollapseMetric> make_parametric_metric(const RingMesh& rings, const IndexedMesh& mesh,
                                                       const CollapseKernel& kernel) {
  if (mesh.wedges.uv.empty())
    throw InputError(describe("", "", "the mesh has no texture coordinates, which the metric parametric needs",
                              "use --metric quadric"));
  return std::make_unique<ParametricMetric>(rings, mesh, kernel);
}

}  // namespace lodestone::progressive
