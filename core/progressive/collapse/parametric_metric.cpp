// The deviation on the texture (texture_fan.h): what it is made of, and what has collapsed so far.
#include <algorithm>
#include <memory>

#include "core/base/error.h"
#include "core/progressive/collapse/collapse_metric.h"
#include "core/progressive/collapse/ring_tests.h"
#include "core/progressive/collapse/texture_fan.h"

namespace lodestone::progressive {
namespace {

class ParametricMetric final : public CollapseMetric {
 public:
  ParametricMetric(const RingMesh& rings, const IndexedMesh& mesh)
      : rings_(&rings), mesh_(&mesh), points_(std::make_unique_for_overwrite<TexturePoint[]>(rings.vertex_count())) {}

  void start(std::size_t begin, std::size_t end) override {
    for (std::size_t k = begin; k < end; ++k) {
      const auto id = static_cast<Id>(k);
      const Id source = rings_->source_of(id);
      const Vec3f p = mesh_->positions[source];
      const Vec2f uv = mesh_->wedges.uv[source];
      points_[k] = {p.x, p.y, p.z, uv.x, uv.y, 0, rings_->has_one_wedge(id) ? 0.0f : 1.0f};
    }
  }

  [[nodiscard]] const TexturePoint* texture_points() const override { return points_.get(); }

  float collapse(const Collapse& c, float rank) override {
    const float way = length(rings_->position(c.target) - rings_->position(c.vertex));
    TexturePoint& target = points_[c.target];
    const float error = std::max(rank - stiffness * way, points_[c.vertex].deviation);
    target.deviation = std::max(target.deviation, error);
    return error;
  }

 private:
  const RingMesh* rings_;
  const IndexedMesh* mesh_;
  std::unique_ptr<TexturePoint[]> points_;
};

}  // namespace

std::unique_ptr<CollapseMetric> make_parametric_metric(const RingMesh& rings, const IndexedMesh& mesh) {
  if (mesh.wedges.uv.empty())
    throw InputError(describe("", "", "the mesh has no texture coordinates, which the metric parametric needs",
                              "use --metric quadric"));
  return std::make_unique<ParametricMetric>(rings, mesh);
}

}  // namespace lodestone::progressive
