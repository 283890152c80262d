#include "core/hierarchy/construct/cell_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/hierarchy/construct/convex_piece.h"
#include "core/hierarchy/construct/neighbourhood.h"

namespace lodestone {
namespace {

constexpr std::uint32_t max_piece_corners = 8;  // of a piece; larger ones are cut into triangles
constexpr std::uint32_t most_walked = 256;      // items tested for a branch or leaf; then refinement decides
constexpr int attempts = 5;                     // tolerances tried
constexpr double coarser = 5;                   // from one of them to the next, beginning at 1
constexpr std::uint32_t max_cuts = 64;          // nesting of cuts; then the bound of the piece is accepted
// Items gathered around one piece or several; with more of them pieces are refined one by one, or halved.
constexpr std::size_t max_near_one = 48, max_near_several = 24;
constexpr std::size_t max_near_wide = 512;  // around one piece among needles, if not fewer
// If a cut would take less than this share of the piece, the piece is halved instead, so that pieces shrink.
constexpr double min_cut = 1.0 / 16;
// Beyond a corner of the triangle a margin is exceeded, the more the sharper the corner; a margin of 0 never is.
constexpr double margins[] = {0.9, 0.5, 0};
// Height of a piece above a triangle, over the limit, up to which it may be cut along its sides.
constexpr double cut_height = 0.95;

constexpr auto by_bound = [](const auto& a, const auto& b) { return a.upper < b.upper; };

}  // namespace

class CellErrorMeter::Measurement {
 public:
  explicit Measurement(const CellErrorConfig& config) : config_(config) {}
  [[nodiscard]] CellError run(const CellErrorQuery& query);
  [[nodiscard]] const CellErrorWork& work() const { return work_; }

 private:
  // A leaf of one of the surfaces that may be farther from the other one than the limit.
  struct Candidate {
    double upper = 0;  // bound of the distance
    LevelSurface::Branch leaf;
    SurfaceItem near;  // item of the other surface
    bool backward = false;
  };
  struct Shape {
    ConvexPiece piece;
    std::uint32_t hint = 0;  // in the neighbourhood
    std::uint32_t cuts = 0;  // nesting of its cuts
  };
  [[nodiscard]] const LevelSurface& source(bool backward) const { return backward ? query_->finest : query_->level; }
  [[nodiscard]] const LevelSurface& target(bool backward) const { return backward ? query_->level : query_->finest; }
  [[nodiscard]] bool attempt(std::uint64_t tests);
  [[nodiscard]] double limit() const;
  [[nodiscard]] bool is_spent() const { return work_.tests > last_test_; }
  void settle(double upper);
  [[nodiscard]] LevelSurface::Nearest search(Vec3d p, bool backward, const LevelSurface::Until& until,
                                             SurfaceItem& hint);
  [[nodiscard]] double distance(Vec3d p, bool backward, SurfaceItem& near, std::uint32_t most = ~0u);
  void walk(const LevelSurface::Branch& branch, bool backward, SurfaceItem& hint);
  void add_leaf(const LevelSurface::Branch& leaf, bool backward, SurfaceItem& hint);
  [[nodiscard]] double farthest_of(const LevelSurface::Branch& leaf, bool backward, SurfaceItem from) const;
  void refine(const Candidate& candidate);
  void refine(std::vector<Shape>&& shapes, const Box3f& box, bool backward);
  [[nodiscard]] bool is_small(const Shape& shape, bool backward);
  void refine_alone(const Shape& shape, bool backward);
  [[nodiscard]] bool work_through(std::vector<Shape>& shapes, bool backward);
  static void fan(const Shape& shape, std::vector<Shape>& shapes);
  void divide(const Shape& shape, const LevelSurface::Corners& near, std::vector<Shape>& shapes);
  [[nodiscard]] bool cut_off(const Shape& shape, const LevelSurface::Corners& near, double reach, double margin);

  CellErrorConfig config_;
  const CellErrorQuery* query_ = nullptr;
  double tolerance_ = 0;
  double lower_ = 0, settled_ = 0;  // largest distance found; largest bound of the pieces done
  std::vector<Candidate> heap_;     // the largest bound first
  Neighbourhood near_;
  SurfaceItem hint_;  // found last, on the surface that pieces are measured from
  std::vector<Shape> rest_;
  CellErrorWork work_;
  std::uint64_t last_test_ = ~std::uint64_t{0};  // of work_, for the cell at hand
};

double CellErrorMeter::Measurement::limit() const {
  return std::max(query_->known, (1 + tolerance_) * std::max(lower_, query_->negligible / (1 + config_.tolerance)));
}

void CellErrorMeter::Measurement::settle(double upper) { settled_ = std::max(settled_, upper); }

LevelSurface::Nearest CellErrorMeter::Measurement::search(Vec3d p, bool backward, const LevelSurface::Until& until,
                                                          SurfaceItem& hint) {
  const LevelSurface::Nearest nearest = target(backward).nearest(p, hint, until);
  ++work_.queries;
  work_.tests += nearest.tested;
  hint = nearest.item;
  return nearest;
}

// Distance of a point of one surface from the other: a lower bound of the error if the search is complete, which
// `most` tests may prevent.
double CellErrorMeter::Measurement::distance(Vec3d p, bool backward, SurfaceItem& near, std::uint32_t most) {
  const LevelSurface::Nearest nearest = search(p, backward, {0, most}, near);
  const double distance = std::sqrt(nearest.squared_distance);
  if (nearest.complete) lower_ = std::max(lower_, distance);
  return distance;
}

// A branch within a ball is done as a whole; most are smaller than the error on coarse levels.
void CellErrorMeter::Measurement::walk(const LevelSurface::Branch& branch, bool backward, SurfaceItem& hint) {
  const Vec3d lo = to_double(branch.tree.box.lo), hi = to_double(branch.tree.box.hi);
  const double radius = 0.5 * length(hi - lo);
  if (radius <= limit()) {
    const double enough = limit() - radius;
    const LevelSurface::Nearest nearest = search(0.5 * (lo + hi), backward, {enough * enough, most_walked}, hint);
    const double upper = std::sqrt(nearest.squared_distance) + radius;
    if (upper <= limit()) return settle(upper);
  }
  if (branch.tree.is_leaf()) return add_leaf(branch, backward, hint);
  for (const LevelSurface::Branch& half : source(backward).halves(branch)) walk(half, backward, hint);
}

// At most one query per leaf: the item nearest to one triangle is usually near the others.
void CellErrorMeter::Measurement::add_leaf(const LevelSurface::Branch& leaf, bool backward, SurfaceItem& hint) {
  double upper = hint.cell == no_cell ? HUGE_VAL : farthest_of(leaf, backward, hint);
  if (upper > limit()) {
    bool asked = false;
    source(backward).for_each_triangle(leaf, [&](SurfaceItem item) {
      if (!asked) (void)distance(piece_of(source(backward).corners(item)).centre(), backward, hint, most_walked);
      asked = true;
    });
    if (!asked) return;  // only points
    upper = farthest_of(leaf, backward, hint);
  }
  if (upper <= limit()) return settle(upper);
  heap_.push_back({upper, leaf, hint, backward});
  std::push_heap(heap_.begin(), heap_.end(), by_bound);
}

// Largest distance of the leaf's triangles from one item of the other surface.
double CellErrorMeter::Measurement::farthest_of(const LevelSurface::Branch& leaf, bool backward,
                                                SurfaceItem from) const {
  const LevelSurface::Corners near = target(backward).corners(from);
  double upper = 0;
  source(backward).for_each_triangle(leaf, [&](SurfaceItem item) {
    upper = std::max(upper, farthest(piece_of(source(backward).corners(item)), near));
  });
  return upper;
}

// Refines the triangles of the leaf that are not done yet.
void CellErrorMeter::Measurement::refine(const Candidate& candidate) {
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
  if (!shapes.empty()) refine(std::move(shapes), candidate.leaf.tree.box, backward);
}

// Refines pieces together if possible: they share most of their neighbourhood.
void CellErrorMeter::Measurement::refine(std::vector<Shape>&& shapes, const Box3f& box, bool backward) {
  if (is_spent()) {
    const LevelSurface::Corners near = target(backward).corners(hint_);
    for (const Shape& shape : shapes) settle(farthest(shape.piece, near));
    return;
  }
  const bool single = shapes.size() == 1;
  if (single && is_small(shapes.front(), backward)) return;
  bool gathered = near_.gather(target(backward), box, limit(), single ? max_near_one : max_near_several);
  work_.tests += near_.tested();
  if (!gathered && single) {
    gathered = near_.gather(target(backward), box, limit(), max_near_wide);
    work_.tests += near_.tested();
  }
  gathered = gathered && near_.size() > 0;
  if (gathered && work_through(shapes, backward)) return;
  if (!gathered && single) return refine_alone(shapes.front(), backward);
  for (const Shape& shape : shapes) refine({{shape.piece, 0, shape.cuts}}, box_of(shape.piece), backward);
}

// True if the piece is done by its middle alone: usual on coarse levels, where many items are around a piece.
bool CellErrorMeter::Measurement::is_small(const Shape& shape, bool backward) {
  const Vec3d centre = shape.piece.centre();
  const double radius = radius_of(shape.piece, centre), enough = limit() - radius;
  if (!(enough > 0)) return false;
  const LevelSurface::Nearest nearest = search(centre, backward, {.enough = enough * enough}, hint_);
  const double upper = std::sqrt(nearest.squared_distance) + radius;
  if (upper > limit()) return false;
  settle(upper);
  return true;
}

// Without a neighbourhood, by one query of the whole surface: for pieces with many items around.
void CellErrorMeter::Measurement::refine_alone(const Shape& shape, bool backward) {
  std::vector<Shape> parts;
  if (shape.piece.count > max_piece_corners) {
    fan(shape, parts);
    for (const Shape& part : parts) refine_alone(part, backward);
    return;
  }
  ++work_.pieces;
  const Vec3d centre = shape.piece.centre();
  const double middle = distance(centre, backward, hint_);
  const LevelSurface::Corners near = target(backward).corners(hint_);
  const double upper = std::min(middle + radius_of(shape.piece, centre), farthest(shape.piece, near));
  if (upper <= limit() || shape.cuts >= max_cuts || is_spent()) return settle(upper);
  divide({shape.piece, 0, shape.cuts + 1}, near, parts);
  for (const Shape& part : parts) refine({part}, box_of(part.piece), backward);
}

// False when a distance exceeds the reach of the neighbourhood: the remaining shapes need a larger one.
bool CellErrorMeter::Measurement::work_through(std::vector<Shape>& shapes, bool backward) {
  while (!shapes.empty()) {
    const Shape shape = shapes.back();
    if (shape.piece.count > max_piece_corners) {
      shapes.pop_back();
      fan(shape, shapes);
      continue;
    }
    ++work_.pieces;
    const Vec3d centre = shape.piece.centre();
    const Neighbourhood::Nearest nearest = near_.nearest(centre, shape.hint);
    work_.tests += 1 + near_.size() / 8;
    if (nearest.distance > near_.reach()) {
      hint_ = near_.item(nearest.number);
      (void)distance(centre, backward, hint_);
      return false;
    }
    shapes.pop_back();
    lower_ = std::max(lower_, nearest.distance);
    double upper = nearest.distance + radius_of(shape.piece, centre);
    if (upper > limit()) upper = std::min(upper, farthest(shape.piece, near_.corners(nearest.number)));
    if (upper <= limit() || shape.cuts >= max_cuts || is_spent()) {
      settle(upper);
    } else {
      divide({shape.piece, nearest.number, shape.cuts + 1}, near_.corners(nearest.number), shapes);
    }
  }
  return true;
}

// Adds the triangles of the piece.
void CellErrorMeter::Measurement::fan(const Shape& shape, std::vector<Shape>& shapes) {
  for (std::uint32_t i = 2; i < shape.piece.count; ++i)
    shapes.push_back(
        {piece_of({shape.piece.corner[0], shape.piece.corner[i - 1], shape.piece.corner[i]}), shape.hint, shape.cuts});
}

void CellErrorMeter::Measurement::divide(const Shape& shape, const LevelSurface::Corners& t,
                                         std::vector<Shape>& shapes) {
  const double reach = limit();
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
bool CellErrorMeter::Measurement::cut_off(const Shape& shape, const LevelSurface::Corners& near, double reach,
                                          double margin) {
  const Vec3d normal = cross(near[1] - near[0], near[2] - near[0]);
  rest_.clear();
  ConvexPiece inside = shape.piece;
  for (std::size_t k = 0; k < 3 && inside.count > 0; ++k) {
    const Vec3d inwards = cross(normal, near[(k + 1) % 3] - near[k]);
    const CutPiece parts = cut(inside, {inwards, near[k], -margin * length(inwards)});
    if (parts.outside.count > 0) rest_.push_back({parts.outside, shape.hint, shape.cuts});
    inside = parts.inside;
  }
  if (inside.count == 0 || inside.area() < min_cut * shape.piece.area()) return false;
  const double upper = farthest(inside, near);
  if (upper > reach) return false;
  settle(upper);
  return true;
}

// Bounds the error with the tolerance at hand; false if the tests ran out before.
bool CellErrorMeter::Measurement::attempt(std::uint64_t tests) {
  const CellErrorQuery& query = *query_;
  settled_ = 0;
  heap_.clear();
  SurfaceItem hint;
  walk(query.level.cell_branch(query.cell), false, hint);
  hint = {};
  for (CellRank c = query.first; c < query.end; ++c) walk(query.finest.cell_branch(c), true, hint);
  last_test_ = tests > 0 ? work_.tests + tests : ~std::uint64_t{0};
  while (!heap_.empty() && heap_.front().upper > limit() && !is_spent()) {
    std::pop_heap(heap_.begin(), heap_.end(), by_bound);
    const Candidate top = heap_.back();
    heap_.pop_back();
    refine(top);
  }
  if (!heap_.empty()) settle(heap_.front().upper);
  return !is_spent();
}

// A larger tolerance needs fewer pieces, and is of no use beyond what is known without them.
CellError CellErrorMeter::Measurement::run(const CellErrorQuery& query) {
  query_ = &query;
  lower_ = 0;
  tolerance_ = config_.tolerance;
  const std::uint64_t share = query.tests == 0 ? 0 : 1 + query.tests / (1 + attempts);
  const bool complete = attempt(2 * share);
  double upper = settled_;
  if (!complete && query.largest) upper = std::min(upper, std::max(query.largest(), query.negligible));
  bool done = complete;
  for (int i = 1; i < attempts && !done; ++i) {
    tolerance_ = coarser * std::max(tolerance_, 1.0);
    done = limit() >= upper || attempt(share);
    upper = std::min(upper, settled_);
  }
  return {std::max(query.known, upper), lower_, complete};
}

CellErrorMeter::CellErrorMeter(const CellErrorConfig& config) : measurement_(std::make_unique<Measurement>(config)) {}
CellErrorMeter::~CellErrorMeter() = default;
CellErrorMeter::CellErrorMeter(CellErrorMeter&&) noexcept = default;
CellError CellErrorMeter::measure(const CellErrorQuery& query) { return measurement_->run(query); }
const CellErrorWork& CellErrorMeter::work() const { return measurement_->work(); }

}  // namespace lodestone
