// The octahedral images of the components of a surface: resampled, encoded, and compared with what they show.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "core/progressive/mesh/progressive_mesh.h"
#include "core/spherical/octahedron/square_atlas.h"
#include "core/spherical/surface.h"
#include "parallel/spherical/make_spherical.h"

namespace lodestone {

inline constexpr std::uint32_t least_octahedral_side = 16;  // pixels

struct ComponentImages {
  std::vector<Material> materials;  // one each, but for small components, which share one, and the plain ones
  std::vector<Texture> textures;
  std::vector<std::uint32_t> object_normals;  // by material: a texture or no_texture
  std::vector<GeometryTexture> geometry_images;
  std::vector<std::optional<OctahedralLayout>> octahedral;  // by material
  std::vector<spherical::ImagePlace> places;                // by component; at the end of the plain ones, if any
};

// Components of `mesh`, mapped to the sphere.
struct MappedComponents {
  const IndexedMesh& mesh;
  std::span<const spherical::Surface> surfaces;
  std::span<const std::vector<Vec3d>> directions;
  std::span<const double> shares;   // of the area
  const spherical::Surface& plain;  // further ones, without images (plain_parts.h)
};

// The images that config.maps asks for, with those of colours also the other images that the materials need
// (carried_surface.h); components of one colour have it in their material instead of an image. The largest component's
// have the size of config.texture, others as many pixels per area within a factor of two; without textures to take
// detail from none has more than 4096 pixels for a triangle. Adds times, sizes and errors to the report.
[[nodiscard]] ComponentImages make_component_images(const MappedComponents& components, const SphericalConfig& config,
                                                    Scheduler& scheduler, SphericalReport& report);

}  // namespace lodestone
