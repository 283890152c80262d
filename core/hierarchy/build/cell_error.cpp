#include "core/hierarchy/build/cell_error.h"

#include <algorithm>
#include <cmath>

namespace lodestone {
namespace {

constexpr std::uint32_t handy_corners = 8;  // of a piece; others are cut into triangles
constexpr std::uint32_t most_cuts = 64;     // of one piece on top of another; then its bound stands as it is
// Items that are gathered around a piece or several; with more of them pieces are taken one by one, or halved.
constexpr std::size_t most_near_one = 48, most_near_several = 24;
// A cut that takes less than this share of the piece is none: the piece is halved instead, so that pieces shrink.
constexpr double least_cut = 1.0 / 16;
// Beyond a corner of the triangle a margin is exceeded, the more the sharper the corner; without one nothing is.
constexpr double margins[] = {0.9, 0.5, 0};
// Of a limit, how high a piece may stand above a triangle and still be cut along its sides.
constexpr double cut_height = 0.95;

// Largest distance of a point of the piece from the triangle: at a corner, since the distance is convex.
double farthest(const ConvexPiece& piece, const LevelSurface::Corners& t) {
  double squared = 0;
  for (std::uint32_t i = 0; i < piece.count; ++i)
    squared = std::max(squared, nearest_on_triangle(piece.corner[i], t[0], t[1], t[2]).squared_distance);
  return std::sqrt(squared);
}

double radius_of(const ConvexPiece& piece, Vec3d centre) {
  double squared = 0;
  for (std::uint32_t i = 0; i < piece.count; ++i) squared = std::max(squared, squared_length(piece.corner[i] - centre));
  return std::sqrt(squared);
}

ConvexPiece piece_of(const LevelSurface::Corners& t) {
  ConvexPiece piece;
  for (const Vec3d p : t) piece.add(p);
  return piece;
}

constexpr auto by_bound = [](const auto& a, const auto& b) { return a.upper < b.upper; };

Box3f box_of(const ConvexPiece& piece) {
  Box3f box;
  for (std::uint32_t i = 0; i < piece.count; ++i) box.extend(to_float(piece.corner[i]));
  return box;
}

}  // namespace

double CellErrorMeter::limit() const { return std::max({known_, negligible_, (1 + tolerance_) * lower_}); }

void CellErrorMeter::settle(double upper) { settled_ = std::max(settled_, upper); }

// Of a point of one surface from the other: a distance that occurs.
double CellErrorMeter::distance(Vec3d p, bool backward, SurfaceItem& near) {
  ++work_.queries;
  const LevelSurface::Nearest nearest = target(backward).nearest(p, near);
  near = nearest.item;
  const double distance = std::sqrt(nearest.squared_distance);
  lower_ = std::max(lower_, distance);
  return distance;
}

// Branches that are done as a whole are those within a ball; most are smaller than the error on coarse levels.
void CellErrorMeter::walk(const LevelSurface::Branch& branch, bool backward, SurfaceItem& hint) {
  const Vec3d lo = to_double(branch.box.lo), hi = to_double(branch.box.hi);
  const double radius = 0.5 * length(hi - lo);
  if (radius <= limit()) {
    ++work_.queries;
    const double enough = limit() - radius;
    const LevelSurface::Nearest nearest = target(backward).nearest(0.5 * (lo + hi), hint, enough * enough);
    hint = nearest.item;
    const double upper = std::sqrt(nearest.squared_distance) + radius;
    if (upper <= limit()) return settle(upper);
  }
  if (LevelSurface::is_leaf(branch)) return add_leaf(branch, backward, hint);
  for (const LevelSurface::Branch& half : source(backward).halves(branch)) walk(half, backward, hint);
}

// One query for a leaf at most: what is nearest to one triangle is mostly near the others.
void CellErrorMeter::add_leaf(const LevelSurface::Branch& leaf, bool backward, SurfaceItem& hint) {
  double upper = hint.cell == no_cell ? HUGE_VAL : farthest_of(leaf, backward, hint);
  if (upper > limit()) {
    bool asked = false;
    source(backward).for_each_triangle(leaf, [&](SurfaceItem item) {
      if (!asked) (void)distance(piece_of(source(backward).corners(item)).centre(), backward, hint);
      asked = true;
    });
    if (!asked) return;  // points alone
    upper = farthest_of(leaf, backward, hint);
  }
  if (upper <= limit()) return settle(upper);
  heap_.push_back({upper, leaf, hint, backward});
  std::push_heap(heap_.begin(), heap_.end(), by_bound);
}

// Largest distance of the leaf's triangles from one of the other surface.
double CellErrorMeter::farthest_of(const LevelSurface::Branch& leaf, bool backward, SurfaceItem from) const {
  const LevelSurface::Corners near = target(backward).corners(from);
  double upper = 0;
  source(backward).for_each_triangle(leaf, [&](SurfaceItem item) {
    upper = std::max(upper, farthest(piece_of(source(backward).corners(item)), near));
  });
  return upper;
}

// Those triangles of the leaf that are not done yet.
void CellErrorMeter::refine(const Candidate& candidate) {
  const bool backward = candidate.backward;
  const LevelSurface::Corners near = target(backward).corners(candidate.near);
  std::vector<Shape> shapes;
  hint_ = candidate.near;
  source(backward).for_each_triangle(candidate.leaf, [&](SurfaceItem item) {
    const ConvexPiece piece = piece_of(source(backward).corners(item));
    const double upper = farthest(piece, near);
    if (upper <= limit()) return settle(upper);
    shapes.push_back({piece, 0, 0});
  });
  if (!shapes.empty()) refine(std::move(shapes), candidate.leaf.box, backward);
}

// Together where that is possible: they have most of their neighbourhood in common.
void CellErrorMeter::refine(std::vector<Shape>&& shapes, const Box3f& box, bool backward) {
  const bool single = shapes.size() == 1;
  if (single && is_small(shapes.front(), backward)) return;
  const bool gathered = near_.gather(target(backward), box, limit(), single ? most_near_one : most_near_several);
  if (gathered && work_off(shapes, backward)) return;
  if (!gathered && single) return halve(shapes.front(), backward);
  for (const Shape& shape : shapes) refine({{shape.piece, 0, shape.cuts}}, box_of(shape.piece), backward);
}

// Whether the piece is done by its middle alone: on coarse levels pieces are, long before few items are around them.
bool CellErrorMeter::is_small(const Shape& shape, bool backward) {
  const Vec3d centre = shape.piece.centre();
  const double radius = radius_of(shape.piece, centre), enough = limit() - radius;
  if (!(enough > 0)) return false;
  ++work_.queries;
  const LevelSurface::Nearest nearest = target(backward).nearest(centre, hint_, enough * enough);
  hint_ = nearest.item;
  const double upper = std::sqrt(nearest.squared_distance) + radius;
  if (upper > limit()) return false;
  settle(upper);
  return true;
}

void CellErrorMeter::halve(const Shape& shape, bool backward) {
  ++work_.pieces;
  if (shape.cuts >= most_cuts) {
    const Vec3d centre = shape.piece.centre();
    SurfaceItem near;
    return settle(distance(centre, backward, near) + radius_of(shape.piece, centre));
  }
  const CutPiece halves = halved(shape.piece);
  for (const ConvexPiece& half : {halves.inside, halves.outside})
    if (half.count > 0) refine({{half, 0, shape.cuts + 1}}, box_of(half), backward);
}

// False when a distance is beyond what the neighbourhood is good for: the rest of the shapes needs a larger one.
bool CellErrorMeter::work_off(std::vector<Shape>& shapes, bool backward) {
  while (!shapes.empty()) {
    const Shape shape = shapes.back();
    if (shape.piece.count > handy_corners) {
      shapes.pop_back();
      for (std::uint32_t i = 2; i < shape.piece.count; ++i)
        shapes.push_back({piece_of({shape.piece.corner[0], shape.piece.corner[i - 1], shape.piece.corner[i]}),
                          shape.hint, shape.cuts});
      continue;
    }
    ++work_.pieces;
    const Vec3d centre = shape.piece.centre();
    const Neighbourhood::Nearest nearest = near_.nearest(centre, shape.hint);
    if (nearest.distance > near_.reach()) {
      SurfaceItem item = near_.item(nearest.number);
      (void)distance(centre, backward, item);
      return false;
    }
    shapes.pop_back();
    lower_ = std::max(lower_, nearest.distance);
    double upper = nearest.distance + radius_of(shape.piece, centre);
    if (upper > limit()) upper = std::min(upper, farthest(shape.piece, near_.corners(nearest.number)));
    if (upper <= limit() || shape.cuts >= most_cuts) {
      settle(upper);
    } else {
      divide({shape.piece, nearest.number, shape.cuts + 1}, shapes);
    }
  }
  return true;
}

void CellErrorMeter::divide(const Shape& shape, std::vector<Shape>& shapes) {
  const double reach = limit();
  const LevelSurface::Corners& t = near_.corners(shape.hint);
  const Vec3d normal = cross(t[1] - t[0], t[2] - t[0]);
  const double scale = length(normal);
  double height = 0;
  for (std::uint32_t i = 0; i < shape.piece.count; ++i)
    height = std::max(height, std::abs(dot(normal, shape.piece.corner[i] - t[0])));
  const bool low = scale > 0 && height <= cut_height * reach * scale;
  const double beside = low ? std::sqrt(reach * reach - (height / scale) * (height / scale)) : 0;
  for (const double share : margins)
    if (low && cut_off(shape, t, reach, share * beside)) {
      shapes.insert(shapes.end(), rest_.begin(), rest_.end());
      return;
    }
  const CutPiece halves = halved(shape.piece);
  for (const ConvexPiece& half : {halves.inside, halves.outside})
    if (half.count > 0) shapes.push_back({half, shape.hint, shape.cuts});
}

// Cuts off the part of the piece above the triangle and up to `margin` beyond its sides. The rest goes to rest_. False
// when that part is less than a share of the piece, or goes beyond `reach`.
bool CellErrorMeter::cut_off(const Shape& shape, const LevelSurface::Corners& near, double reach, double margin) {
  const Vec3d normal = cross(near[1] - near[0], near[2] - near[0]);
  rest_.clear();
  ConvexPiece inside = shape.piece;
  for (std::size_t k = 0; k < 3 && inside.count > 0; ++k) {
    const Vec3d inwards = cross(normal, near[(k + 1) % 3] - near[k]);
    const CutPiece parts = cut(inside, {inwards, near[k], -margin * length(inwards)});
    if (parts.outside.count > 0) rest_.push_back({parts.outside, shape.hint, shape.cuts});
    inside = parts.inside;
  }
  if (inside.count == 0 || inside.area() < least_cut * shape.piece.area()) return false;
  const double upper = farthest(inside, near);
  if (upper > reach) return false;
  settle(upper);
  return true;
}

double CellErrorMeter::measure(const LevelSurface& level, std::uint32_t cell, const LevelSurface& finest,
                               std::uint32_t first, std::uint32_t end, double known, double negligible) {
  level_ = &level;
  finest_ = &finest;
  known_ = known;
  negligible_ = negligible;
  lower_ = settled_ = 0;
  heap_.clear();
  SurfaceItem hint;
  walk(level.cell_branch(cell), false, hint);
  hint = {};
  for (std::uint32_t c = first; c < end; ++c) walk(finest.cell_branch(c), true, hint);
  while (!heap_.empty() && heap_.front().upper > limit()) {
    std::pop_heap(heap_.begin(), heap_.end(), by_bound);
    const Candidate top = heap_.back();
    heap_.pop_back();
    refine(top);
  }
  if (!heap_.empty()) settle(heap_.front().upper);
  return std::max(known, settled_);
}

}  // namespace lodestone
