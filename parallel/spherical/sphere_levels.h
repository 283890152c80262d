// The way back from the tetrahedron to the surface, on the sphere, level by level.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/math/lanes/double4.h"
#include "core/spherical/parameterize/sphere_kernel.h"
#include "core/spherical/parameterize/split_schedule.h"
#include "core/spherical/parameterize/vertex_placement.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct SphereLevelsConfig {
  int sweeps = 12;           // over all vertices, at every level; more at coarse ones
  double guard = 1e-6;       // its weight, as SphereMapConfig
  double least_area = 1e-4;  // as SphereState, in mean areas of a triangle
  // Sweeps over the rings of the vertices that have just come in; not needed unless many come in at one place.
  int ring_sweeps = 0;
  InstructionSet instructions = InstructionSet::best;
};

class SphereLevels {
 public:
  // `surface` in the numbers of the rings, scaled to the area 4 pi. All but the configuration must outlive it.
  SphereLevels(progressive::RingMesh& rings, std::span<const AlignedPoint4d> surface, const SphereLevelsConfig& config,
               Scheduler& scheduler);

  // False if a vertex found no place: the map ends there.
  [[nodiscard]] bool run(const spherical::SplitSchedule& schedule, std::span<const progressive::Id> base);
  [[nodiscard]] std::span<const AlignedPoint4d> directions() const { return directions_; }
  [[nodiscard]] std::size_t colours() const { return colour_count_; }

 private:
  using Id = progressive::Id;

  template <class Body>
  void in_chunks(std::size_t count, std::size_t grain, const Body& body);
  void for_phases(std::span<const std::size_t> ends, const std::function<void(std::size_t)>& body);
  void split(const spherical::SplitSchedule& schedule, std::size_t level);
  void split_chunk(std::span<const spherical::VertexSplit> chunk, progressive::RingArena& arena);
  void relax_rings(std::span<const spherical::VertexSplit> wave);
  [[nodiscard]] int sweeps_at(std::size_t vertices) const;
  void list_vertices(std::size_t count);
  void build_tiles();
  void build_borders(std::span<const std::vector<std::vector<Id>>> borders);
  void sweep(int times);

  progressive::RingMesh& rings_;
  const SphereLevelsConfig config_;
  Scheduler& scheduler_;
  const spherical::SphereKernel& kernel_;
  std::vector<AlignedPoint4d> directions_;
  spherical::SphereState state_;
  std::vector<std::uint8_t> colours_;
  std::size_t colour_count_ = 0, tiles_ = 0;
  std::vector<Id> vertices_;                   // that are there, in order
  std::vector<std::uint32_t> rank_;            // by vertex: its place among them
  std::vector<spherical::SweepBlock> blocks_;  // by tile and colour
  std::vector<spherical::SweepBlock> border_blocks_;
  std::vector<std::size_t> first_border_;       // by colour; and the end
  std::vector<progressive::RingArena> arenas_;  // by worker
  std::atomic<bool> failed_{false};             // a vertex found no place
  bool alone_ = true;                           // one worker does the level
};

}  // namespace lodestone
