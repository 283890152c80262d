#include "render/lod/radii.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/hierarchy/model/distance_metric.h"
#include "core/hierarchy/model/find_signatures.h"
#include "core/math/round_up.h"

namespace lodestone {
namespace {

void check(const RadiiConfig& config) {
  const auto positive = [](float v) { return v > 0 && std::isfinite(v); };
  if (config.kappa0 && !positive(*config.kappa0)) throw InputError("kappa0 must be a positive number");
  if (!config.kappa0 && config.rule == RadiiRule::uniform)
    throw InputError("the uniform rule needs a kappa0; give one, or use per-level radii with a pixel error");
  if (config.kappa0 && config.rule == RadiiRule::adaptive)
    throw InputError("adaptive radii follow from a pixel error; give one instead of kappa0, or use per-level radii");
  if (!(config.constraint >= 0 && config.constraint <= 1))
    throw InputError("the share of the constraint that adaptive radii keep must lie between 0 and 1");
  if (!positive(config.pixel_error)) throw InputError("the pixel error must be a positive number");
  if (!positive(config.beta)) throw InputError("beta, the minimum width of the morph band, must be a positive number");
  if (config.delta != 0 && !positive(config.delta))
    throw InputError("delta, the guard of a stale selection, must be zero or a positive number");
  if (!(config.vertical_fov > 0 && config.vertical_fov < 3.14159f))
    throw InputError("the vertical field of view must lie between 0 and 180 degrees");
  if (config.image_height < 1 || !positive(config.aspect)) throw InputError("the image must have a positive size");
}

}  // namespace

// One pixel of a pinhole camera subtends 2 tan(phi/2) / H at the centre, less by cos^2 of the angle towards the corner.
// A bound for every angle and aspect that round to those of the configuration: it grows with the aspect, and its
// largest values over an interval of angles are at the ends, since 1 / t + c t is convex.
double radius_over_error(const RadiiConfig& config) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const double aspect = std::nextafter(config.aspect, infinity);
  const auto radius = [&](double fov) {
    const double half = std::tan(fov / 2);
    const double corner_tan2 = half * half * (1 + aspect * aspect);  // tan^2; 1 / cos^2 = 1 + tan^2
    return config.image_height / (2 * double{config.pixel_error} * half) * (1 + corner_tan2);
  };
  return std::max(radius(std::nextafter(config.vertical_fov, 0.0f)),
                  radius(std::nextafter(config.vertical_fov, infinity)));
}

namespace {

// The box rule (docs/decisions/0055), fine to coarse.
class AdaptiveRadii {
 public:
  AdaptiveRadii(const Hierarchy& hierarchy, const RadiiConfig& config, const Signatures& signatures)
      : hierarchy_(hierarchy), config_(config), signatures_(signatures) {}

  std::vector<float> make() {
    want();
    for (int level = hierarchy_.finest(); level >= 1; --level)
      for (std::uint32_t s = signatures_.first(level); s < signatures_.first(level + 1); ++s) raise(level, s);
    std::vector<float> finest(hierarchy_.levels.back().cell_count, std::numeric_limits<float>::infinity());
    if (hierarchy_.finest() >= 1)
      for (std::uint32_t s = signatures_.first(hierarchy_.finest()); s < signatures_.first(hierarchy_.finest() + 1);
           ++s)
        lower(s, finest);
    std::ranges::copy(finest, radius_.begin() + hierarchy_.levels.back().first_cell);
    return std::move(radius_);
  }

 private:
  // The least difference of the radii of a parent and a cell that one signature has.
  [[nodiscard]] double gap(int level, CellId cell, CellId parent) const {
    const double band = (double{config_.beta} + 3 * double{config_.delta}) * hierarchy_.cell_size(level);
    return config_.constraint *
           (norm(config_.metric, overhang(hierarchy_.cells[cell].bounds, hierarchy_.cells[parent].bounds)) + band);
  }

  // The radii that the errors ask for: of a cell itself, and of the triangles around the vertices that it shares with
  // others. Those vertices reach their places of this level at the smallest radius of all cells that use them, while
  // others of these cells are still refined: the smallest serves all of them.
  void want() {
    const double pixels = radius_over_error(config_);
    for (const Cell& cell : hierarchy_.cells) radius_.push_back(float_above(cell.error * pixels));
    std::fill(radius_.begin() + hierarchy_.levels.back().first_cell, radius_.end(), 0.0f);  // nothing is finer
    for (std::uint32_t s = 0; s < signatures_.first(hierarchy_.finest()); ++s)
      for (const CellId cell : signatures_.users(s).cells)
        radius_[cell] = std::max(radius_[cell], float_above(signatures_.error(s) * pixels));
  }

  void raise(int level, std::uint32_t signature) {
    const auto [cells, parents] = signatures_.users(signature);
    for (const CellId parent : parents)
      for (const CellId cell : cells)
        radius_[parent] =
            std::max(radius_[parent], float_above((double{radius_[cell]} + gap(level, cell, parent)) * widen));
  }

  // The finest cells have no radius of their own: the widest bands that the parents leave, from half the way on. Not
  // below 0, or else their vertices would never reach their places, and the surface would be off by more pixels the
  // nearer it is: `raise` has left room for that.
  void lower(std::uint32_t signature, std::span<float> finest) const {
    const auto [cells, parents] = signatures_.users(signature);
    for (const CellId cell : cells)
      for (const CellId parent : parents) {
        const double radius = radius_[parent];
        const double room = std::max(radius / widen - gap(hierarchy_.finest(), cell, parent), 0.0);
        const double most = std::min(radius / 2, room);
        float& own = finest[cell - hierarchy_.levels.back().first_cell];
        own = std::min(own, float_down(most));
      }
  }

  static constexpr double widen = 1 + double{rounding_guard};
  const Hierarchy& hierarchy_;
  const RadiiConfig& config_;
  const Signatures& signatures_;
  std::vector<float> radius_;
};

Radii make_adaptive(const Hierarchy& hierarchy, const RadiiConfig& config,
                    std::shared_ptr<const Signatures> signatures) {
  if (!signatures) signatures = signatures_of(hierarchy);
  Radii radii;
  radii.metric = config.metric;
  radii.by_cell = AdaptiveRadii(hierarchy, config, *signatures).make();
  radii.signatures = std::move(signatures);
  radii.delta = config.delta;
  radii.admissible = config.constraint == 1;
  for (int l = 0; l <= hierarchy.finest(); ++l) {
    const Level& level = hierarchy.levels[static_cast<std::size_t>(l)];
    float largest = 0;
    for (CellId cell = level.first_cell; cell < level.end_cell(); ++cell)
      largest = std::max(largest, radii.by_cell[cell]);
    radii.select.push_back(l == hierarchy.finest() ? 0 : largest);
    radii.band_begin.push_back(largest);
    radii.band_end.push_back(std::nextafter(largest + config.beta * hierarchy.cell_size(l), 0.0f));
  }
  radii.band_begin[0] = radii.band_end[0] = std::numeric_limits<float>::infinity();
  return radii;
}

}  // namespace

Vec3d overhang(const Box3f& inner, const Box3f& outer) {
  const auto beyond = [](double lo, double hi, double outer_lo, double outer_hi) {
    return std::max({outer_lo - lo, hi - outer_hi, 0.0});
  };
  return {beyond(inner.lo.x, inner.hi.x, outer.lo.x, outer.hi.x),
          beyond(inner.lo.y, inner.hi.y, outer.lo.y, outer.hi.y),
          beyond(inner.lo.z, inner.hi.z, outer.lo.z, outer.hi.z)};
}

float greatest_reach(const Hierarchy& hierarchy, DistanceMetric metric) {
  float rho = 0;
  for (int l = 1; l < hierarchy.finest(); ++l)
    rho = std::max(rho, hierarchy.levels[static_cast<std::size_t>(l)].reach[static_cast<std::size_t>(metric)]);
  return rho;
}

std::string_view name_of(RadiiRule rule) {
  constexpr std::string_view names[] = {"per-level", "uniform", "adaptive"};
  return names[static_cast<std::size_t>(rule)];
}

RadiiConfig for_picture(RadiiConfig config, ImageSize size, double vertical_fov) {
  config.image_height = size.height;
  config.aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  config.vertical_fov = static_cast<float>(vertical_fov);
  return config;
}

Radii make_radii(const Hierarchy& hierarchy, const RadiiConfig& config, std::shared_ptr<const Signatures> signatures) {
  check(config);
  if (config.rule == RadiiRule::adaptive) return make_adaptive(hierarchy, config, std::move(signatures));
  const auto finest = static_cast<std::size_t>(hierarchy.finest());
  const auto rho = [&](std::size_t l) { return hierarchy.levels[l].reach[static_cast<std::size_t>(config.metric)]; };
  const auto h = [&](std::size_t l) { return hierarchy.cell_size(static_cast<int>(l)); };
  // Distances from the viewpoint scale with the metric: a Chebyshev radius of r leaves Euclidean distances of at least
  // r.
  const auto wanted = [&](std::size_t l) {
    return h(l) * (config.kappa0 ? *config.kappa0 : float_above(hierarchy.levels[l].error * radius_over_error(config)));
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
