#include "render/culling/back_faces.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/disjoint_sets.h"
#include "render/frame/appearance.h"

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

std::uint64_t boundary_of(const Cell& cell) {
  std::vector<std::uint64_t> hashes;
  hashes.reserve(cell.positions.size());
  for (const Vec3f p : cell.positions) hashes.push_back(hash_of(p));
  std::uint64_t sum = 0;
  for (const Triangle& t : cell.triangles) {
    const auto [a, b, c] = t.v;
    sum += hash_of_edge(hashes[a], hashes[b]) + hash_of_edge(hashes[b], hashes[c]) + hash_of_edge(hashes[c], hashes[a]);
  }
  return sum;
}

bool has_boundary(std::span<const Cell> cells, Scheduler& scheduler) {
  std::vector<std::uint64_t> sums(cells.size());
  scheduler.for_chunks(cells.size(), 1, [&](ChunkRange range) {
    for (std::size_t c = range.begin; c < range.end; ++c) sums[c] = boundary_of(cells[c]);
  });
  return std::accumulate(sums.begin(), sums.end(), std::uint64_t{0}) != 0;
}

// Six times the volume over the origin, and the sum of what it is made of without signs.
struct Volume {
  double sum = 0, magnitude = 0;
  void add(const Volume& v) { sum += v.sum, magnitude += v.magnitude; }
  [[nodiscard]] bool is_rounding() const { return std::abs(sum) <= 1e-12 * magnitude; }
};

Volume volume_of(const Cell& cell, const Triangle& t) {
  const double v = dot(to_double(cell.positions[t.v[0]]),
                       cross(to_double(cell.positions[t.v[1]]), to_double(cell.positions[t.v[2]])));
  return {v, std::abs(v)};
}

// The connected parts within one cell: of each vertex, and what each encloses.
struct CellParts {
  std::vector<std::uint32_t> of_vertex;
  std::vector<Volume> volumes;
};

CellParts parts_of(const Cell& cell) {
  DisjointSets sets(cell.positions.size());
  for (const Triangle& t : cell.triangles) sets.unite(t.v[0], t.v[1]), sets.unite(t.v[0], t.v[2]);
  CellParts parts{std::vector<std::uint32_t>(cell.positions.size()), {}};
  for (std::uint32_t v = 0; v < parts.of_vertex.size(); ++v) {
    const std::uint32_t root = sets.find(v);
    if (root == v) parts.volumes.emplace_back();
    parts.of_vertex[v] = root == v ? static_cast<std::uint32_t>(parts.volumes.size() - 1) : parts.of_vertex[root];
  }
  for (const Triangle& t : cell.triangles) parts.volumes[parts.of_vertex[t.v[0]]].add(volume_of(cell, t));
  return parts;
}

// The volumes of the connected parts of all cells; vertices of one position belong together.
std::vector<Volume> volumes_of_parts(std::span<const Cell> cells, Scheduler& scheduler) {
  std::vector<CellParts> within(cells.size());
  scheduler.for_chunks(cells.size(), 1, [&](ChunkRange range) {
    for (std::size_t c = range.begin; c < range.end; ++c) within[c] = parts_of(cells[c]);
  });
  std::vector<Volume> volumes;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places;  // hash of the position, part
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto first = static_cast<std::uint32_t>(volumes.size());
    for (std::size_t v = 0; v < cells[c].positions.size(); ++v)
      places.emplace_back(hash_of(cells[c].positions[v]), first + within[c].of_vertex[v]);
    volumes.insert(volumes.end(), within[c].volumes.begin(), within[c].volumes.end());
  }
  std::sort(places.begin(), places.end());
  DisjointSets sets(volumes.size());
  for (std::size_t i = 1; i < places.size(); ++i)
    if (places[i].first == places[i - 1].first) sets.unite(places[i].second, places[i - 1].second);
  for (auto part = static_cast<std::uint32_t>(volumes.size()); part-- > 0;)
    if (const std::uint32_t root = sets.find(part); root != part)
      volumes[root].add(std::exchange(volumes[part], Volume{}));
  return volumes;
}

// Coarser than this, little of the space around a surface is known to be outside; finer, filling takes long.
constexpr int finest_grid = 6;

}  // namespace

bool is_closed(const Hierarchy& hierarchy, Scheduler& scheduler) {
  if (hierarchy.cells.empty()) return false;
  const std::span<const Cell> cells = hierarchy.cells_of(hierarchy.finest());
  const bool missing = std::ranges::any_of(cells, [](const Cell& cell) { return cell.positions.empty(); });
  return !missing && !has_boundary(cells, scheduler);
}

Facing facing_of(const Hierarchy& hierarchy, Scheduler& scheduler) {
  if (!is_closed(hierarchy, scheduler)) return Facing::open;
  bool outward = false, inward = false;
  for (const Volume& volume : volumes_of_parts(hierarchy.cells_of(hierarchy.finest()), scheduler))
    if (!volume.is_rounding()) (volume.sum > 0 ? outward : inward) = true;
  return outward == inward ? Facing::mixed : outward ? Facing::outward : Facing::inward;
}

OutsideSpace::OutsideSpace(const Hierarchy& hierarchy) {
  if (hierarchy.cells.empty()) return;
  const int level = std::min(hierarchy.finest(), finest_grid);
  side_ = 1 << finest_grid;
  cells_.assign(index(0, 0, side_), Space::unknown);
  const std::span<const Cell> cells = hierarchy.cells_of(level);
  // Vertices of this level and of finer ones move by no more than this.
  const float margin = hierarchy.displacement_bound(level) + clearance;
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
    : facing_(facing_of(hierarchy, scheduler)),
      seen_through_(has_materials_of(hierarchy, AlphaMode::mask) || has_materials_of(hierarchy, AlphaMode::blend)),
      one_sided_(has_one_sided_materials(hierarchy)),
      outside_(hierarchy),
      cones_(hierarchy, scheduler) {
  if (facing_ == Facing::inward) cones_.turn_over();
}

const NormalCones* BackFaces::cones_from(Vec3f viewpoint, const Appearance& appearance) const {
  if (facing_ != Facing::outward && facing_ != Facing::inward) return nullptr;
  const bool front_is_missing = one_sided_ && facing_ == Facing::inward;
  if (appearance.opacity < 1 || (appearance.textures && (seen_through_ || front_is_missing))) return nullptr;
  return outside_.contains(viewpoint) ? &cones_ : nullptr;
}

}  // namespace lodestone
