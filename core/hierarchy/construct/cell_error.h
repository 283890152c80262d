// Distance of a cell from the finest mesh, both ways: a proven bound, at most a given share too large.
//
// The error of cell C of level l is the larger of
//   forward   the largest distance of a point of M_l(C) from M_L
//   backward  the largest distance of a point of M_L below C from M_l
// over *all* points of the triangles, where M_l includes the vertices that none of its triangles uses any more: the
// remains of a part of the surface that has collapsed altogether. Both are bounded as follows (after the branch and
// bound of guthe2005, with another bound): the distance from one triangle of the other surface is a convex function, so
// on a piece with straight sides it is largest at a corner. A piece that lies within the limit of one triangle is done;
// of any other piece the part above the triangle nearest to its middle is cut off, and the rest is examined again. The
// largest distance of a middle so far is a lower bound, and the limit is that plus the tolerance.
//
// On needles, where hundreds of triangles lie side by side within the error, that may take any number of pieces. After
// a number of tests that is in proportion to the triangles the rest gets the bounds that it has: the result is still a
// bound, but may exceed the distance by more than the tolerance, and says by how much.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "core/hierarchy/construct/level_surface.h"

namespace lodestone {

// Added to a bound in the unit cube, it covers the rounding of the distances that the bound was computed from. A point
// found on a triangle, or cut from an edge, is off by at most sqrt(3) 6 2^-53; a piece results from at most 64 cuts,
// one after the other, and its distance adds 3.5 2^-53 of itself: 1e-13 together (tests/stability/test_rounding.cpp).
inline constexpr double distance_rounding = 1e-12;

struct CellErrorConfig {
  // The bound may be larger than the largest distance by this share. Above 0; smaller takes longer.
  double tolerance = 0.05;
};

struct CellErrorWork {
  std::uint64_t queries = 0, pieces = 0, tests = 0;
};

struct CellError {
  double bound = 0;      // at least the error
  double found = 0;      // a distance that occurs: at most the error; without `known`
  bool complete = true;  // false: the tests ran out
};

// `cell` of level l, with its surface, against the finest level, of which the cells [first, end) lie below it.
struct CellErrorQuery {
  const LevelSurface& level;
  CellRank cell;
  const LevelSurface& finest;
  CellRank first, end;
  double known = 0;       // a lower bound of the result
  double negligible = 0;  // distances below this need not be told apart
  // Distances between a point and an item that refinement may compute, beside those of a first pass; some 20 ns each.
  // 0: as many as it takes.
  std::uint64_t tests = 0;
  std::function<double()> largest = {};  // an upper bound of the error, asked for when the tests run out; empty: none
};

// Belongs to one worker: keeps its memory from cell to cell.
class CellErrorMeter {
 public:
  explicit CellErrorMeter(const CellErrorConfig& config = {});
  ~CellErrorMeter();
  CellErrorMeter(CellErrorMeter&&) noexcept;

  // The bound is the larger of `known` and one of the error, which is at most the larger of 1 + tolerance times the
  // error and `negligible`, unless tests ran out.
  [[nodiscard]] CellError measure(const CellErrorQuery& query);
  [[nodiscard]] const CellErrorWork& work() const;

 private:
  class Measurement;
  std::unique_ptr<Measurement> measurement_;
};

}  // namespace lodestone
