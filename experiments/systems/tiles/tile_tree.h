// An octree of tiles in the way of tilers for 3D Tiles (ogc2022): each tile has the surface in its cube, simplified
// alone to about as many triangles as any other, with open borders. Tiles replace their parent. Nothing makes borders
// of tiles of different levels, or of simplified neighbours, the same: there are cracks, which skirts may cover.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "experiments/systems/surface/part_mesh.h"
#include "experiments/systems/surface/welded_surface.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct TileNode {
  PartMesh mesh;
  Box3f box;         // of it and of the tiles below
  double error = 0;  // largest distance from the surface in the cube, both ways, and at least that of the tiles below
  double gap = 0;    // as far as its border may be from those of its neighbours: twice the error of its parent
  std::uint32_t first_child = 0, child_count = 0;
};

struct TileTreeConfig {
  std::size_t tile_triangles = 4000;  // of tiles with children about so many, of others at most so many
};

// The root comes first. By meshoptimizer. The same for any number of threads.
[[nodiscard]] std::vector<TileNode> build_tile_tree(const WeldedSurface& surface, const TileTreeConfig& config,
                                                    Scheduler& scheduler);

// Ribbons that hang from the border of a tile, against the normals, as deep as its gap; without the parts where the
// surface itself ends. `on_border`: by vertex of the surface.
struct Skirt {
  std::vector<Vec3f> positions;
  std::vector<PackedNormal> normals;
  std::vector<Triangle> triangles;
};
[[nodiscard]] Skirt skirt_of(const TileNode& tile, const WeldedSurface& surface,
                             std::span<const std::uint8_t> on_border);

// By vertex: 1 where the surface ends.
[[nodiscard]] std::vector<std::uint8_t> border_vertices(const WeldedSurface& surface);

// The tiles that are drawn, by number: those that are good enough, or have no children, and whose parents are not. An
// error of 1 is within the tolerance from `reach` on.
[[nodiscard]] std::vector<std::uint32_t> tiles_for(std::span<const TileNode> tiles, Vec3f viewpoint, double reach);

}  // namespace lodestone
