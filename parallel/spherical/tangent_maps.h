// Normal maps in tangent space beside those in object space, for viewers that know no others.
#pragma once

#include <cstdint>
#include <string>

#include "core/progressive/mesh/progressive_mesh.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct TangentMapConfig {
  std::string media_type = "image/webp";
  int quality = 90;                // of the images (core/texture/image_codec.h)
  std::uint64_t points = 200'000;  // on the surface, where what viewers show is compared with the object-space images
};

struct TangentMapReport {
  StageTime time;
  std::uint64_t bytes = 0, pixels = 0;  // of the images that were added
  // Mean angles, in degrees, between the normals of the object-space images and those that other viewers show at the
  // finest level: as the mesh is now, and by the normals of its vertices alone.
  double angle = 0, plain_angle = 0;
};

// Gives every material with an image of normals in object space a normal map of half the side in tangent space, made
// for the finest level (core/spherical/resample/tangent_normals.h), and vertices the tangents to read it with; unless
// the normals of vertices alone are about as near, as those of a scan without a normal map are: then nothing is added.
// The mesh has normals and coordinates of the octahedral square. Throws what decoding and encoding throw.
void add_tangent_maps(ProgressiveMesh& mesh, const TangentMapConfig& config, Scheduler& scheduler,
                      TangentMapReport& report);

}  // namespace lodestone
