// Geometry alone: the quadric error of half-edge collapses, by garland1997. The planes of u itself do not count: what u
// has cost so far is paid, and it stays where it is.
#include <algorithm>
#include <cmath>

#include "core/progressive/collapse_metric.h"
#include "core/progressive/star_quadrics.h"

namespace lodestone::progressive {
namespace {

class QuadricMetric final : public CollapseMetric {
 public:
  explicit QuadricMetric(const RingMesh& rings) : rings_(&rings), quadrics_(rings.vertex_count()) {}

  void start(std::size_t begin, std::size_t end) override {
    for (std::size_t v = begin; v < end; ++v) quadrics_[v] = star_quadric(*rings_, static_cast<Id>(v));
  }

  // Undivided sums rank by what is added to the error of the whole mesh, means by the distance alone.
  void rank(Id v, std::span<float> ranks) const override {
    const PlaneQuadric& q = quadrics_[v];
    const Ring& ring = rings_->ring(v);
    const Vec3f centre = rings_->position(v);
    const float stiffness = 1e-6f * q.weight;
    const float scale = 1 / std::max(std::sqrt(q.weight * std::sqrt(q.weight)), 1e-30f);
    for (std::uint32_t k = 0; k < ring.size; ++k) {
      const Vec3f shift = rings_->position(ring.ids[k]) - centre;
      ranks[k] = std::max(q.at(shift) + stiffness * dot(shift, shift), 0.0f) * scale;
    }
  }

  float collapse(const Collapse& c) override {
    PlaneQuadric& target = quadrics_[c.target];
    const PlaneQuadric& gone = quadrics_[c.vertex];
    const Vec3f shift = rings_->position(c.target) - rings_->position(c.vertex);
    const float error = std::sqrt(std::max(gone.at(shift), 0.0f) / std::max(gone.weight, 1e-30f));
    target.add(gone, Vec3f{} - shift);
    return error;
  }

 private:
  const RingMesh* rings_;
  std::vector<PlaneQuadric> quadrics_;
};

}  // namespace

std::unique_ptr<CollapseMetric> make_quadric_metric(const RingMesh& rings) {
  return std::make_unique<QuadricMetric>(rings);
}

}  // namespace lodestone::progressive
