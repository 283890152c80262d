#include <string>

#include "core/base/error.h"
#include "core/progressive/collapse/collapse_metric.h"

namespace lodestone::progressive {

CollapseMetric::Cheapest CollapseMetric::cheapest(Id v, std::uint64_t places,
                                                  const std::function<bool(std::uint32_t)>& allowed) const {
  float ranks[max_neighbours];
  rank(v, ranks);
  while (places != 0) {
    const std::uint32_t at = lowest_place(ranks, places);
    if (!(ranks[at] < std::numeric_limits<float>::infinity())) break;
    if (allowed(at)) return {at, ranks[at]};
    places &= ~(std::uint64_t{1} << at);
  }
  return {};
}

MetricKind metric_kind(std::string_view name) {
  for (const MetricKind kind : {MetricKind::quadric, MetricKind::attribute_quadric, MetricKind::parametric})
    if (name == name_of(kind)) return kind;
  throw InputError(describe("", "", "there is no metric '" + std::string(name) + "'",
                            "the metrics are quadric, attribute-quadric and parametric"));
}

std::string_view name_of(MetricKind kind) {
  switch (kind) {
    case MetricKind::attribute_quadric:
      return "attribute-quadric";
    case MetricKind::parametric:
      return "parametric";
    case MetricKind::quadric:
      break;
  }
  return "quadric";
}

std::unique_ptr<CollapseMetric> make_metric(MetricKind kind, const RingMesh& rings, const IndexedMesh& mesh,
                                            const AttributeWeights& weights, const CollapseKernel& kernel) {
  switch (kind) {
    case MetricKind::attribute_quadric:
      return make_attribute_metric(rings, mesh, weights, kernel);
    case MetricKind::parametric:
      return make_parametric_metric(rings, mesh);
    case MetricKind::quadric:
      break;
  }
  return make_quadric_metric(rings, kernel);
}

}  // namespace lodestone::progressive
