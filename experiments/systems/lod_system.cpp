#include "experiments/systems/lod_system.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/base/registry.h"
#include "core/hierarchy/model/distance_metric.h"
#include "experiments/systems/cluster_dag_system.h"
#include "experiments/systems/known_step_system.h"
#include "experiments/systems/progressive_systems.h"
#include "experiments/systems/terrain_systems.h"
#include "experiments/systems/tiles_system.h"

namespace lodestone {
namespace {

std::vector<SystemPart> faded_parts(const SystemQuery& q) {
  const CrossFade fade = cross_fade(q.hierarchy, q.radii, q.viewpoint, q.fade_width);
  if (fade.fine == fade.coarse) return {{whole_level(q.radii, fade.fine), q.blend}};
  return {{whole_level(q.radii, fade.fine), q.blend, 1 - fade.share},
          {whole_level(q.radii, fade.coarse), q.blend, fade.share}};
}

using Parts = std::vector<SystemPart>;

Registry<LodSystem>& systems() {
  static Registry<LodSystem> all = [] {
    Registry<LodSystem> ours("LOD system");
    ours.add("morph", {"cells by distance, vertices morphed",
                       [](const SystemQuery& q) {
                         return Parts{{q.radii, q.blend}};
                       },
                       true});
    ours.add("adaptive", {.description = "the same, each cell by its own error",
                          .parts =
                              [](const SystemQuery& q) {
                                return Parts{{q.radii, q.blend}};
                              },
                          .keeps_promise = true,
                          .radii = RadiiRule::adaptive});
    ours.add("step", {"cells by distance, vertices jump in the middle of the band", [](const SystemQuery& q) {
                        return Parts{{q.radii, Blend::step}};
                      }});
    ours.add("discrete", {"cells by distance, each at its level, no morph", [](const SystemQuery& q) {
                            return Parts{{without_morph(q.radii), q.blend}};
                          }});
    ours.add("cross-fade", {.description = "the whole model at one level, two pictures blended while levels change",
                            .parts = faded_parts,
                            .blends = true,
                            .moves_vertices = false});
    for (const bool measured : {false, true})
      ours.add(measured ? "cluster-dag-measured" : "cluster-dag", cluster_dag_system(measured));
    ours.add("progressive-whole", progressive_whole_system());
    ours.add("vdpm", vdpm_system());
    for (const bool skirts : {false, true})
      ours.add(skirts ? "tiles-replace-skirts" : "tiles-replace", tiles_system(skirts));
    ours.add("chunked-skirts", chunked_system());
    ours.add("clipmap", clipmap_system());
    ours.add("known-step", known_step_system());
    ours.add(std::string(full_system),
             {"the finest level, what the others are measured against", [](const SystemQuery& q) {
                return Parts{{whole_level(q.radii, q.hierarchy.finest()), q.blend}};
              }});
    return ours;
  }();
  return all;
}

}  // namespace

void add_lod_system(const std::string& name, LodSystem system) {
  if (!system.parts == !system.patches)
    throw InputError("LOD system '" + name + "' needs one function that says what it draws: parts, or patches");
  systems().add(name, std::move(system));
}

const LodSystem& lod_system(std::string_view name) { return systems().at(name); }

std::vector<std::string> lod_system_names() { return systems().names(); }

Radii without_morph(const Radii& radii) {
  Radii own = radii;
  // Finite, so that differences of bands are 0 and not undefined; an empty band is a step where it ends.
  std::fill(own.band_begin.begin(), own.band_begin.end(), std::numeric_limits<float>::max());
  std::fill(own.band_end.begin(), own.band_end.end(), std::numeric_limits<float>::max());
  own.signatures = nullptr;
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
