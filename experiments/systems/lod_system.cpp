#include "experiments/systems/lod_system.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "core/hierarchy/model/distance_metric.h"

namespace lodestone {
namespace {

struct Named {
  LodSystem system;
  std::string_view name;
};
constexpr std::array<Named, 5> names{{{LodSystem::morph, "morph"},
                                      {LodSystem::step, "step"},
                                      {LodSystem::discrete, "discrete"},
                                      {LodSystem::cross_fade, "cross-fade"},
                                      {LodSystem::full, "full"}}};
constexpr std::array<LodSystem, 5> systems{LodSystem::morph, LodSystem::step, LodSystem::discrete,
                                           LodSystem::cross_fade, LodSystem::full};

}  // namespace

LodSystem lod_system(std::string_view name) {
  std::vector<std::string> known;
  for (const Named& named : names) {
    if (named.name == name) return named.system;
    known.emplace_back(named.name);
  }
  throw InputError("unknown LOD system '" + std::string(name) + "'; " + known_names(name, known));
}

std::string_view name_of(LodSystem system) {
  return std::find_if(names.begin(), names.end(), [&](const Named& n) { return n.system == system; })->name;
}

std::span<const LodSystem> all_lod_systems() { return systems; }

Radii without_morph(const Radii& radii) {
  Radii own = radii;
  // Finite, so that differences of bands are 0 and not undefined; an empty band is a step where it ends.
  std::fill(own.band_begin.begin(), own.band_begin.end(), std::numeric_limits<float>::max());
  std::fill(own.band_end.begin(), own.band_end.end(), std::numeric_limits<float>::max());
  own.admissible = false;
  return own;
}

Radii whole_level(const Radii& radii, int level) {
  Radii own = without_morph(radii);
  for (std::size_t l = 0; l < own.select.size(); ++l)
    own.select[l] = static_cast<int>(l) < level ? std::numeric_limits<float>::infinity() : 0;
  return own;
}

CrossFade cross_fade(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, double width) {
  const double d = distance(radii.metric, viewpoint, hierarchy.cells.front().bounds);
  int level = 0;
  while (level < hierarchy.finest() && !(d >= radii.select[static_cast<std::size_t>(level)])) ++level;
  if (level == hierarchy.finest()) return {level, level, 0};
  const double begin = radii.select[static_cast<std::size_t>(level)];
  double end = (1 + width) * begin;
  if (level > 0) end = std::min<double>(end, radii.select[static_cast<std::size_t>(level) - 1]);
  if (d >= end) return {level, level, 0};
  return {level + 1, level, (d - begin) / (end - begin)};
}

}  // namespace lodestone
