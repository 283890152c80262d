#include "render/lod/radii.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/math/round_up.h"

namespace lodestone {
namespace {

void check(const RadiiConfig& config) {
  const auto positive = [](float v) { return v > 0 && std::isfinite(v); };
  if (config.kappa0 && !positive(*config.kappa0)) throw InputError("kappa0 must be a positive number");
  if (!config.kappa0 && config.rule == RadiiRule::uniform)
    throw InputError("the uniform rule needs a kappa0; give one, or use per-level radii with a pixel error");
  if (!positive(config.pixel_error)) throw InputError("the pixel error must be a positive number");
  if (!positive(config.beta)) throw InputError("beta, the minimum width of the morph band, must be a positive number");
  if (config.delta != 0 && !positive(config.delta))
    throw InputError("delta, the guard of a stale selection, must be zero or a positive number");
  if (!(config.vertical_fov > 0 && config.vertical_fov < 3.14159f))
    throw InputError("the vertical field of view must lie between 0 and 180 degrees");
  if (config.image_height < 1 || !positive(config.aspect)) throw InputError("the image must have a positive size");
}

// Least r_l / h_l that keeps an error of e_l h_l below tau pixels anywhere in the image: one pixel of a pinhole camera
// subtends 2 tan(phi/2) / H at the centre, less by cos^2 of the angle towards the corner. A bound for every angle and
// aspect that round to those of the configuration: it grows with the aspect, and its largest values over an interval of
// angles are at the ends, since 1 / t + c t is convex.
float radius_for_pixels(float error_ratio, const RadiiConfig& config) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const double aspect = std::nextafter(config.aspect, infinity);
  const auto radius = [&](double fov) {
    const double half = std::tan(fov / 2);
    const double corner_tan2 = half * half * (1 + aspect * aspect);  // tan^2; 1 / cos^2 = 1 + tan^2
    return double{error_ratio} * config.image_height / (2 * double{config.pixel_error} * half) * (1 + corner_tan2);
  };
  return float_above(std::max(radius(std::nextafter(config.vertical_fov, 0.0f)),
                              radius(std::nextafter(config.vertical_fov, infinity))));
}

}  // namespace

float reach(const Hierarchy& hierarchy, DistanceMetric metric) {
  float rho = 0;
  for (int l = 1; l < hierarchy.finest(); ++l)
    rho = std::max(rho, hierarchy.levels[static_cast<std::size_t>(l)].reach[static_cast<std::size_t>(metric)]);
  return rho;
}

RadiiConfig for_picture(RadiiConfig config, ImageSize size, double vertical_fov) {
  config.image_height = size.height;
  config.aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  config.vertical_fov = static_cast<float>(vertical_fov);
  return config;
}

Radii make_radii(const Hierarchy& hierarchy, const RadiiConfig& config) {
  check(config);
  const auto finest = static_cast<std::size_t>(hierarchy.finest());
  const auto rho = [&](std::size_t l) { return hierarchy.levels[l].reach[static_cast<std::size_t>(config.metric)]; };
  const auto h = [](std::size_t l) { return cell_size(static_cast<int>(l)); };
  // Distances from the viewpoint scale with the metric: a Chebyshev radius of r leaves Euclidean distances of at least
  // r.
  const auto wanted = [&](std::size_t l) {
    return h(l) * (config.kappa0 ? *config.kappa0 : radius_for_pixels(hierarchy.levels[l].error, config));
  };

  Radii radii;
  radii.metric = config.metric;
  radii.select.assign(finest + 1, 0);
  radii.band_begin.assign(finest + 1, 0);
  radii.band_end.assign(finest + 1, std::numeric_limits<float>::infinity());
  radii.admissible = true;

  // Fine to coarse: at level l the band reaches from r_l + rho_l h_l to r_{l-1}. The finest level has no r of its own.
  const float widen = 1 + rounding_guard, narrow = 1 - rounding_guard;
  for (std::size_t l = finest; l >= 1; --l) {
    const bool last = l == finest;
    const float begin = last ? 0 : (radii.select[l] + (rho(l) + config.delta) * h(l)) * widen;
    const float stale = 2 * config.delta * h(l);
    float& coarser = radii.select[l - 1];
    coarser = wanted(l - 1);
    if (config.rule == RadiiRule::per_level)
      coarser = std::max(coarser, ((begin + config.beta * h(l)) / narrow + stale) * widen);
    const float end = (coarser - stale) * narrow;
    radii.band_end[l] = end;
    // At the finest level any begin below the end is valid: as wide as at the other levels, if that fits.
    radii.band_begin[l] =
        last
            ? std::max(0.0f, std::min(end - config.beta * h(l), (coarser / 2 + (rho(l) + config.delta) * h(l)) * widen))
            : begin;
    if (!(radii.band_begin[l] < end)) {  // inadmissible: a step at r_{l-1}
      radii.admissible = false;
      radii.band_begin[l] = radii.band_end[l] = coarser;
    }
  }
  if (finest >= 1) radii.select[finest] = 0;
  radii.band_begin[0] = std::numeric_limits<float>::infinity();
  return radii;
}

}  // namespace lodestone
