// The map of a closed surface of genus 0 to the unit sphere, on all cores.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/math/vec3.h"
#include "core/spherical/parameterize/sphere_measure.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

enum class InstructionSet;  // core/base/instruction_set.h

enum class SphereEffort : std::uint8_t { fast, normal, best };
[[nodiscard]] SphereEffort sphere_effort(std::string_view name);  // throws InputError listing the known names

struct SphereMapConfig {
  SphereEffort effort = SphereEffort::normal;
  // Weight of the term that keeps triangles from shrinking to nothing on the sphere: more of it gives fewer slivers and
  // more stretch. Greater than 0.
  double guard = 1e-6;
  InstructionSet instructions = {};  // the best one
};

struct SphereMapReport {
  StageTime collapse, map, measure;
  spherical::SphereSums sums;         // over the surface; efficiency, flips and slivers
  std::uint64_t levels = 0;           // after each of which all vertices were moved
  std::uint64_t waves = 0;            // of vertices that came in side by side
  std::uint64_t colours = 0;          // sets of vertices that are moved side by side
  std::uint64_t by_connectivity = 0;  // collapses that no measure of the surface had allowed
  std::uint64_t attempts = 0;         // further ones measure the surface as if all triangles were more alike
};

// A direction for each vertex, a unit vector: every triangle is positively oriented on the sphere, exactly, and the
// triangles cover it once. Coarse to fine over the collapses of a progressive mesh (hoppe1996, praun2003): vertices
// come in inside the kernels of their rings, and all move to where the stretch is smaller, level by level. The result
// depends only on the surface and the configuration, not on threads or instructions.
//
// The surface must be closed, oriented, in one piece, of genus 0 and without doubled edges; positions must be finite,
// and may coincide. Throws InputError that says what it is instead. Memory at the peak: about 600 bytes per vertex.
[[nodiscard]] std::vector<Vec3d> map_to_sphere(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                                               const SphereMapConfig& config, Scheduler& scheduler,
                                               SphereMapReport& report);

}  // namespace lodestone
