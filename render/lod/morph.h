// The position of a drawn vertex: n = lambda w + (1 - lambda) P(w), lambda = b_l(d(v_p, w)), or of d'(w) where detail
// limits hold (render/lod/limits.h). With adaptive radii lambda follows from the distances of the boxes that the
// vertex's signature names (docs/decisions/0055), the same for all vertices of a signature.
//
// The one place of this formula on the CPU; the GL shader repeats it operation by operation. lambda is selected, not
// only clamped, so that w and P(w) are reached bit for bit; `P + lambda (w - P)` would crack.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/lod/blend.h"
#include "render/lod/radii.h"

namespace lodestone {

struct MorphContext {
  const Hierarchy* hierarchy = nullptr;
  const Radii* radii = nullptr;
  Blend blend = Blend::smoothstep;
  Vec3f viewpoint;  // normalised model space, one per frame
  DetailLimits limits{};
};

// lambda in [0, 1] of a vertex of a cell.
[[nodiscard]] float vertex_lambda(const MorphContext& context, CellId cell, VertexId vertex);

// By adaptive radii: the lambdas of the signatures of a cell that is not the root, in the order of Signatures::of. The
// first is that of all vertices that no other cell uses; signature_places has those of the shared ones. Without
// signatures it is that of all vertices. `out` is overwritten.
void adaptive_lambdas(const MorphContext& context, CellId cell, std::vector<float>& out);
// The same for many cells of one frame: what several of them share is found once.
class FrameLambdas {
 public:
  // A frame begins; what `context` refers to must stay as it is until the next one.
  void begin(const MorphContext& context);
  // Appends the lambdas of a cell.
  void append(CellId cell, std::vector<float>& out);

 private:
  MorphContext context_;
  std::vector<float> lambdas_, distances_;  // by signature and by cell; below 0 where not found yet
  std::vector<std::uint32_t> found_;
  std::vector<CellId> measured_;
  std::vector<DetailLimit> near_;
};

// By shared vertex of the cell: the place of its lambda there; none without signatures.
[[nodiscard]] std::span<const std::uint8_t> signature_places(const MorphContext& context, CellId cell);

// By distance: lambda in [0, 1] of a vertex at w of the given level; exactly 1 up to a_l, exactly 0 from c_l on.
[[nodiscard]] float morph_lambda(const MorphContext& context, int level, Vec3f w);

// lambda w + (1 - lambda) P(w), and at the ends w and P(w) themselves.
[[nodiscard]] Vec3f blend_positions(float lambda, Vec3f w, Vec3f parent_position);

// By distance: w, P(w) or the blend of the two; `level` is that of w.
[[nodiscard]] Vec3f morph_position(const MorphContext& context, int level, Vec3f w, Vec3f parent_position);

// Drawn positions of all vertices of a cell, in the cell's order. out.size() == cell.positions.size().
void morph_cell(const MorphContext& context, CellId cell, std::span<Vec3f> out);

// The same for normals, morphed by the same lambda and normalised; at lambda 0 and 1 exactly the stored ones.
void morph_cell_normals(const MorphContext& context, CellId cell, std::span<Vec3f> out);

struct MorphedVertex {
  Vec3f position, normal;
};

// Both at once, for one lambda each: the same bits as the two functions above.
void morph_cell_vertices(const MorphContext& context, CellId cell, std::span<MorphedVertex> out);
[[nodiscard]] MorphedVertex morph_vertex(const MorphContext& context, CellId cell, VertexId vertex);

}  // namespace lodestone
