// The surface around the seams between views, while it is zipped, filled and tidied.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/vec3.h"
#include "parallel/scheduler/scheduler.h"
#include "render/reconstruct/seams/border_loops.h"
#include "render/reconstruct/seams/edit_mesh.h"
#include "render/reconstruct/seams/model_border.h"

namespace lodestone {

struct SeamMesh {
  std::vector<Vec3f> position, normal;  // per vertex; normals of unit length or zero
  // Frozen: triangles outside of this part use the vertex, too. Not all its triangles are here, so it does not move,
  // and edges between two such vertices are not borders.
  std::vector<std::uint8_t> frozen;
  // Rim: at the outline of what its view sees, not where another view takes over; near the model's border, if known.
  std::vector<std::uint8_t> rim;
  std::vector<std::uint32_t> part;  // of the model: nothing is zipped from one to another
  EditMesh mesh;
  BorderLoops borders;                        // of the mesh, until it is filled
  std::vector<TriangleId> patch_seed;         // of each patch a triangle; EditMesh::none where it has none here
  const ModelBorder* model_border = nullptr;  // null: the model has none, or it is not known

  // A copy of a vertex, or a new one with its part.
  VertexId add_vertex(Vec3f p, Vec3f n, VertexId like);
};

// Normal of a triangle, with its doubled area as length.
[[nodiscard]] inline Vec3f area_vector(const SeamMesh& s, VertexId a, VertexId b, VertexId c) {
  return cross(s.position[b] - s.position[a], s.position[c] - s.position[a]);
}

// Longest edge over the height above it: 1.15 for an equilateral triangle; infinite without area.
[[nodiscard]] float aspect_of(Vec3f a, Vec3f b, Vec3f c);

// For a surface whose border is known: rims are the border vertices within its reach and no others. The seam keeps the
// pointer.
void mark_rims(const ModelBorder& border, SeamMesh& seam, Scheduler& scheduler);

inline constexpr std::size_t any_number = static_cast<std::size_t>(-1);

struct ZipConfig {
  float spacing = 0;                      // of the samples, the unit of the following; > 0
  float reach = 2.5f;                     // maximum radius of a new triangle's circumscribed circle
  float least_cosine = 0.2f;              // between a new triangle and the normals at its corners; above -1
  bool rims = false;                      // also between outlines: the input is closed
  float tile = 48;                        // side of the cubes of space that are tasks, > 4 * reach
  std::size_t most_handles = any_number;  // that the surface may have, including those it has
};
// Adds triangles from border edge to border vertex, roundest first, until nothing fits: of all vertices that an edge
// can see the one that it subtends the largest angle at, which is the Delaunay triangle in the plane. A triangle must
// lie in the gaps of all its corners, contain no vertex, cross no border, and make no handle too many; but for one that
// closes a seam whose sides meet, or would but for a vertex that two views sampled almost in one place. Where the
// border of the model is known no triangle spans what lies beyond it; where it is not, none connects two outlines,
// unless they are seams like others (`rims`). Returns how many were added. Same bytes for any number of workers.
std::size_t zip_seams(SeamMesh& seam, const ZipConfig& config, Scheduler& scheduler);

struct FillConfig {
  float spacing = 0;
  float longest = 48;  // maximum perimeter of a filled hole, in spacings
  bool rims = false;   // also holes that are outlines all round
};
struct FillResult {
  std::size_t filled = 0, triangles = 0;  // holes, and what they took
  double longest = 0;                     // perimeter of what was filled, normalised units
  std::size_t open = 0;                   // holes that are left
  double open_length = 0;                 // their borders, normalised units
};
// Every loop of border edges passes each vertex once: after split_vertices().
FillResult fill_holes(SeamMesh& seam, const FillConfig& config);

struct CrumbConfig {
  std::size_t least = 3;         // triangles of a piece
  std::size_t least_beside = 0;  // where a larger piece is of the same part of the model
  bool rest = false;             // part 0 is many small ones, of which a piece each
};
// Removes pieces that were patches of fewer triangles, all in all, and hang together with nothing else. Returns how
// many triangles went.
std::size_t drop_crumbs(SeamMesh& seam, std::span<const std::uint32_t> patch_triangles, const CrumbConfig& config);

// Border vertices of several fans of triangles become several vertices. Returns how many were added.
std::size_t split_vertices(SeamMesh& seam);

struct TidyConfig {
  float spacing = 0;
  float shortest = 0.5f;    // edges below this are collapsed, in spacings
  float worst_aspect = 20;  // triangles beyond this are flipped or collapsed away where that makes none worse
  int rounds = 4;
};
struct TidyResult {
  std::size_t collapsed = 0, flipped = 0;
};
TidyResult tidy_seams(SeamMesh& seam, const TidyConfig& config, Scheduler& scheduler);

}  // namespace lodestone
