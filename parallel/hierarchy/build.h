// Building a hierarchy from a clean mesh: partition, then merge and simplify level by level, fine to coarse.
//
// Three orchestrations of the same kernels, byte-equal for any number of threads: `serial` (one loop), `levels` (a
// parallel loop over the blocks of each level), `graph` (a task per block, an edge from each finer block that made one
// of its cells; no barrier between levels).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/hierarchy/model/hierarchy.h"
#include "core/simplify/contract/simplifier.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

enum class Strategy : std::uint8_t { serial, levels, graph };
[[nodiscard]] Strategy strategy_named(std::string_view name);  // throws InputError listing the known names
[[nodiscard]] std::string_view name_of(Strategy strategy);

inline constexpr std::uint64_t min_refine_limit = 100'000;  // triangles

struct BuildConfig {
  // Displacement bound: d(v, P(v)) <= sigma0 h_l / 2. Dimensionless, in (0, 2]. The default leaves the simplifier about
  // four mean edges at the default cell size.
  float sigma0 = 0.4f;
  std::uint32_t cell_triangles = 1200;  // mean triangles per occupied finest cell that L is chosen for; at least 1
  int finest_level = -1;                // L; -1: from cell_triangles; at most max_level
  // A level keeps half of the triangles of the finer one instead of a quarter, and every other level keeps its cells:
  // fewer triangles draw the same picture, of a file half as large again.
  bool half_levels = false;
  std::string simplifier = "quadric";       // its name (core/simplify/simplifiers.h)
  std::optional<Placement> placement = {};  // of the survivors; empty: the simplifier's default
  Strategy strategy = Strategy::graph;
  // Splits edges of the input longer than sigma0 h_L (core/mesh/refine.h). L is chosen before, so that the limit holds.
  bool refine = false;
  // Splitting may make this many times the input's triangles; always min_refine_limit. Above 0.
  double refine_limit = 10;
  // Puts the vertices and triangles of every cell in an order that compresses well and that caches like.
  bool order_cells = false;
  const CancelFlag* cancel = nullptr;
  // Called now and then, from any thread but one at a time, with the share done in [0, 1].
  std::function<void(double)> progress = {};
};

// Throws InputError when a value is out of its range.
void check_config(const BuildConfig& config);

struct BuildReport {
  std::map<std::string, StageTime> stages;  // partition, hierarchy, and refine and order if asked for
  RefineReport refinement;                  // if asked for
  StageTime total;                          // from the mesh to packed levels
};

// Consumes the mesh (its memory is released as soon as the partition has read it). Throws InputError for a config out
// of range, a mesh without triangles or one that splitting multiplies beyond the limit, Cancelled when config.cancel is
// set.
[[nodiscard]] Hierarchy build_hierarchy(IndexedMesh&& mesh, const BuildConfig& config, Scheduler& scheduler,
                                        BuildReport* report = nullptr);

}  // namespace lodestone
