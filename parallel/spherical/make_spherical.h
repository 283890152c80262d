// A scan as one mesh over the sphere: seamless octahedral textures, levels that change freely.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/progressive/mesh/progressive_mesh.h"
#include "core/spherical/topology/report.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"
#include "parallel/spherical/map_to_sphere.h"

namespace lodestone {

// The images that a component gets.
struct SphericalMaps {
  bool colour = true;     // and the other images of the materials, as far as these have any
  bool normal = true;     // in object space
  bool geometry = false;  // positions, by a fourth as many samples along a side as the others have pixels, and one
};
// From names separated by commas; throws InputError listing the known ones.
[[nodiscard]] SphericalMaps spherical_maps(std::string_view names);
[[nodiscard]] std::string to_string(const SphericalMaps& maps);

struct SphericalConfig {
  SphereMapConfig map = {};
  spherical::HandleConfig handles;
  std::uint64_t components = 0;  // the largest by area are kept; 0: all
  bool choose_cut = true;        // false: the sphere is cut open as the map left it
  std::uint32_t texture = 1024;  // pixels along the side of the largest component's images; a power of two, at least 16
  SphericalMaps maps = {};
  std::string media_type = "image/webp";
  int quality = 90;                      // of the images (core/texture/image_codec.h)
  std::uint64_t error_points = 200'000;  // on the surface, where images are compared with what they were made from
  ProgressiveConfig progressive{.metric = progressive::MetricKind::parametric};
  // Called with what begins; may throw.
  std::function<void(const std::string& phase)> on_phase = [](const std::string&) {};
};

struct SphericalReport {
  spherical::TopologyReport topology;
  std::uint64_t left_out = 0;  // components of those
  std::uint64_t plain = 0;     // likewise, without images; figures of maps and images are of the others
  SphereMapReport map;    // of all components: times and counts are sums; map.map has all stages of small components
  double efficiency = 0;  // of the map: the mean of the components' by area
  StageTime closing, unfolding, resampling, encoding, collapsing;
  // After the images were encoded and decoded; dB, the mean over components with such images by area. 0 without any.
  double colour_psnr = 0, normal_psnr = 0;
  std::uint64_t pixels = 0;            // of images of colours and normals
  std::uint64_t geometry_samples = 0;  // of geometry images
  std::uint64_t colour_bytes = 0, normal_bytes = 0, geometry_bytes = 0;
  std::uint64_t material_bytes = 0;  // of images of metal, roughness, occlusion and emission
  // Distances between the closed surface and the meshes that decoded geometry images are, the larger of both ways, as
  // shares of the diagonal of the input.
  double geometry_rms = 0, geometry_max = 0;
  std::uint64_t added_vertices = 0;  // where the cut crosses edges
  double cut_length = 0;             // of all components on the surface, in model units
  double cut_exposure = 0;           // the share of the sky that is seen from the cut, its mean by length, 0 to 1
  std::set<std::string> left_out_features;  // of the materials, a line for each (carried_surface.h)
  ProgressiveReport progressive;
};

// The recipe: close holes and handles (core/spherical/topology), map each component to the sphere (map_to_sphere.h),
// unfold it, resample its colours and normals (core/spherical/resample), and make the surface, without what closed it,
// progressive. A component has a material and images of its own; smaller ones have smaller images. Components of less
// than 1/256 of the area, and those that the images would show few triangles of (component_images.h), share one
// material and its images, an atlas no larger than the largest component's images as far as 16 texels for each allow
// (core/spherical/octahedron/square_atlas.h), unless there are geometry images, each of which is that of one component.
// Many components of a few triangles, of which images would show nothing, are not mapped (plain_parts.h).
// The result depends on the mesh and the configuration alone. Throws what these parts throw.
[[nodiscard]] ProgressiveMesh make_spherical(const IndexedMesh& mesh, const SphericalConfig& config,
                                             Scheduler& scheduler, SphericalReport& report);

}  // namespace lodestone
