// The cost of a collapse: the measures by which a mesh is made progressive.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string_view>

#include "core/math/quadric.h"
#include "core/progressive/collapse/metric_kind.h"
#include "core/progressive/collapse/ring_mesh.h"

namespace lodestone::progressive {

struct CollapseKernel;
struct TexturePoint;

// Calls for different vertices may run side by side where the rings allow collapses side by side (ring_mesh.h).
class CollapseMetric {
 public:
  static constexpr std::uint32_t max_neighbours = 64;  // of a vertex that may collapse

  virtual ~CollapseMetric() = default;
  // Before anything else, for all vertices; may run side by side.
  virtual void start(std::size_t begin, std::size_t end) = 0;
  // The cheapest collapse of v into a neighbour, by its place in the ring; the rank is infinite if there is none.
  struct Cheapest {
    std::uint32_t at = 0;
    float rank = std::numeric_limits<float>::infinity();
  };
  // Bit k of `places` stands for the k-th neighbour; of equal ranks the first counts. `allowed` says whether the
  // surface and the attributes bear a collapse; it is called for as few of them as needed.
  [[nodiscard]] Cheapest cheapest(Id v, std::uint64_t places,
                                  const std::function<bool(std::uint32_t at)>& allowed) const;
  // By vertex, if ranks are made of nothing else (ring_tests.h); otherwise null.
  [[nodiscard]] virtual const CentredQuadric* plane_quadrics() const { return nullptr; }
  // By wedge, if ranks are deviations on the texture (texture_ranks.h); otherwise null.
  [[nodiscard]] virtual const TexturePoint* texture_points() const { return nullptr; }
  // True if attributes bear a collapse that the surface allows.
  [[nodiscard]] virtual bool allows(const Collapse&) const { return true; }
  // Before a collapse of this rank is carried out. Returns its error as a length: an estimate of the distance between
  // the surface around u, or its attributes, and what the input has there.
  virtual float collapse(const Collapse&, float rank) = 0;

 protected:
  // The rank of the collapse of v into each of its neighbours, in the order of its ring, as far as that goes; infinite
  // where it is out of the question, as everywhere for a metric with texture_points(), whose ranks are made of these.
  virtual void rank(Id, std::span<float, max_neighbours> ranks) const {
    std::ranges::fill(ranks, std::numeric_limits<float>::infinity());
  }
};

// The place of the lowest of these values, the first of equal ones; places must not be empty.
[[nodiscard]] inline std::uint32_t lowest_place(std::span<const float> values, std::uint64_t places) {
  auto best = static_cast<std::uint32_t>(std::countr_zero(places));
  for (std::uint64_t left = places & (places - 1); left != 0; left &= left - 1)
    if (const auto k = static_cast<std::uint32_t>(std::countr_zero(left)); values[k] < values[best]) best = k;
  return best;
}

// Throws InputError if the mesh does not have what the metric measures.
[[nodiscard]] std::unique_ptr<CollapseMetric> make_metric(MetricKind kind, const RingMesh& rings,
                                                          const IndexedMesh& mesh, const AttributeWeights& weights,
                                                          const CollapseKernel& kernel);
[[nodiscard]] std::unique_ptr<CollapseMetric> make_quadric_metric(const RingMesh& rings, const CollapseKernel& kernel);
[[nodiscard]] std::unique_ptr<CollapseMetric> make_attribute_metric(const RingMesh& rings, const IndexedMesh& mesh,
                                                                    const AttributeWeights& weights,
                                                                    const CollapseKernel& kernel);
[[nodiscard]] std::unique_ptr<CollapseMetric> make_parametric_metric(const RingMesh& rings, const IndexedMesh& mesh);

}  // namespace lodestone::progressive
