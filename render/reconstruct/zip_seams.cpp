// Zipping in tiles of space: each is a task (zip_tile.h); what they find is added by one. A tile leaves alone what
// might depend on its neighbours. Eight tilings, shifted by half a tile along some of the axes, leave nothing over: of
// two cuts of an axis half a tile apart one is far enough from any point.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "render/reconstruct/vertex_grid.h"
#include "render/reconstruct/zip_tile.h"

namespace lodestone {
namespace {

using TileKey = std::array<std::int32_t, 3>;

class Tiling {
 public:
  Tiling(float side, int shift) : side_(side) {
    for (int axis = 0; axis < 3; ++axis) offset_[axis] = (shift >> axis & 1) != 0 ? 0.5f * side : 0;
  }
  [[nodiscard]] TileKey key(Vec3f p) const { return {along(p.x, 0), along(p.y, 1), along(p.z, 2)}; }
  [[nodiscard]] ZipBox box(const TileKey& k) const {
    return {{corner(k[0], 0), corner(k[1], 1), corner(k[2], 2)}, side_};
  }

 private:
  [[nodiscard]] std::int32_t along(float p, int axis) const {
    return static_cast<std::int32_t>(std::floor((p + offset_[axis]) / side_));
  }
  [[nodiscard]] float corner(std::int32_t k, int axis) const { return static_cast<float>(k) * side_ - offset_[axis]; }
  float side_;
  std::array<float, 3> offset_{};
};

struct Tile {
  ZipBox box;
  std::vector<std::uint32_t> vertices, edges;
};

class Zipper {
 public:
  Zipper(SeamMesh& seam, const ZipConfig& config, Scheduler& scheduler)
      : s_(seam), config_(config), scheduler_(scheduler), reach_(config.reach * config.spacing) {}

  std::size_t run() {
    for (std::uint32_t e = 0; e < s_.borders.edge_count(); ++e) {
      if (!s_.borders.alive(e)) continue;
      const auto [from, to] = std::pair(s_.borders.edge(e).from, s_.borders.edge(e).to);
      s_.borders.set_tried(e, !config_.rims && s_.rim[from] && s_.rim[to]);
      pending_.push_back(e);
    }
    zip_pending();
    while (s_.borders.handles() < config_.most_handles && make_handle()) zip_pending();
    return added_;
  }

 private:
  void zip_pending() {
    for (bool changed = true; changed;) {
      const std::size_t before = added_;
      for (int shift = 0; shift < 8; ++shift) zip_tiles(Tiling(config_.tile * config_.spacing, shift));
      changed = added_ > before && !pending_.empty();
    }
  }

  void zip_tiles(const Tiling& tiling) {
    const std::vector<Tile> tiles = make_tiles(tiling);
    std::vector<ZipResult> results(tiles.size());
    scheduler_.for_chunks(tiles.size(), 1, [&](ChunkRange range) {
      const Tile& tile = tiles[range.index];
      results[range.index] = zip_tile(s_, s_.borders, config_, {tile.box, tile.vertices, tile.edges});
    });
    commit(results);
    for (const ZipResult& result : results)
      for (const auto& [from, to] : result.tried)
        if (const std::uint32_t e = s_.borders.find(from, to); e != BorderLoops::none) s_.borders.set_tried(e, true);
    std::erase_if(pending_, [&](std::uint32_t e) { return !s_.borders.alive(e) || s_.borders.edge(e).tried; });
  }

  // Of the tiles that have something to do.
  [[nodiscard]] std::vector<Tile> make_tiles(const Tiling& tiling) const {
    std::map<TileKey, Tile> tiles;
    for (const std::uint32_t e : pending_) {
      if (!s_.borders.alive(e) || s_.borders.edge(e).tried) continue;
      const Vec3f middle = 0.5f * (s_.position[s_.borders.edge(e).from] + s_.position[s_.borders.edge(e).to]);
      const TileKey key = tiling.key(middle);
      const ZipBox box = tiling.box(key);
      if (!box.holds_ball(middle, reach_)) continue;
      Tile& tile = tiles[key];
      tile.box = box;
      tile.edges.push_back(e);
    }
    if (!tiles.empty())
      for (std::uint32_t v = 0; v < s_.position.size(); ++v)
        if (s_.borders.first(v) != BorderLoops::none)
          if (const auto at = tiles.find(tiling.key(s_.position[v])); at != tiles.end())
            at->second.vertices.push_back(v);
    std::vector<Tile> list;
    for (auto& [key, tile] : tiles) list.push_back(std::move(tile));
    return list;
  }

  // In the order of their circles, whatever tile they come from: where the surface may have no more handles, the
  // tightest seams are closed first.
  void commit(std::span<const ZipResult> results) {
    std::vector<ZipTriangle> all;
    for (const ZipResult& result : results) all.insert(all.end(), result.triangles.begin(), result.triangles.end());
    std::stable_sort(all.begin(), all.end(),
                     [](const ZipTriangle& s, const ZipTriangle& t) { return s.order < t.order; });
    for (const ZipTriangle& t : all)
      if (!add(t)) deferred_.push_back(t);
  }

  // False: it would make a handle too many.
  bool add(const ZipTriangle& t) {
    const std::uint32_t e = s_.borders.find(t.a, t.b);
    if (e == BorderLoops::none || s_.borders.first(t.c) == BorderLoops::none) return true;  // rests on one left out
    if (config_.most_handles != any_number && s_.borders.makes_handle(e, t.c)) return false;
    force(t, e);
    return true;
  }
  void force(const ZipTriangle& t, std::uint32_t e) {
    if (s_.mesh.add(t.b, t.a, t.c) == EditMesh::none) return;
    ++added_;
    const BorderLoops::Sides sides = s_.borders.add_triangle(e, t.c);
    if (sides.left != BorderLoops::none) pending_.push_back(sides.left);
    if (sides.right != BorderLoops::none) pending_.push_back(sides.right);
  }

  // Closes the seam between two loops of one piece at which most triangles had to be left out. False without any.
  bool make_handle() {
    using Pair = std::pair<std::uint32_t, std::uint32_t>;
    const auto pair_of = [&](const ZipTriangle& t) {
      const std::uint32_t e = s_.borders.find(t.a, t.b), f = s_.borders.first(t.c);
      if (e == BorderLoops::none || f == BorderLoops::none || !s_.borders.makes_handle(e, t.c)) return Pair{0, 0};
      return Pair{std::minmax(s_.borders.edge(e).loop, s_.borders.edge(f).loop)};
    };
    std::map<Pair, std::size_t> count;
    for (const ZipTriangle& t : deferred_)
      if (const Pair pair = pair_of(t); pair.first != pair.second) ++count[pair];
    if (count.empty()) return false;
    const Pair longest = std::max_element(count.begin(), count.end(), [](const auto& s, const auto& t) {
                           return s.second < t.second;
                         })->first;
    const std::size_t before = s_.borders.handles();
    std::vector<ZipTriangle> rest;
    for (const ZipTriangle& t : std::exchange(deferred_, {})) {
      if (s_.borders.handles() == before && pair_of(t) == longest)
        force(t, s_.borders.find(t.a, t.b));
      else if (!add(t))
        rest.push_back(t);
    }
    deferred_.insert(deferred_.end(), rest.begin(), rest.end());
    return true;
  }

  SeamMesh& s_;
  const ZipConfig& config_;
  Scheduler& scheduler_;
  float reach_;
  std::vector<std::uint32_t> pending_;  // border edges for which no triangle was looked for yet
  std::vector<ZipTriangle> deferred_;
  std::size_t added_ = 0;
};

}  // namespace

void mark_rims(std::span<const Vec3f> border, float distance, SeamMesh& seam, Scheduler& scheduler) {
  VertexGrid grid(distance);
  for (std::uint32_t k = 0; k < border.size(); ++k) grid.insert(k, border[k]);
  scheduler.for_chunks(seam.position.size(), 4096, [&](ChunkRange range) {
    for (std::size_t k = range.begin; k < range.end; ++k) {
      seam.rim[k] = 0;
      if (seam.borders.first(static_cast<std::uint32_t>(k)) == BorderLoops::none) continue;
      grid.for_near(seam.position[k], distance, [&](std::uint32_t point) {
        const Vec3f d = border[point] - seam.position[k];
        if (dot(d, d) <= distance * distance) seam.rim[k] = 1;
      });
    }
  });
}

std::size_t zip_seams(SeamMesh& seam, const ZipConfig& config, Scheduler& scheduler) {
  return Zipper(seam, config, scheduler).run();
}

}  // namespace lodestone
