// Vertex clustering (rossignac1993) with the representative chosen by the quadric of its cell (lindstrom2000), but
// always a vertex of the input: P has to be a map of vertices to vertices.
#include <algorithm>
#include <cmath>

#include "core/base/key_numbers.h"
#include "core/math/quadric.h"
#include "core/math/vec3.h"
#include "core/simplify/peers/peers.h"

namespace lodestone {
namespace {

using Id = std::uint32_t;
constexpr Id none = 0xffff'ffffu;
constexpr int axis_bits = 20;
constexpr int search_steps = 6;

// A cell by its integer coordinates; vertices of different labels never share one.
struct CellKey {
  std::uint64_t coordinates = 0;
  Id label = 0;
  friend bool operator==(const CellKey&, const CellKey&) = default;
};
struct CellHash {
  [[nodiscard]] std::uint64_t operator()(const CellKey& key) const {
    return FibonacciHash{}(key.coordinates + key.label);
  }
};

// The grid of one cell size over the block's box.
struct Grid {
  Box3f box;
  double size = 1;

  // Coordinates that are not numbers are in the first cell.
  [[nodiscard]] std::uint64_t axis(double x, double lo) const {
    const double cell = std::floor((x - lo) / size);
    return cell > 0 ? static_cast<std::uint64_t>(std::min(cell, static_cast<double>((1 << axis_bits) - 1))) : 0;
  }
  [[nodiscard]] std::uint64_t key(Vec3f p) const {
    return axis(p.x, box.lo.x) | axis(p.y, box.lo.y) << axis_bits | axis(p.z, box.lo.z) << 2 * axis_bits;
  }
};

Id label_of(const SimplifyInput& input, Id v) { return input.labels.empty() ? 0 : input.labels[v]; }

class ClusterSimplifier final : public Simplifier {
 public:
  const SimplifyResult& simplify(const SimplifyInput& input) override {
    keep_all(input);
    const auto movable = static_cast<std::size_t>(std::ranges::count(input.locked, 0));
    target_ = triangles_to_keep(input, movable);
    if (target_ >= input.triangles.size()) return result_;
    const Grid grid = search_grid(input);
    assign_cells(input, grid);
    sum_quadrics(input);
    choose_representatives(input);
    move_members(input);
    return result_;
  }

 private:
  void keep_all(const SimplifyInput& input);
  [[nodiscard]] Grid search_grid(const SimplifyInput& input);
  [[nodiscard]] std::size_t triangles_on(const SimplifyInput& input, const Grid& grid);
  void assign_cells(const SimplifyInput& input, const Grid& grid);
  void sum_quadrics(const SimplifyInput& input);
  void choose_representatives(const SimplifyInput& input);
  void move_members(const SimplifyInput& input);

  SimplifyResult result_;
  std::size_t target_ = 0;
  KeyNumbers<CellKey, CellHash> numbers_;  // of the cells, in the order of their first vertex
  std::vector<std::uint64_t> key_;         // of each vertex, while searching
  std::vector<Id> cell_;                   // of each vertex; none if it has no triangles
  std::vector<Vec3d> anchor_;              // of each cell: its first vertex; quadrics are relative to it
  std::vector<Quadric> quadric_;           // of each cell
  std::vector<Id> representative_;         // of each cell
  std::vector<double> cost_;               // of the representative
  std::vector<std::uint8_t> used_;         // has triangles
};

void ClusterSimplifier::keep_all(const SimplifyInput& input) {
  const std::size_t n = input.positions.size();
  result_.parent.resize(n);
  for (Id v = 0; v < n; ++v) result_.parent[v] = v;
  result_.positions.assign(input.positions.begin(), input.positions.end());
  result_.triangles = input.triangles.size();
  used_.assign(n, 0);
  for (const Triangle& t : input.triangles)
    for (const Id v : t.v) used_[v] = 1;
}

// The number of triangles left if every vertex reached its representative.
std::size_t ClusterSimplifier::triangles_on(const SimplifyInput& input, const Grid& grid) {
  constexpr std::uint64_t locked_bit = 1ull << 63;
  key_.resize(input.positions.size());
  for (Id v = 0; v < key_.size(); ++v) key_[v] = input.locked[v] ? locked_bit | v : grid.key(input.positions[v]);
  const auto apart = [&](Id a, Id b) { return key_[a] != key_[b] || label_of(input, a) != label_of(input, b); };
  std::size_t left = 0;
  for (const auto& [v] : input.triangles) left += apart(v[0], v[1]) && apart(v[1], v[2]) && apart(v[2], v[0]);
  return left;
}

// The number of triangles falls with the square of the cell size once cells are larger than edges.
Grid ClusterSimplifier::search_grid(const SimplifyInput& input) {
  Grid grid;
  for (Id v = 0; v < used_.size(); ++v)
    if (used_[v]) grid.box.extend(input.positions[v]);
  const Vec3d extent = to_double(grid.box.hi) - to_double(grid.box.lo);
  const double longest = std::max({extent.x, extent.y, extent.z});
  // A representative in the middle of a cell of this size reaches its corners.
  const double largest = std::max(2 * static_cast<double>(input.max_displacement) / std::sqrt(3.0), longest * 1e-30);
  const double smallest = std::min(largest, longest / (1 << axis_bits));
  const double target = static_cast<double>(std::max<std::size_t>(target_, 1));
  grid.size = largest;
  for (int step = 0; step < search_steps; ++step) {
    const double left = static_cast<double>(triangles_on(input, grid));
    if (std::abs(left - target) <= 0.02 * target) break;
    const double size = std::clamp(grid.size * std::sqrt(std::max(left, 1.0) / target), smallest, largest);
    if (size == grid.size) break;
    grid.size = size;
  }
  return grid;
}

void ClusterSimplifier::assign_cells(const SimplifyInput& input, const Grid& grid) {
  numbers_.clear(input.positions.size());
  anchor_.clear();
  cell_.assign(input.positions.size(), none);
  for (Id v = 0; v < cell_.size(); ++v) {
    if (!used_[v]) continue;
    cell_[v] = numbers_.number({grid.key(input.positions[v]), label_of(input, v)});
    if (cell_[v] == anchor_.size()) anchor_.push_back(to_double(input.positions[v]));
  }
}

void ClusterSimplifier::sum_quadrics(const SimplifyInput& input) {
  quadric_.assign(anchor_.size(), {});
  for (const Triangle& t : input.triangles) {
    const Vec3d a = to_double(input.positions[t.v[0]]);
    const Vec3d n = cross(to_double(input.positions[t.v[1]]) - a, to_double(input.positions[t.v[2]]) - a);
    const double size = length(n);
    if (!(size > 0)) continue;
    for (const Id v : t.v) quadric_[cell_[v]].add_plane((1 / size) * n, a - anchor_[cell_[v]], size);
  }
}

void ClusterSimplifier::choose_representatives(const SimplifyInput& input) {
  representative_.assign(anchor_.size(), none);
  cost_.resize(anchor_.size());
  for (Id v = 0; v < cell_.size(); ++v) {
    const Id c = cell_[v];
    if (c == none) continue;
    const double cost = quadric_[c].cost(to_double(input.positions[v]) - anchor_[c]);
    if (representative_[c] != none && !(cost < cost_[c])) continue;
    representative_[c] = v;
    cost_[c] = cost;
  }
}

void ClusterSimplifier::move_members(const SimplifyInput& input) {
  for (Id v = 0; v < cell_.size(); ++v) {
    if (cell_[v] == none || input.locked[v]) continue;
    const Id to = representative_[cell_[v]];
    const Vec3d way = to_double(input.positions[to]) - to_double(input.positions[v]);
    if (length(way) <= input.max_displacement) result_.parent[v] = to;
  }
  result_.triangles = 0;
  for (const auto& [v] : input.triangles)
    result_.triangles += !is_degenerate({result_.parent[v[0]], result_.parent[v[1]], result_.parent[v[2]]});
}

}  // namespace

std::unique_ptr<Simplifier> make_cluster_simplifier() { return std::make_unique<ClusterSimplifier>(); }

}  // namespace lodestone
