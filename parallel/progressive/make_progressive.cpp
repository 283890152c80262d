#include "parallel/progressive/make_progressive.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/math/round_up.h"
#include "core/progressive/mesh/activation.h"
#include "core/progressive/mesh/assembly.h"
#include "core/progressive/mesh/level.h"
#include "parallel/clean/prepare.h"
#include "parallel/progressive/level_errors.h"
#include "parallel/progressive/region_collapse.h"
#include "parallel/scheduler/first_touch.h"

namespace lodestone {
namespace {

constexpr std::size_t assembly_grain = 4096;

ProgressiveMesh build(const IndexedMesh& mesh, const ProgressiveConfig& config, Scheduler& scheduler,
                      ProgressiveReport& report) {
  scheduler.name_work("collapse");
  RegionCollapse collapse(mesh, config, scheduler);
  collapse.run();
  progressive::RingMesh& rings = collapse.rings();
  report = {.cut_vertices = rings.cut_vertices(),
            .cut_edges = rings.cut_edges(),
            .input_triangles = mesh.triangles.size(),
            .base_triangles = collapse.triangles_left(),
            .rounds = collapse.rounds()};
  scheduler.name_work("assemble");
  progressive::Assembly assembly(mesh, rings,
                                 {.records = std::move(collapse.records()),
                                  .parents = collapse.take_parents(),
                                  .base_triangles = config.base_triangles});
  assembly.order();
  collapse.free_rings();  // what is made now has their place
  ProgressiveMesh room;
  resize_in_parallel(room.positions, assembly.vertex_count(), scheduler);
  resize_in_parallel(room.parents, assembly.vertex_count(), scheduler);
  resize_in_parallel(room.triangles, mesh.triangles.size(), scheduler);
  assembly.make_room(std::move(room));
  scheduler.for_chunks(assembly.collapse_count(), assembly_grain,
                       [&](ChunkRange c) { assembly.number(c.begin, c.end); });
  scheduler.for_chunks(assembly.vertex_count(), assembly_grain, [&](ChunkRange c) { assembly.gather(c.begin, c.end); });
  assembly.find_groups();
  scheduler.for_chunks(assembly.rings_count(), assembly_grain,
                       [&](ChunkRange c) { assembly.find_ancestors(c.begin, c.end); });
  scheduler.for_chunks(mesh.triangles.size(), assembly_grain,
                       [&](ChunkRange c) { assembly.map_triangles(c.begin, c.end); });
  return assembly.finish();
}

// A bound of how far vertices move that are taken to the model's space and normalised anew: rounded to float32 inside
// the unit cube, and before that four times in double, beside the model's origin.
double moved_by_normalising(const Transform& from, const Transform& to) {
  const Vec3d o = from.origin;
  const double farthest = std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) + from.scale;
  return std::numbers::sqrt3 * (0x1p-25 + 0x1p-50 * (1 + farthest / to.scale));
}

// The surface collapsed to so many triangles, made progressive anew: it is cut apart where it has become nonmanifold by
// then, which a prefix of the collapses is not.
ProgressiveMesh build_fewer(const IndexedMesh& mesh, const ProgressiveConfig& config, Scheduler& scheduler,
                            ProgressiveReport& report) {
  ProgressiveConfig first = config;
  first.base_triangles = std::max<std::size_t>(config.finest_triangles - 1, 1);
  ProgressiveMesh fine = build(mesh, first, scheduler, report);
  fine.wedges.materials = mesh.wedges.materials;
  const LevelFinder levels(fine);
  const double estimate = levels.error_of(fine.base_vertices) * mesh.transform.scale;
  const double left_out = LevelErrors(fine, levels, scheduler).error_of(fine.base_vertices);
  Repairs repairs;
  const IndexedMesh fewer = prepare_mesh(levels.level_mesh(fine.base_vertices), repairs, scheduler);
  ProgressiveReport rest;
  ProgressiveMesh out = build(fewer, config, scheduler, rest);
  report.base_triangles = rest.base_triangles;
  for (float& e : out.errors) e += static_cast<float>(estimate / fewer.transform.scale);
  progressive::sort_by_activation(out);  // flaps come in by errors
  out.finest_error = sum_up(quotient_up(product_up(left_out, mesh.transform.scale), fewer.transform.scale),
                            moved_by_normalising(mesh.transform, fewer.transform));
  report.finest_error = product_up(out.finest_error, fewer.transform.scale);
  return out;
}

ProgressiveMesh build_levels(const IndexedMesh& mesh, const ProgressiveConfig& config, Scheduler& scheduler,
                             ProgressiveReport& report) {
  const bool all = config.finest_triangles == 0 || config.finest_triangles >= mesh.triangles.size();
  return all ? build(mesh, config, scheduler, report) : build_fewer(mesh, config, scheduler, report);
}

}  // namespace

ProgressiveMesh make_progressive(const IndexedMesh& mesh, const ProgressiveConfig& config, Scheduler& scheduler,
                                 ProgressiveReport& report) {
  ProgressiveMesh out = build_levels(mesh, config, scheduler, report);
  out.wedges.materials = mesh.wedges.materials;
  out.wedges.textures = mesh.wedges.textures;
  return out;
}

ProgressiveMesh make_progressive(IndexedMesh&& mesh, const ProgressiveConfig& config, Scheduler& scheduler,
                                 ProgressiveReport& report) {
  IndexedMesh mine = std::move(mesh);
  ProgressiveMesh out = build_levels(mine, config, scheduler, report);
  out.wedges.materials = std::move(mine.wedges.materials);
  out.wedges.textures = std::move(mine.wedges.textures);
  return out;
}

}  // namespace lodestone
