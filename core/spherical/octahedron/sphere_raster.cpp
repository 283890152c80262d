#include "core/spherical/octahedron/sphere_raster.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/spherical/octahedron/rough_square.h"

namespace lodestone::spherical {
namespace {

// Within an octant the image of an arc of length l is at most bend * l^2 away from the box of its ends: the most that
// 1.5 million arcs of lengths from 1e-5 to 1.5 showed is 0.61. Longer edges are bounded piece by piece.
constexpr double bend = 0.8;

bool same_octant(Vec3d a, Vec3d b, Vec3d c) {
  const auto agree = [](double p, double q, double r) {
    return std::signbit(p) == std::signbit(q) && std::signbit(q) == std::signbit(r);
  };
  return agree(a.x, b.x, c.x) && agree(a.y, b.y, c.y) && agree(a.z, b.z, c.z);
}

// A convex polygon on the sphere: a triangle, clipped at up to three planes.
struct Polygon {
  std::array<Vec3d, 6> corners{};
  std::size_t count = 0;
  void add(Vec3d p) {
    if (count < corners.size()) corners[count++] = p;
  }
};

// The part where the coordinate has the sign or is zero.
Polygon clipped(const Polygon& polygon, double Vec3d::*coordinate, double sign) {
  Polygon part;
  for (std::size_t k = 0; k < polygon.count; ++k) {
    const Vec3d a = polygon.corners[k], b = polygon.corners[(k + 1) % polygon.count];
    const double from = sign * (a.*coordinate), to = sign * (b.*coordinate);
    if (from >= 0) part.add(a);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
      Vec3d p = std::abs(to) * a + std::abs(from) * b;
      p.*coordinate = 0;
      part.add((1 / length(p)) * p);
    }
  }
  return part;
}

// Normals of the planes through the centre and the edge opposite to each corner: the two triangles at an edge have the
// same ones with opposite signs.
std::array<Vec3d, 3> planes_of(const Triangle& triangle, std::span<const Vec3d> directions) {
  std::array<Vec3d, 3> normals;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = triangle.v[(k + 1) % 3], b = triangle.v[(k + 2) % 3];
    normals[k] = a < b ? cross(directions[a], directions[b]) : -1.0 * cross(directions[b], directions[a]);
  }
  return normals;
}

}  // namespace

SphereRaster::SphereRaster(std::span<const Triangle> triangles, std::span<const Vec3d> directions, SampleGrid grid,
                           InstructionSet instructions)
    : triangles_(triangles),
      directions_(directions),
      grid_(grid),
      kernel_(*choose_kernel(instructions, plain_raster_kernel, avx2_raster_kernel)),
      tiles_((grid.n + SampleTile::side - 1) / SampleTile::side),
      places_(directions.size()),
      boxes_(triangles.size()) {
  assert(grid.n >= 1 && (grid.n >= 2 || grid.placing == SampleGrid::Placing::in_cells));
}

void SphereRaster::place(std::size_t begin, std::size_t end) {
  for (std::size_t v = begin; v < end; ++v) places_[v] = square_point(directions_[v]);
}

// A box around the image of a polygon in one octant.
SphereRaster::Box SphereRaster::box_of(std::span<const Vec3d> corners, std::span<const SquarePoint> places,
                                       const Octant& octant) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double allowed = 1.5, most_pieces = 16;  // samples
  double left = infinity, right = -infinity, top = infinity, bottom = -infinity;
  const auto extend = [&](SquarePoint p, double margin) {
    left = std::min(left, p.s - margin), right = std::max(right, p.s + margin);
    top = std::min(top, p.t - margin), bottom = std::max(bottom, p.t + margin);
  };
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3d a = corners[k], b = corners[(k + 1) % corners.size()];
    // Equal pieces of a chord are arcs no longer than this.
    const double chord = length(b - a), arc = chord < 0.5 ? 1.04 * chord : 1.6 * chord;
    const double pieces = std::clamp(std::ceil(arc * std::sqrt(bend * grid_.n / allowed)), 1.0, most_pieces);
    const double margin = bend * (arc / pieces) * (arc / pieces) + 1e-12;
    extend(places[k], margin);
    extend(places[(k + 1) % corners.size()], margin);
    for (double p = 1; p < pieces; ++p)
      extend(rough_square_point((1 - p / pieces) * a + (p / pieces) * b, octant), margin + rough_square_error);
  }
  const double scale = grid_.placing == SampleGrid::Placing::in_cells ? grid_.n : grid_.n - 1.0;
  const double shift = grid_.placing == SampleGrid::Placing::in_cells ? 0.5 : 0.0;
  // The first and last samples within.
  const double x0 = std::max(std::ceil(left * scale - shift), 0.0);
  const double x1 = std::min(std::floor(right * scale - shift), grid_.n - 1.0);
  const double y0 = std::max(std::ceil(top * scale - shift), 0.0);
  const double y1 = std::min(std::floor(bottom * scale - shift), grid_.n - 1.0);
  if (!(x0 <= x1 && y0 <= y1)) return {};
  const auto number = [](double sample) { return static_cast<std::uint16_t>(sample); };
  return {number(x0), number(x1), number(y0), number(y1)};
}

void SphereRaster::bound(std::size_t begin, std::size_t end) {
  for (std::size_t t = begin; t < end; ++t) {
    const auto [i, j, k] = triangles_[t].v;
    const Vec3d a = directions_[i], b = directions_[j], c = directions_[k];
    if (same_octant(a, b, c))
      boxes_[t] = box_of(std::array{a, b, c}, std::array{places_[i], places_[j], places_[k]}, octant_of(a));
  }
}

// A triangle in several octants: the boxes of its parts.
void SphereRaster::add_parts(std::uint32_t triangle) {
  Polygon whole;
  for (const std::uint32_t v : triangles_[triangle].v) whole.add(directions_[v]);
  for (const double z : {1.0, -1.0})
    for (const double y : {1.0, -1.0})
      for (const double x : {1.0, -1.0}) {
        const Polygon part = clipped(clipped(clipped(whole, &Vec3d::z, z), &Vec3d::y, y), &Vec3d::x, x);
        if (part.count < 3) continue;
        std::array<SquarePoint, 6> places;
        for (std::size_t k = 0; k < part.count; ++k) places[k] = square_point(part.corners[k], {x, y, z});
        const std::span<const Vec3d> corners(part.corners.data(), part.count);
        const Box box = box_of(corners, std::span(places).first(part.count), {x, y, z});
        if (box.left <= box.right) parts_.push_back({box, triangle});
      }
}

template <class Body>
void SphereRaster::for_each_tile(const Box& box, const Body& body) const {
  for (std::size_t y = box.top / SampleTile::side; y <= box.bottom / SampleTile::side; ++y)
    for (std::size_t x = box.left / SampleTile::side; x <= box.right / SampleTile::side; ++x) body(y * tiles_ + x);
}

void SphereRaster::sort() {
  parts_.clear();
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const auto& v = triangles_[t].v;
    if (!same_octant(directions_[v[0]], directions_[v[1]], directions_[v[2]])) {
      add_parts(t);
    } else if (boxes_[t].left <= boxes_[t].right) {
      parts_.push_back({boxes_[t], t});
    }
  }
  first_.assign(tile_count() + 1, 0);
  for (const Part& part : parts_) for_each_tile(part.box, [&](std::size_t tile) { ++first_[tile + 1]; });
  for (std::size_t tile = 0; tile < tile_count(); ++tile) first_[tile + 1] += first_[tile];
  candidates_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t p = 0; p < parts_.size(); ++p)
    for_each_tile(parts_[p].box, [&](std::size_t tile) { candidates_[next[tile]++] = p; });
}

void SphereRaster::prepare() {
  place(0, directions_.size());
  bound(0, triangles_.size());
  sort();
}

void SphereRaster::cover(std::size_t index, SampleTile& tile) const {
  tile.x = static_cast<std::uint32_t>(index % tiles_) * SampleTile::side;
  tile.y = static_cast<std::uint32_t>(index / tiles_) * SampleTile::side;
  tile.width = std::min(SampleTile::side, grid_.n - tile.x), tile.height = std::min(SampleTile::side, grid_.n - tile.y);
  kernel_.set_rays(grid_, tile);
  tile.triangle.assign(std::size_t{SampleTile::side} * SampleTile::side, no_triangle);
  for (std::vector<float>& weight : tile.weight) weight.resize(tile.triangle.size());
  for (std::uint32_t c = first_[index]; c < first_[index + 1]; ++c) {
    const Part& part = parts_[candidates_[c]];
    const TileWindow window{std::max<std::uint32_t>(part.box.left, tile.x) - tile.x,
                            std::min<std::uint32_t>(part.box.right + 1u, tile.x + tile.width) - tile.x,
                            std::max<std::uint32_t>(part.box.top, tile.y) - tile.y,
                            std::min<std::uint32_t>(part.box.bottom + 1u, tile.y + tile.height) - tile.y};
    kernel_.cover(part.triangle, planes_of(triangles_[part.triangle], directions_), window, tile);
  }
}

}  // namespace lodestone::spherical
