// Cracks of a drawn frame, exactly: the residual edges of the drawn chain, and the gaps of the drawn map.
//
// Both look at the whole partition, before culling: make the selection with keep_culled = true (`visible` is ignored).
// No gap means no residual edge. The converse holds but where a vertex alone joins two parts of the surface, or where
// what is torn off has collapsed onto edges that it runs through there and back: only the map form sees these.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/scheduler/scheduler.h"
#include "render/lod/morph.h"
#include "render/lod/selection.h"

namespace lodestone {

struct CrackBasis;  // experiments/metrics/cracks/crack_basis.h
class Screen;       // experiments/metrics/drawn/screen.h

// The basis of a hierarchy, made once before frames are looked at. Linear in the triangles of all levels but for two
// sorts of what borders a leaf. It serves the hierarchy as long as its triangles and shared ids stay the same. Throws
// ResourceError for 2^32 or more copies of shared vertices.
[[nodiscard]] std::shared_ptr<const CrackBasis> make_crack_basis(const Hierarchy& hierarchy, Scheduler& scheduler);

// A directed edge of the drawn boundary that is not expected (multiplicity > 0), or expected and not there (< 0).
struct ResidualEdge {
  Vec3f from, to;  // drawn positions, normalised
  std::int64_t multiplicity = 0;
  CellId cell;  // a drawn cell that contributes to it
};

struct CrackReport {
  std::uint64_t open_edges = 0;       // sum of |multiplicity| of the residual edges; 0: no crack
  std::vector<ResidualEdge> samples;  // some of them
  // Leaves that no drawn cell represents, or more than one: not 0 when the selection is not a partition of M_L. Their
  // unpaired half-edges are expected as often as they are drawn.
  std::uint64_t uncovered_leaves = 0;
};

struct GapReport {
  double gap_max = 0;      // largest distance of two drawn positions of one vertex of M_L, normalised units
  double gap_mean = 0;     // mean over the gaps > 0; 0 without any
  std::uint64_t gaps = 0;  // pairs of leaves that use a vertex in common and draw it at two places
  Vec3f where;             // one of the two positions of the largest gap
  // The gaps > 0 with an end in the picture and none behind the eye, on the screen; 0 without a screen.
  double gap_max_pixels = 0, gap_mean_pixels = 0;
  std::uint64_t gaps_in_view = 0;
  std::uint64_t uncovered_leaves = 0;  // as above; they take part in no gap
};

// Working memory, kept from frame to frame. Its content says nothing to a caller.
struct CrackScratch {
  struct DrawnEdge {
    Vec3f from, to;
    std::int32_t sign = 0;  // 0: its ends coincide
    CellId cell;
  };
  struct HashedEdge {
    std::uint64_t hash = 0;
    std::uint32_t edge = 0;  // in `edges`
  };
  struct Place {
    Vec3f position;
    std::uint64_t copies = 0;
  };
  std::vector<DrawnEdge> edges;
  std::vector<std::size_t> edges_begin;         // one per selected cell
  std::vector<std::uint64_t> hashes;            // one per edge
  std::vector<std::vector<HashedEdge>> hashed;  // by worker
  std::vector<std::vector<Vec3f>> morphed;      // by worker
  std::vector<std::vector<Place>> places;       // by worker
  std::vector<Vec3f> copies;                    // drawn positions of the copies of shared vertices
  std::vector<std::uint8_t> covered;            // by leaf
};

// Chain form. The boundary of the drawn, morphed triangles, welded by their float32 bits (-0 = +0), minus the image of
// the unpaired half-edges of M_L, each followed through the parents to the level of the drawn cell above it and morphed
// there. The result does not depend on the number of workers. The basis is that of context.hierarchy.
[[nodiscard]] CrackReport residual_edges(const MorphContext& context, const Selection& selection,
                                         const CrackBasis& basis, Scheduler& scheduler, CrackScratch& scratch);

// Map form: for every vertex of M_L and every two leaves that use it, the two places where it is drawn; in the pixels
// of `screen`, too, if there is one. Lengths in model units are those here times hierarchy.transform.scale.
[[nodiscard]] GapReport vertex_gaps(const MorphContext& context, const Selection& selection, const CrackBasis& basis,
                                    Scheduler& scheduler, CrackScratch& scratch, const Screen* screen = nullptr);

}  // namespace lodestone
