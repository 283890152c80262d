// The hierarchical level of detail, in memory: a table of levels, a table of cells, and views of the cells' payloads.
//
// The payloads are in `storage` (blocks of the builder, or a mapped .lode file); a Hierarchy is cheap to move, and
// copies share it. Notation follows docs/architecture.md: level 0 is the root, level `finest` the input; h_l is the
// side of the cells of level l; P maps the vertices of level l to vertices of level l-1.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/id.h"
#include "core/hierarchy/model/cell_code.h"
#include "core/hierarchy/model/index_view.h"
#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

inline constexpr CellId no_cell{0xffff'ffffu};

// The bound of d(v, P(v)) for vertices of a level in this grid: sigma0 h / 2.
[[nodiscard]] constexpr float displacement_bound(float sigma0, int grid) { return sigma0 * cell_size(grid) * 0.5f; }

// The distance d of selection and morph (core/hierarchy/model/distance_metric.h).
enum class DistanceMetric : std::uint8_t { euclidean = 0, chebyshev = 1 };
inline constexpr int distance_metric_count = 2;

// A unit normal as two 16-bit signed octahedral coordinates (Meyer et al. 2010): 4 bytes, error below 0.004 degrees.
struct PackedNormal {
  std::int16_t u = 0, v = 0;
  friend constexpr bool operator==(const PackedNormal&, const PackedNormal&) = default;
};
[[nodiscard]] PackedNormal pack_normal(Vec3f n);         // n need not be of unit length; zero gives +z
[[nodiscard]] Vec3f unpack_normal(PackedNormal packed);  // of unit length within rounding

// The attributes of vertices besides a normal. `wedges`: several vertices may share a position.
struct AttributeSet {
  bool wedges = false, uv = false, colours = false, materials = false;
  friend bool operator==(const AttributeSet&, const AttributeSet&) = default;
};

// Attributes of the vertices of a cell, one each or none at all.
struct CellAttributes {
  std::span<const Vec2f> uv;
  std::span<const Rgba8> colours;
  std::span<const std::uint32_t> materials;  // as in WedgeAttributes: the same for the corners of a triangle
};

// One cell. Vertex ids in `triangles` and positions in `parents` are local to a cell's payload: triangles index this
// cell's positions, parents[i] is the index of P(vertex i) in the positions of the *parent* cell.
//
// `positions` is V_l(C): the image of every vertex of the triangles of M_L below this cell, also those that only
// degenerate triangles use. A vertex that several cells of the level use has a copy in each, the same bits, and one id
// in `shared_ids`; such vertices come last, shared_ids[k] belonging to positions[positions.size() - shared_ids.size() +
// k]. The id names a vertex through all levels: P keeps it where a vertex survives.
//
// In a hierarchy with attributes every vertex here is a *wedge* (core/mesh/attributes.h): several of them may share a
// position, they have parents that share one, and P keeps each in its chart. A shared id names a wedge, and one that
// only a single cell uses counts as shared when another cell uses another wedge of its position.
struct Cell {
  CellCode code;
  CellId parent = no_cell;        // no_cell: the root
  CellId first_child;             // children are consecutive, in Morton order
  std::uint32_t child_count = 0;  // 0 on the finest level
  Box3f bounds;                   // B(C): box of positions and of the children's B
  float max_displacement = 0;     // max d(v, P(v)) over the vertices of this cell; 0 at the root
  float error = 0;                // distance from M_L, monotone: estimated (docs/decisions/0004), or measured (0011)
  std::span<const Vec3f> positions;
  std::span<const PackedNormal> normals;  // one per position
  CellAttributes attributes;
  Indices parents;  // one per position; empty at level 0
  std::span<const std::uint32_t> shared_ids;
  Triangles triangles;  // never degenerate
  // By shared vertex, while the hierarchy is being built: an estimate of the error of the triangles around it in this
  // cell, at most that of the cell. Empty in files, whose signatures have them, and on the finest level.
  std::span<const float> border_errors;

  [[nodiscard]] CellId end_child() const { return CellId(first_child + child_count); }
  [[nodiscard]] std::uint32_t first_shared() const {
    return static_cast<std::uint32_t>(positions.size() - shared_ids.size());
  }
};

struct Level {
  CellId first_cell;  // the cells of the level are consecutive, in Morton order
  std::uint32_t cell_count = 0;
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;  // copies counted once per cell, as stored
  // rho_l: largest distance from a vertex of a cell to the farthest corner of the cell's bounds, over h_l, rounded up.
  std::array<float, distance_metric_count> reach{};
  float diameter = 0;            // max diam(B(C)) / h_l, Euclidean, rounded up
  float error = 0;               // e_l: max error of the level's cells over h_l, rounded up
  float max_edge = 0;            // longest edge over h_l, rounded up
  std::uint64_t long_edges = 0;  // half-edges longer than sigma0 h_l

  [[nodiscard]] CellId end_cell() const { return CellId(first_cell + cell_count); }
  [[nodiscard]] CellId id_of(CellRank rank) const { return CellId(first_cell + rank); }
  [[nodiscard]] CellRank rank_of(CellId cell) const { return CellRank(cell - first_cell); }
};

struct Provenance {
  std::uint64_t input_vertices = 0, input_triangles = 0;  // after cleaning
  Repairs repairs;
  // Sum modulo 2^64 of triangle_fingerprint over the cleaned input: the same for M_L, whatever the order.
  std::uint64_t fingerprint = 0;
  std::string simplifier = "quadric";  // its name
  std::uint32_t placement = 0;         // Placement of its survivors
  std::uint32_t cell_triangles = 0;    // the target that L followed from; 0 when L was given
  bool measured_errors = false;        // errors are bounds, by measure_errors, not estimates
  bool refined = false;                // M_L has the input's edges beyond sigma0 h_L split (core/mesh/refine.h)
};

// A texture at half its width and height, `halvings` times over, encoded as the texture is.
struct TextureCopy {
  std::uint32_t texture = 0;   // index in Hierarchy::textures
  std::uint32_t halvings = 0;  // at least 1
  std::uint32_t width = 0, height = 0;
  std::vector<char> bytes;
  friend bool operator==(const TextureCopy&, const TextureCopy&) = default;
};

class Signatures;

struct Hierarchy {
  Transform transform;
  float sigma0 = 0;
  LevelGrids grids;
  Provenance provenance;
  std::vector<Level> levels;  // [0] is the root
  std::vector<Cell> cells;    // by level, then Morton code
  std::vector<Material> materials;
  std::vector<Texture> textures;
  // Textures of coarser levels (core/hierarchy/model/level_mesh.h): by texture, then 1, 2, ... halvings.
  std::vector<TextureCopy> texture_copies;
  std::shared_ptr<const void> storage;  // keeps the payloads alive

  // The attributes that the vertices of all cells have.
  AttributeSet attributes;
  // Those of the file, null where it has none (core/hierarchy/model/find_signatures.h finds them then).
  std::shared_ptr<const Signatures> signatures = {};

  [[nodiscard]] int finest() const { return static_cast<int>(levels.size()) - 1; }
  [[nodiscard]] std::span<const Cell> cells_of(int level) const {
    const Level& l = levels[static_cast<std::size_t>(level)];
    return std::span(cells).subspan(l.first_cell, l.cell_count);
  }
  [[nodiscard]] int level_of(CellId cell) const;
  // h_l.
  [[nodiscard]] float cell_size(int level) const { return lodestone::cell_size(grids.of(level)); }
  [[nodiscard]] float displacement_bound(int level) const {
    return lodestone::displacement_bound(sigma0, grids.of(level));
  }
  // The number of times that the distance between vertices has doubled from the finest level to this one.
  [[nodiscard]] int doublings(int level) const { return (finest() - level) / (grids.halves ? 2 : 1); }
};

}  // namespace lodestone
