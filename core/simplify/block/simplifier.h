// The contract of the per-block simplifiers.
//
// A simplifier gets the mesh of one block and answers with P: for every vertex the vertex that it moves to. The new
// triangles are the images of the old ones under P, degenerate ones dropped; nothing else ever disappears.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

enum class SimplifierKind : std::uint32_t { quadric = 0, cluster = 1, openmesh = 2, meshopt = 3 };
inline constexpr std::array all_simplifier_kinds{SimplifierKind::quadric, SimplifierKind::cluster,
                                                 SimplifierKind::openmesh, SimplifierKind::meshopt};
[[nodiscard]] SimplifierKind simplifier_kind(std::string_view name);  // throws InputError listing the known names
[[nodiscard]] std::string_view name_of(SimplifierKind kind);

struct SimplifyInput {
  std::span<const Vec3f> positions;      // any number of vertices, also ones without triangles
  std::span<const Triangle> triangles;   // into positions, none degenerate
  std::span<const std::uint8_t> locked;  // one per position; non-zero: keeps itself and its position
  float max_displacement = 0;            // bound of (1), in units of the positions; > 0
  std::size_t target_triangles = 0;      // stop at this count; more may remain where the constraints demand it
  // Wedges, where vertices have attributes: of each corner of each triangle, and the vertex of each wedge. Both empty:
  // the vertices have none, or one value each.
  std::span<const Triangle> corners{};
  std::span<const std::uint32_t> wedge_vertex{};
  Lattice lattice = {};  // that the positions stand on, if any
  // For simplifiers that do not know wedges: P keeps the label of a vertex. Empty: all are the same.
  std::span<const std::uint32_t> labels{};
  // Of the vertices that may move this share stays in any case, from 0 (no such limit) to 1: where many are held in
  // place, the others must not make up for them.
  double least_share = 0;
};

// Where to stop, with so many vertices that may move; each that goes takes two triangles with it.
[[nodiscard]] inline std::size_t triangles_to_keep(const SimplifyInput& input, std::size_t movable) {
  const auto going = static_cast<std::size_t>(2 * (1 - input.least_share) * static_cast<double>(movable));
  const std::size_t all = input.triangles.size();
  return std::max(input.target_triangles, all - std::min(all, going));
}

struct SimplifyResult {
  std::vector<std::uint32_t> parent;  // P, fully resolved: parent[parent[v]] == parent[v]
  std::vector<Vec3f> positions;       // one per input vertex; valid where parent[v] == v
  // Of every input vertex from the images, as far as the simplifier knows: never less than the distance from the
  // nearest image near parent[v] (from parent[v] itself where there is none) but for rounding, and close to it where it
  // counts, at the block's largest distances. Empty when the simplifier does not measure.
  std::vector<float> distance;
  // P of each wedge of the input, a wedge of P of its vertex; empty without wedges.
  std::vector<std::uint32_t> wedge_parent;
  std::size_t triangles = 0;  // images that are not degenerate
};

// Guarantees, whatever the input:
//   - P keeps labels;
//   - locked vertices are their own parents and do not move;
//   - survivors stand on the lattice, if there is one;
//   - |positions[parent[v]] - v| <= max_displacement, evaluated in double;
//   - no surviving triangle with a normal is turned by more than 90 degrees by a single step, a manifold neighbourhood
//     stays manifold, borders of the surface stay borders, no chord between two locked vertices is created; clustering
//     alone may turn triangles and pinch;
//   - the result depends on the input alone: same bytes on every machine path and at every call.
// An instance keeps its working memory between calls and serves one thread at a time.
class Simplifier {
 public:
  virtual ~Simplifier() = default;
  // The result stays valid until the next call on the same instance.
  [[nodiscard]] virtual const SimplifyResult& simplify(const SimplifyInput& input) = 0;
  // Whether it takes corners and wedge_vertex, and answers with wedge_parent; otherwise it gets labels.
  [[nodiscard]] virtual bool knows_wedges() const { return false; }
};

// Where survivors stand: on a vertex of the input, or moved once to where their quadric is least.
enum class Placement : std::uint32_t { optimal = 0, endpoint = 1 };
[[nodiscard]] Placement placement(std::string_view name);  // throws InputError listing the known names
[[nodiscard]] std::string_view name_of(Placement placement);
// Of a kind when nothing else is asked for; all but `quadric` know endpoints only.
[[nodiscard]] Placement default_placement(SimplifierKind kind);

}  // namespace lodestone
