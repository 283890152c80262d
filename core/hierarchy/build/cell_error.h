// How far a cell is from the finest mesh, both ways: a bound with a proof, and at most a given share too large.
//
// The error of cell C of level l is the larger of
//   forward   the largest distance of a point of M_l(C) from M_L
//   backward  the largest distance of a point of M_L below C from M_l
// over *all* points of the triangles, where M_l counts with the vertices that none of its triangles uses any more: what
// is left of a part of the surface that has collapsed altogether. Both are bounded as follows (after the branch and
// bound of guthe2005, with another bound): the distance from one triangle of the other surface is a convex function, so
// on a piece with straight sides it is largest at a corner. A piece that is within the limit of one triangle everywhere
// is done; of any other piece the part above the triangle nearest to its middle is cut off, and the rest looked at
// again. The largest distance of a middle that has been met is a lower bound, and the limit is that plus the tolerance.
#pragma once

#include <cstdint>
#include <vector>

#include "core/hierarchy/build/level_surface.h"
#include "core/hierarchy/build/neighbourhood.h"
#include "core/spatial/convex_piece.h"

namespace lodestone {

struct CellErrorConfig {
  // The bound may be larger than the largest distance by this share. Above 0; smaller takes longer.
  double tolerance = 0.05;
};

// What it took.
struct CellErrorWork {
  std::uint64_t queries = 0, pieces = 0;
};

// One worker's: keeps its memory from cell to cell.
class CellErrorMeter {
 public:
  explicit CellErrorMeter(const CellErrorConfig& config = {}) : tolerance_(config.tolerance) {}

  // `cell` of level l, counted from the first one, with its surface, against the finest level, of which the cells
  // [first, end) lie below it. Returns the larger of `known` and a bound of the error, which is at most
  // 1 + tolerance times the error, or `negligible`, whichever is larger.
  [[nodiscard]] double measure(const LevelSurface& level, std::uint32_t cell, const LevelSurface& finest,
                               std::uint32_t first, std::uint32_t end, double known, double negligible);
  [[nodiscard]] const CellErrorWork& work() const { return work_; }

 private:
  // A leaf of one of the surfaces that may be farther from the other one than the limit.
  struct Candidate {
    double upper = 0;  // bound of the distance
    LevelSurface::Branch leaf;
    SurfaceItem near;  // of the other surface
    bool backward = false;
  };
  struct Shape {
    ConvexPiece piece;
    std::uint32_t hint = 0;  // in the neighbourhood
    std::uint32_t cuts = 0;  // on top of one another
  };
  [[nodiscard]] const LevelSurface& source(bool backward) const { return backward ? *finest_ : *level_; }
  [[nodiscard]] const LevelSurface& target(bool backward) const { return backward ? *level_ : *finest_; }
  [[nodiscard]] double limit() const;
  void settle(double upper);
  [[nodiscard]] double distance(Vec3d p, bool backward, SurfaceItem& near);
  void walk(const LevelSurface::Branch& branch, bool backward, SurfaceItem& hint);
  void add_leaf(const LevelSurface::Branch& leaf, bool backward, SurfaceItem& hint);
  [[nodiscard]] double farthest_of(const LevelSurface::Branch& leaf, bool backward, SurfaceItem from) const;
  void refine(const Candidate& candidate);
  void refine(std::vector<Shape>&& shapes, const Box3f& box, bool backward);
  [[nodiscard]] bool is_small(const Shape& shape, bool backward);
  void halve(const Shape& shape, bool backward);
  [[nodiscard]] bool work_off(std::vector<Shape>& shapes, bool backward);
  void divide(const Shape& shape, std::vector<Shape>& shapes);
  [[nodiscard]] bool cut_off(const Shape& shape, const LevelSurface::Corners& near, double reach, double margin);

  double tolerance_;
  const LevelSurface* level_ = nullptr;
  const LevelSurface* finest_ = nullptr;
  double known_ = 0, negligible_ = 0;
  double lower_ = 0, settled_ = 0;  // largest distance met; largest bound of what is done
  std::vector<Candidate> heap_;     // the largest bound first
  Neighbourhood near_;
  SurfaceItem hint_;  // found last, of the surface that pieces are measured from
  std::vector<Shape> rest_;
  CellErrorWork work_;
};

}  // namespace lodestone
