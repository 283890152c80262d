// Geometry alone: the quadric error of half-edge collapses, by garland1997. The planes of the target do not count: its
// cost so far is paid, and it does not move.
#include <algorithm>
#include <cmath>

#include "core/progressive/collapse/collapse_kernel.h"
#include "core/progressive/collapse/ring_tests.h"

namespace lodestone::progressive {
namespace {

class QuadricMetric final : public CollapseMetric {
 public:
  QuadricMetric(const RingMesh& rings, const CollapseKernel& kernel)
      : rings_(&rings),
        kernel_(&kernel),
        quadrics_(std::make_unique_for_overwrite<CentredQuadric[]>(rings.vertex_count())) {}

  void start(std::size_t begin, std::size_t end) override {
    kernel_->star_quadrics(*rings_, begin, end, quadrics_.get());
  }

  [[nodiscard]] const CentredQuadric* plane_quadrics() const override { return quadrics_.get(); }

  void rank(Id v, std::span<float, max_neighbours> ranks) const override {
    const CentredQuadric& q = quadrics_[v];
    const Ring& ring = rings_->ring(v);
    const Vec3f centre = rings_->position(v);
    const float stiff = stiffness * q.weight, scale = rank_scale(q.weight);
    for (std::uint32_t k = 0; k < ring.size; ++k) {
      const Vec3f shift = rings_->position(ring.ids[k]) - centre;
      ranks[k] = std::max(q.at(shift) + stiff * dot(shift, shift), 0.0f) * scale;
    }
  }

  float collapse(const Collapse& c, float) override {
    CentredQuadric& target = quadrics_[c.target];
    const CentredQuadric& gone = quadrics_[c.vertex];
    const Vec3f shift = rings_->position(c.target) - rings_->position(c.vertex);
    const float error = std::sqrt(std::max(gone.at(shift), 0.0f) / std::max(gone.weight, 1e-30f));
    target.add(gone, Vec3f{} - shift);
    return error;
  }

 private:
  const RingMesh* rings_;
  const CollapseKernel* kernel_;
  std::unique_ptr<CentredQuadric[]> quadrics_;
};

}  // namespace

std::unique_ptr<CollapseMetric> make_quadric_metric(const RingMesh& rings, const CollapseKernel& kernel) {
  return std::make_unique<QuadricMetric>(rings, kernel);
}

}  // namespace lodestone::progressive
