#include "experiments/metrics/pictures/picture_metric.h"

#include <utility>

#include "core/base/error.h"
#include "core/base/registry.h"

namespace lodestone {
namespace {

Registry<PictureMetric>& metrics() {
  static Registry<PictureMetric> all("metric");
  return all;
}

}  // namespace

void add_picture_metric(const std::string& name, PictureMetric metric) {
  if (!metric.measure) throw InputError("metric '" + name + "' has no function that measures");
  metrics().add(name, std::move(metric));
}

std::vector<std::string> picture_metric_names() { return metrics().names(); }

const PictureMetric& picture_metric(const std::string& name) { return metrics().at(name); }

}  // namespace lodestone
