// The errors of the levels of a progressive mesh: how far each is from the input, measured.
//
// The error of a level is a bound of the distance of every point of it from the surface that the mesh was made of, and
// of every point of that surface from it, whatever metric ranked the collapses. Quantization is included. The errors
// by vertex in a file are estimates of the metric, in which this search begins.
#pragma once

#include <cstdint>

#include "core/progressive/mesh/level.h"
#include "parallel/mesh/distance_bound.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Errors here are normalised. Measuring one takes some microseconds per triangle of the finest level.
class LevelErrors {
 public:
  // All three must outlive it. The mesh has a triangle.
  LevelErrors(const ProgressiveMesh& mesh, const LevelFinder& levels, Scheduler& scheduler);

  // At most 5 % larger than the distance from the finest level, plus that level's own error.
  [[nodiscard]] double error_of(std::uint32_t vertices) const;
  // The number of vertices of a level whose error is at most this, close to the coarsest one: no level of 1 % fewer
  // vertices that was tried is as near, in about eight trials. The finest level if none is.
  [[nodiscard]] std::uint32_t vertices_for(double error) const;

 private:
  [[nodiscard]] double bound_of(std::uint32_t vertices, double enough) const;

  const ProgressiveMesh& mesh_;
  const LevelFinder& levels_;
  Scheduler& scheduler_;
  BoundedSurface finest_;
};

}  // namespace lodestone
