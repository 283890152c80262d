#include "render/culling/back_faces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace lodestone {
namespace {

// The finalizer of splitmix64 (steele2014).
std::uint64_t mixed(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58'476d'1ce4'e5b9u;
  v = (v ^ (v >> 27)) * 0x94d0'49bb'1331'11ebu;
  return v ^ (v >> 31);
}

std::uint64_t hash_of(Vec3f p) {
  const auto bits = [](float v) { return std::uint64_t{std::bit_cast<std::uint32_t>(v + 0.0f)}; };  // -0 is 0
  return mixed(mixed(bits(p.x) << 32 | bits(p.y)) + bits(p.z));
}

// A half-edge and its twin add up to nothing.
std::uint64_t hash_of_edge(std::uint64_t from, std::uint64_t to) {
  if (from == to) return 0;
  const std::uint64_t edge = mixed(std::min(from, to) + mixed(std::max(from, to)));
  return from < to ? edge : 0 - edge;
}

struct CellSum {
  std::uint64_t boundary = 0;
  double volume = 0;  // six times that over the origin
};

CellSum sum_of(const Cell& cell) {
  std::vector<std::uint64_t> hashes;
  hashes.reserve(cell.positions.size());
  for (const Vec3f p : cell.positions) hashes.push_back(hash_of(p));
  CellSum sum;
  for (const Triangle& t : cell.triangles) {
    const auto [a, b, c] = t.v;
    sum.boundary +=
        hash_of_edge(hashes[a], hashes[b]) + hash_of_edge(hashes[b], hashes[c]) + hash_of_edge(hashes[c], hashes[a]);
    sum.volume += dot(to_double(cell.positions[a]), cross(to_double(cell.positions[b]), to_double(cell.positions[c])));
  }
  return sum;
}

// Coarser than this, little of the space around a surface is known to be outside; finer, filling takes long.
constexpr int finest_grid = 6;

}  // namespace

bool is_closed(const Hierarchy& hierarchy, Scheduler& scheduler) {
  if (hierarchy.cells.empty()) return false;
  const std::span<const Cell> cells = hierarchy.cells_of(hierarchy.finest());
  if (std::ranges::any_of(cells, [](const Cell& cell) { return cell.positions.empty(); })) return false;
  std::vector<CellSum> sums(cells.size());
  scheduler.for_chunks(cells.size(), 1, [&](ChunkRange range) {
    for (std::size_t c = range.begin; c < range.end; ++c) sums[c] = sum_of(cells[c]);
  });
  CellSum all;
  for (const CellSum& sum : sums) all = {all.boundary + sum.boundary, all.volume + sum.volume};
  return all.boundary == 0 && all.volume > 0;
}

OutsideSpace::OutsideSpace(const Hierarchy& hierarchy) {
  if (hierarchy.cells.empty()) return;
  const int level = std::min(hierarchy.finest(), finest_grid);
  side_ = 1 << finest_grid;
  cells_.assign(index(0, 0, side_), Space::unknown);
  const std::span<const Cell> cells = hierarchy.cells_of(level);
  // Vertices of this level and of finer ones move by no more than this.
  const float margin = displacement_bound(hierarchy.sigma0, level) + clearance;
  for (const Cell& cell : cells) {
    Box3f box = cell.bounds;
    box.lo = {box.lo.x - margin, box.lo.y - margin, box.lo.z - margin};
    box.hi = {box.hi.x + margin, box.hi.y + margin, box.hi.z + margin};
    mark(box);
  }
  fill();
}

void OutsideSpace::mark(const Box3f& box) {
  const auto slot = [&](float v) {
    return std::clamp(static_cast<int>(std::floor(v * static_cast<float>(side_))), 0, side_ - 1);
  };
  for (int z = slot(box.lo.z); z <= slot(box.hi.z); ++z)
    for (int y = slot(box.lo.y); y <= slot(box.hi.y); ++y)
      for (int x = slot(box.lo.x); x <= slot(box.hi.x); ++x) cells_[index(x, y, z)] = Space::surface;
}

// From all sides of the cube inwards.
void OutsideSpace::fill() {
  std::vector<std::array<int, 3>> open;
  const auto enter = [&](int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= side_ || y >= side_ || z >= side_) return;
    Space& space = cells_[index(x, y, z)];
    if (space != Space::unknown) return;
    space = Space::outside;
    open.push_back({x, y, z});
  };
  for (int a = 0; a < side_; ++a)
    for (int b = 0; b < side_; ++b)
      for (const int end : {0, side_ - 1}) enter(a, b, end), enter(a, end, b), enter(end, a, b);
  while (!open.empty()) {
    const auto [x, y, z] = open.back();
    open.pop_back();
    enter(x - 1, y, z), enter(x + 1, y, z), enter(x, y - 1, z), enter(x, y + 1, z), enter(x, y, z - 1),
        enter(x, y, z + 1);
  }
}

// Vertices remain in the unit cube, as blends of positions in it.
bool OutsideSpace::contains(Vec3f v) const {
  if (!is_finite(v) || cells_.empty()) return false;
  const auto beyond = [](float c) { return c < -clearance || c > 1 + clearance; };
  if (beyond(v.x) || beyond(v.y) || beyond(v.z)) return true;
  const auto slot = [&](float c) { return static_cast<int>(std::floor(c * static_cast<float>(side_))); };
  const int x = slot(v.x), y = slot(v.y), z = slot(v.z);
  if (std::min({x, y, z}) < 0 || std::max({x, y, z}) >= side_) return false;
  return cells_[index(x, y, z)] == Space::outside;
}

BackFaces::BackFaces(const Hierarchy& hierarchy, Scheduler& scheduler)
    : closed_(is_closed(hierarchy, scheduler)), outside_(hierarchy), cones_(hierarchy, scheduler) {}

}  // namespace lodestone
