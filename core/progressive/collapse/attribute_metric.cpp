// Geometry and attributes: hoppe1999's quadric, which takes an attribute as a linear function on each triangle. Centred
// at the vertex and at its values, in 32-bit floats, and per wedge: each chart around a vertex has a quadric of its
// own.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/progressive/collapse/collapse_kernel.h"
#include "core/progressive/collapse/uv_star.h"

namespace lodestone::progressive {
namespace {

// The quadric of one wedge is the sum of w (g d + e - s)^2 for attributes s, with d and s relative to the wedge. A
// CentredQuadric holds the part that does not depend on s, and a Linear per attribute holds the rest.
struct Linear {
  Vec3f gradient;  // sum of w g
  float offset = 0;
};

class AttributeMetric final : public CollapseMetric {
 public:
  AttributeMetric(const RingMesh& rings, const IndexedMesh& mesh, const AttributeWeights& weights,
                  const CollapseKernel& kernel)
      : rings_(&rings), kernel_(&kernel), uv_(mesh.wedges.uv), geometry_(rings.vertex_count()) {
    const WedgeAttributes& wedges = mesh.wedges;
    const bool with_uv = !wedges.uv.empty() && weights.uv > 0;
    const bool with_normal = !wedges.normal.empty() && weights.normal > 0;
    const bool with_colour = !wedges.colour.empty() && weights.colour > 0;
    per_wedge_ = (with_uv ? 2u : 0u) + (with_normal ? 3u : 0u) + (with_colour ? 3u : 0u);
    if (per_wedge_ == 0) return;
    const float uv_scale = with_uv ? static_cast<float>(weights.uv * length_per_uv(mesh)) : 0;
    values_.reserve(rings.vertex_count() * per_wedge_);
    for (Id w = 0; w < rings.vertex_count(); ++w) {
      const Id s = rings.source_of(w);
      const auto add = [&](double value, double weight) { values_.push_back(static_cast<float>(value * weight)); };
      if (with_uv) add(wedges.uv[s].x, uv_scale), add(wedges.uv[s].y, uv_scale);
      if (with_normal)
        for (const float x : {wedges.normal[s].x, wedges.normal[s].y, wedges.normal[s].z}) add(x, weights.normal);
      if (with_colour)
        for (const int x : {wedges.colour[s].r, wedges.colour[s].g, wedges.colour[s].b}) add(x / 255.0, weights.colour);
    }
    planes_.resize(rings.vertex_count());
    linear_.resize(rings.vertex_count() * per_wedge_);
  }

  void start(std::size_t begin, std::size_t end) override {
    kernel_->star_quadrics(*rings_, begin, end, geometry_.data());
    if (per_wedge_ == 0) return;
    for (std::size_t v = begin; v < end; ++v) add_star(static_cast<Id>(v));
  }

  void rank(Id v, std::span<float, max_neighbours> ranks) const override {
    const Ring& ring = rings_->ring(v);
    const CentredQuadric& q = geometry_[v];
    const Vec3f centre = rings_->position(v);
    const float scale = 1 / std::max(std::sqrt(q.weight * std::sqrt(q.weight)), 1e-30f);
    for (std::uint32_t k = 0; k < ring.size; ++k) {
      Collapse c{.vertex = v, .target = ring.ids[k]};
      ranks[k] = std::numeric_limits<float>::infinity();
      if (!rings_->follows_wedges(c)) continue;
      const Vec3f shift = rings_->position(c.target) - centre;
      ranks[k] = (cost(c, shift) + 1e-6f * q.weight * dot(shift, shift)) * scale;
    }
  }

  [[nodiscard]] bool allows(const Collapse& c) const override { return uv_.empty() || !turns_texture(*rings_, uv_, c); }

  float collapse(const Collapse& c, float) override {
    const Vec3f shift = rings_->position(c.target) - rings_->position(c.vertex);
    const float error = std::sqrt(cost(c, shift) / std::max(geometry_[c.vertex].weight, 1e-30f));
    geometry_[c.target].add(geometry_[c.vertex], Vec3f{} - shift);
    if (per_wedge_ > 0) {
      merge(c.wedge[0], c.wedge_target[0], shift);
      if (c.wedge[1] != c.wedge[0]) merge(c.wedge[1], c.wedge_target[1], shift);
    }
    return error;
  }

 private:
  // Length in the model (normalised) over length in the texture, by areas.
  static double length_per_uv(const IndexedMesh& mesh) {
    double model = 0, texture = 0;
    for (const Triangle& t : mesh.triangles) {
      const auto p = [&](int k) { return to_double(mesh.positions[t.v[static_cast<std::size_t>(k)]]); };
      const auto uv = [&](int k) { return mesh.wedges.uv[t.v[static_cast<std::size_t>(k)]]; };
      model += length(cross(p(1) - p(0), p(2) - p(0)));
      texture += std::abs(uv_area(uv(0), uv(1), uv(2)));
    }
    return texture > 0 ? std::sqrt(model / texture) : 0;
  }

  [[nodiscard]] const float* values(Id wedge) const { return values_.data() + std::size_t{wedge} * per_wedge_; }
  [[nodiscard]] Linear* linear(Id wedge) { return linear_.data() + std::size_t{wedge} * per_wedge_; }
  [[nodiscard]] const Linear* linear(Id wedge) const { return linear_.data() + std::size_t{wedge} * per_wedge_; }

  // Adds the gradients of attributes on the triangles around a vertex.
  void add_star(Id v) {
    const Ring& ring = rings_->ring(v);
    const Vec3f centre = rings_->position(v);
    for (std::uint32_t k = 0; k < ring.sectors(); ++k) {
      const Id a = ring.ids[k], b = ring.ids[ring.next(k)], wedge = rings_->has_wedges() ? ring.wedge(k) : v;
      const Vec3f to = rings_->position(a) - centre, on = rings_->position(b) - centre, normal = cross(to, on);
      const float size = dot(normal, normal);
      const float weight = std::sqrt(size) / 2;
      planes_[wedge].weight += weight;
      if (!(size > 0)) continue;
      const Vec3f along = 1 / size * cross(on, normal), across = 1 / size * cross(normal, to);
      const float *s = values(wedge), *sa = values(rings_->wedge_of(a, b)), *sb = values(rings_->wedge_of(b, v));
      for (std::uint32_t i = 0; i < per_wedge_; ++i) {
        const Vec3f gradient = (sa[i] - s[i]) * along + (sb[i] - s[i]) * across;
        planes_[wedge].add_plane(gradient, weight);
        linear(wedge)[i].gradient = linear(wedge)[i].gradient + weight * gradient;
      }
    }
  }

  // The cost of wedge `from` if it moves by `shift` and takes the values of wedge `to`.
  [[nodiscard]] float wedge_cost(Id from, Id to, Vec3f shift) const {
    const float *s = values(from), *t = values(to);
    const Linear* l = linear(from);
    float sum = planes_[from].at(shift), squares = 0;
    for (std::uint32_t i = 0; i < per_wedge_; ++i) {
      const float change = t[i] - s[i];
      sum -= 2 * change * (dot(l[i].gradient, shift) + l[i].offset);
      squares += change * change;
    }
    return sum + planes_[from].weight * squares;
  }

  [[nodiscard]] float cost(const Collapse& c, Vec3f shift) const {
    float sum = std::max(geometry_[c.vertex].at(shift), 0.0f);
    if (per_wedge_ == 0) return sum;
    sum += std::max(wedge_cost(c.wedge[0], c.wedge_target[0], shift), 0.0f);
    if (c.wedge[1] != c.wedge[0]) sum += std::max(wedge_cost(c.wedge[1], c.wedge_target[1], shift), 0.0f);
    return sum;
  }

  // Adds the quadric of a wedge to that of its target, seen from there.
  void merge(Id from, Id to, Vec3f shift) {
    const float *s = values(from), *t = values(to);
    const Linear* l = linear(from);
    Linear* into = linear(to);
    CentredQuadric& plane = planes_[to];
    const float weight = planes_[from].weight;
    plane.add(planes_[from], Vec3f{} - shift);
    for (std::uint32_t i = 0; i < per_wedge_; ++i) {
      const float change = t[i] - s[i], offset = dot(l[i].gradient, shift) + l[i].offset;
      plane.bx -= change * l[i].gradient.x;
      plane.by -= change * l[i].gradient.y;
      plane.bz -= change * l[i].gradient.z;
      plane.c += change * (weight * change - 2 * offset);
      into[i].gradient = into[i].gradient + l[i].gradient;
      into[i].offset += offset - weight * change;
    }
  }

  const RingMesh* rings_;
  const CollapseKernel* kernel_;
  std::span<const Vec2f> uv_;
  std::vector<CentredQuadric> geometry_, planes_;  // by vertex, by wedge
  std::uint32_t per_wedge_ = 0;                    // attributes
  std::vector<float> values_;
  std::vector<Linear> linear_;
};

}  // namespace

std::unique_ptr<CollapseMetric> make_attribute_metric(const RingMesh& rings, const IndexedMesh& mesh,
                                                      const AttributeWeights& weights, const CollapseKernel& kernel) {
  return std::make_unique<AttributeMetric>(rings, mesh, weights, kernel);
}

}  // namespace lodestone::progressive
