#include "experiments/systems/tiles/tile_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/hierarchy/model/cell_code.h"
#include "core/hierarchy/model/distance_metric.h"
#include "core/simplify/peers/whole_mesh.h"
#include "experiments/metrics/drawn/border.h"
#include "experiments/systems/surface/surface_distance.h"

namespace lodestone {
namespace {

constexpr int deepest = 12;

class TreeBuilder {
 public:
  TreeBuilder(const WeldedSurface& surface, const TileTreeConfig& config, Scheduler& scheduler)
      : surface_(surface), config_(config), scheduler_(scheduler) {}

  std::vector<TileNode> build() {
    sort_triangles();
    plan();
    const TriangleBvh full = tree_of({surface_.positions, surface_.triangles});
    tiles_.resize(cubes_.size());
    scheduler_.for_chunks(cubes_.size(), 1, [&](ChunkRange range) { fill(range.begin, full); });
    for (std::size_t t = cubes_.size(); t-- > 0;) add_children(tiles_[t]);
    for (TileNode& tile : tiles_)
      for (std::uint32_t c = 0; c < tile.child_count; ++c) tiles_[tile.first_child + c].gap = 2 * tile.error;
    tiles_.front().gap = 2 * tiles_.front().error;
    return std::move(tiles_);
  }

 private:
  // Triangles of a cube are consecutive: in the Morton order of the finest cubes that there may be.
  struct Cube {
    std::size_t begin = 0, end = 0;
    int level = 0;
    std::uint32_t first_child = 0, child_count = 0;
  };

  void sort_triangles() {
    std::vector<std::uint64_t> code;
    for (const auto& [v] : surface_.triangles) {
      const Vec3f middle = barycentre(surface_.positions[v[0]], surface_.positions[v[1]], surface_.positions[v[2]]);
      code.push_back(CellCode::from(cell_of(middle, deepest)).morton);
    }
    std::vector<std::uint32_t> order(code.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, {}, [&](std::uint32_t t) { return code[t]; });
    for (const std::uint32_t t : order) triangles_.push_back(surface_.triangles[t]), code_.push_back(code[t]);
  }

  void plan() {
    cubes_.push_back({0, triangles_.size(), 0});
    for (std::uint32_t c = 0; c < cubes_.size(); ++c) {
      const Cube cube = cubes_[c];
      if (cube.end - cube.begin <= config_.tile_triangles || cube.level == deepest) continue;
      cubes_[c].first_child = static_cast<std::uint32_t>(cubes_.size());
      const int shift = 3 * (deepest - cube.level - 1);
      for (std::size_t begin = cube.begin, end = begin; begin < cube.end; begin = end) {
        while (end < cube.end && code_[end] >> shift == code_[begin] >> shift) ++end;
        cubes_.push_back({begin, end, cube.level + 1});
        ++cubes_[c].child_count;
      }
    }
  }

  void fill(std::size_t number, const TriangleBvh& full) {
    const Cube& cube = cubes_[number];
    TileNode& tile = tiles_[number];
    tile.first_child = cube.first_child, tile.child_count = cube.child_count;
    tile.mesh = part_mesh(std::span(triangles_).subspan(cube.begin, cube.end - cube.begin), surface_.positions);
    if (cube.child_count > 0) {
      const std::vector<Vec3f> points = tile.mesh.positions;
      simplify(tile.mesh);
      tile.error = surface_distance({tile.mesh.positions, tile.mesh.triangles}, points, full, scheduler_);
    }
    for (const Vec3f p : tile.mesh.positions) tile.box.extend(p);
  }

  void simplify(PartMesh& mesh) const {
    const PeerMesh simplified =
        simplify_with_meshoptimizer({mesh.positions, mesh.triangles, {}}, config_.tile_triangles);
    if (simplified.triangles.empty()) return;  // it may remain as it is
    std::vector<Triangle> of_surface;
    for (const auto& [v] : simplified.triangles)
      of_surface.push_back({{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]}});
    mesh = part_mesh(of_surface, surface_.positions);
  }

  void add_children(TileNode& tile) const {
    for (std::uint32_t c = 0; c < tile.child_count; ++c) {
      const TileNode& child = tiles_[tile.first_child + c];
      tile.box.extend(child.box);
      tile.error = std::max(tile.error, child.error);
    }
  }

  const WeldedSurface& surface_;
  TileTreeConfig config_;
  Scheduler& scheduler_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint64_t> code_;  // of each
  std::vector<Cube> cubes_;
  std::vector<TileNode> tiles_;
};

// The border with its direction in the triangles.
std::vector<std::pair<std::uint32_t, std::uint32_t>> open_edges(const PartMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& [v] : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(v[k], v[(k + 1) % 3]);
  std::ranges::sort(edges);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open;
  for (const auto& [a, b] : edges)
    if (!std::ranges::binary_search(edges, std::pair(b, a))) open.emplace_back(a, b);
  return open;
}

}  // namespace

std::vector<TileNode> build_tile_tree(const WeldedSurface& surface, const TileTreeConfig& config,
                                      Scheduler& scheduler) {
  if (surface.triangles.empty()) return {};
  return TreeBuilder(surface, config, scheduler).build();
}

std::vector<std::uint8_t> border_vertices(const WeldedSurface& surface) {
  std::vector<Vec3d> places;
  for (const Vec3f p : surface.positions) places.push_back(to_double(p));
  std::vector<std::uint8_t> on_border(places.size(), 0);
  for (const BorderEdge& edge : border_edges(places, surface.triangles))
    for (const std::uint32_t v : edge.vertex) on_border[v] = 1;
  return on_border;
}

Skirt skirt_of(const TileNode& tile, const WeldedSurface& surface, std::span<const std::uint8_t> on_border) {
  Skirt skirt;
  const auto hang = [&](std::uint32_t v) {
    const std::uint32_t of_surface = tile.mesh.vertices[v];
    const Vec3f top = tile.mesh.positions[v], normal = unpack_normal(surface.normals[of_surface]);
    skirt.positions.push_back(top);
    skirt.positions.push_back(top - static_cast<float>(tile.gap) * normal);
    skirt.normals.insert(skirt.normals.end(), 2, surface.normals[of_surface]);
    return static_cast<std::uint32_t>(skirt.positions.size() - 2);
  };
  for (const auto& [a, b] : open_edges(tile.mesh)) {
    if (on_border[tile.mesh.vertices[a]] && on_border[tile.mesh.vertices[b]]) continue;
    const std::uint32_t from = hang(a), to = hang(b);  // and the vertices below them
    skirt.triangles.push_back({{to, from, from + 1}});
    skirt.triangles.push_back({{to, from + 1, to + 1}});
  }
  return skirt;
}

std::vector<std::uint32_t> tiles_for(std::span<const TileNode> tiles, Vec3f viewpoint, double reach) {
  std::vector<std::uint32_t> drawn, open;
  if (!tiles.empty()) open.push_back(0);
  while (!open.empty()) {
    const std::uint32_t t = open.back();
    open.pop_back();
    const TileNode& tile = tiles[t];
    const bool enough = tile.error * reach <= distance(DistanceMetric::euclidean, viewpoint, tile.box);
    if (enough || tile.child_count == 0)
      drawn.push_back(t);
    else
      for (std::uint32_t c = 0; c < tile.child_count; ++c) open.push_back(tile.first_child + c);
  }
  std::ranges::sort(drawn);
  return drawn;
}

}  // namespace lodestone
