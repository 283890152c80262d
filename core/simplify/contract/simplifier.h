// The contract of the per-block simplifiers.
//
// A simplifier gets the mesh of one block and returns P: for every vertex the vertex that it moves to. The new
// triangles are the images of the old ones under P, degenerate ones dropped; nothing else ever disappears.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/math/vec3.h"
#include "core/mesh/indexed_mesh.h"

namespace lodestone {

struct SimplifyInput {
  std::span<const Vec3f> positions;      // any number of vertices, also without triangles
  std::span<const Triangle> triangles;   // into positions, none degenerate
  std::span<const std::uint8_t> locked;  // one per position; non-zero: keeps itself and its position
  float max_displacement = 0;            // bound of (1), in units of the positions; > 0
  std::size_t target_triangles = 0;      // stop at this count; more may remain where the constraints demand it
  // If vertices have attributes, the wedge of each corner of each triangle, and the vertex of each wedge. Both are
  // empty if the vertices have no attributes, or one value each.
  std::span<const Triangle> corners{};
  std::span<const std::uint32_t> wedge_vertex{};
  Lattice lattice = {};  // of the positions, if they lie on one
  // For simplifiers that do not know wedges: P keeps the label of a vertex. Empty if all are the same.
  std::span<const std::uint32_t> labels{};
  // Share of the movable vertices that is kept in any case, from 0 (no such limit) to 1: if many vertices are held in
  // place, the others must not make up for them.
  double least_share = 0;
};

// The number of triangles to stop at, given the number of movable vertices; each that goes takes two triangles along.
[[nodiscard]] inline std::size_t triangles_to_keep(const SimplifyInput& input, std::size_t movable) {
  const auto going = static_cast<std::size_t>(2 * (1 - input.least_share) * static_cast<double>(movable));
  const std::size_t all = input.triangles.size();
  return std::max(input.target_triangles, all - std::min(all, going));
}

struct SimplifyResult {
  std::vector<std::uint32_t> parent;  // P, fully resolved: parent[parent[v]] == parent[v]
  std::vector<Vec3f> positions;       // one per input vertex; valid where parent[v] == v
  // Distance of every input vertex from the simplified surface: never less, but for rounding, than the distance from
  // the nearest image near parent[v] (from parent[v] itself if there is none), and close to it where it counts, at the
  // block's largest distances. Empty if the simplifier does not measure.
  std::vector<float> distance;
  // P of each wedge of the input: a wedge of P of its vertex. Empty without wedges.
  std::vector<std::uint32_t> wedge_parent;
  std::size_t triangles = 0;  // images that are not degenerate
};

// Guarantees, whatever the input:
//   - P keeps labels;
//   - locked vertices are their own parents and do not move;
//   - survivors lie on the lattice, if there is one;
//   - |positions[parent[v]] - v| <= max_displacement, evaluated in double;
//   - no surviving triangle with a normal is turned by more than 90 degrees by a single step, a manifold neighbourhood
//     remains manifold, borders of the surface remain borders, no chord between locked vertices is created; clustering
//     alone may turn triangles and pinch;
//   - the result depends on the input alone: same bytes on every machine path and at every call.
// An instance keeps its working memory between calls and serves one thread at a time.
class Simplifier {
 public:
  virtual ~Simplifier() = default;
  // The result is valid until the next call on the same instance.
  [[nodiscard]] virtual const SimplifyResult& simplify(const SimplifyInput& input) = 0;
  // True if it accepts corners and wedge_vertex, and fills wedge_parent; otherwise it gets labels.
  [[nodiscard]] virtual bool knows_wedges() const { return false; }
};

// The positions of survivors: those of the input, or moved once to the minimum of their quadric.
enum class Placement : std::uint32_t { optimal = 0, endpoint = 1 };
[[nodiscard]] Placement placement_named(std::string_view name);  // throws InputError listing the known names
[[nodiscard]] std::string_view name_of(Placement placement);

}  // namespace lodestone
