// Zipping in tiles of space: each is a task (zip_tile.h); what they find is added by one. A tile leaves alone what
// might depend on its neighbours. Eight tilings, shifted by half a tile along some of the axes, leave nothing over: of
// two cuts of an axis half a tile apart one is far enough from any point.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/base/sort_unique.h"
#include "render/reconstruct/seams/zip_tile.h"

namespace lodestone {
namespace {

// Cubes of space by a number each; they repeat after 2^20 spacings and more, which is farther than anything reaches.
using TileKey = std::uint64_t;
constexpr TileKey no_tile = static_cast<TileKey>(-1);

class Tiling {
 public:
  Tiling(float side, int shift) : side_(side) {
    for (std::size_t axis = 0; axis < 3; ++axis) offset_[axis] = (shift >> axis & 1) != 0 ? 0.5f * side : 0;
  }
  [[nodiscard]] TileKey key(Vec3f p) const {
    const auto part = [](std::int32_t k) { return static_cast<TileKey>(k) & 0x1F'FFFF; };
    return part(along(p.x, 0)) | part(along(p.y, 1)) << 21 | part(along(p.z, 2)) << 42;
  }
  [[nodiscard]] ZipBox box(Vec3f p) const { return {{corner(p.x, 0), corner(p.y, 1), corner(p.z, 2)}, side_}; }

 private:
  [[nodiscard]] std::int32_t along(float p, std::size_t axis) const {
    return static_cast<std::int32_t>(std::floor((p + offset_[axis]) / side_));
  }
  [[nodiscard]] float corner(float p, std::size_t axis) const {
    return static_cast<float>(along(p, axis)) * side_ - offset_[axis];
  }
  float side_;
  std::array<float, 3> offset_{};
};

struct Tile {
  ZipBox box;
  std::vector<VertexId> vertices;
  std::vector<BorderEdgeId> edges;
};

class Zipper {
 public:
  Zipper(SeamMesh& seam, const ZipConfig& config, Scheduler& scheduler)
      : s_(seam), config_(config), scheduler_(scheduler), reach_(config.reach * config.spacing) {}

  std::size_t run() {
    for (BorderEdgeId e{0}; e < s_.borders.edge_count(); ++e) {
      if (!s_.borders.alive(e)) continue;
      const auto [from, to] = std::pair(s_.borders.edge(e).from, s_.borders.edge(e).to);
      s_.borders.set_tried(e, !config_.rims && !s_.model_border && s_.rim[from] && s_.rim[to]);
      pending_.push_back(e);
      front_.push_back(from);
    }
    sort_unique(front_);
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
    std::erase_if(pending_, [&](BorderEdgeId e) { return !s_.borders.alive(e) || s_.borders.edge(e).tried; });
    sort_unique(pending_);
    const std::vector<Tile> tiles = make_tiles(tiling);
    std::vector<ZipResult> results(tiles.size());
    scheduler_.for_chunks(tiles.size(), 1, [&](ChunkRange range) {
      const Tile& tile = tiles[range.index];
      results[range.index] = zip_tile(s_, s_.borders, config_, {tile.box, tile.vertices, tile.edges});
    });
    commit(results);
    for (const ZipResult& result : results)
      for (const auto& [from, to] : result.tried)
        if (const BorderEdgeId e = s_.borders.find(from, to); e != BorderLoops::none) s_.borders.set_tried(e, true);
  }

  [[nodiscard]] Vec3f middle_of(BorderEdgeId e) const {
    return 0.5f * (s_.position[s_.borders.edge(e).from] + s_.position[s_.borders.edge(e).to]);
  }

  // The tiles that have borders to zip, in the order of their keys.
  [[nodiscard]] std::vector<Tile> make_tiles(const Tiling& tiling) {
    if (pending_.empty()) return {};
    std::erase_if(front_, [&](VertexId v) { return s_.borders.first(v) == BorderLoops::none; });
    std::vector<TileKey> of_edge(pending_.size()), of_vertex(front_.size());
    constexpr std::size_t grain = 4096;
    scheduler_.for_chunks(pending_.size(), grain, [&](ChunkRange range) {
      for (std::size_t k = range.begin; k < range.end; ++k) {
        const Vec3f middle = middle_of(pending_[k]);
        of_edge[k] = tiling.box(middle).holds_ball(middle, reach_) ? tiling.key(middle) : no_tile;
      }
    });
    std::vector<TileKey> keys;
    std::unique_copy(of_edge.begin(), of_edge.end(), std::back_inserter(keys));
    sort_unique(keys);
    if (!keys.empty() && keys.back() == no_tile) keys.pop_back();
    scheduler_.for_chunks(front_.size(), grain, [&](ChunkRange range) {
      for (std::size_t k = range.begin; k < range.end; ++k) of_vertex[k] = tiling.key(s_.position[front_[k]]);
    });
    std::vector<Tile> tiles(keys.size());
    const auto for_tiles = [&](std::span<const TileKey> of, const auto& visit) {
      TileKey last = no_tile;  // neighbours in the list are neighbours in space, mostly
      std::size_t tile = keys.size();
      for (std::size_t k = 0; k < of.size(); ++k) {
        if (of[k] != last) {
          const auto at = std::lower_bound(keys.begin(), keys.end(), last = of[k]);
          tile = at != keys.end() && *at == last ? static_cast<std::size_t>(at - keys.begin()) : keys.size();
        }
        if (tile < keys.size()) visit(tiles[tile], k);
      }
    };
    for_tiles(of_edge, [&](Tile& tile, std::size_t k) {
      if (tile.edges.empty()) tile.box = tiling.box(middle_of(pending_[k]));
      tile.edges.push_back(pending_[k]);
    });
    for_tiles(of_vertex, [&](Tile& tile, std::size_t k) { tile.vertices.push_back(front_[k]); });
    return tiles;
  }

  // If the surface may have no more handles, the tightest seams of all tiles are closed first: by classes of circles,
  // and tile by tile within a class.
  void commit(std::span<const ZipResult> results) {
    std::vector<std::size_t> next(results.size(), 0);
    for (const float largest : {0.75f, 1.0f, 1.5f, 2.0f, std::numeric_limits<float>::infinity()})
      for (std::size_t tile = 0; tile < results.size(); ++tile) {
        const auto& triangles = results[tile].triangles;
        for (std::size_t& k = next[tile]; k < triangles.size() && triangles[k].order <= largest * config_.spacing; ++k)
          if (const ZipTriangle& t = triangles[k]; !add(t) && known_.insert({t.a, t.b, t.c}).second)
            deferred_.push_back(t);
      }
  }

  // False: it would make a handle too many.
  bool add(const ZipTriangle& t) {
    const BorderEdgeId e = s_.borders.find(t.a, t.b);
    if (e == BorderLoops::none || s_.borders.first(t.c) == BorderLoops::none) return true;  // rests on one left out
    if (config_.most_handles != any_number && s_.borders.makes_handle(e, t.c)) return false;
    force(t, e);
    return true;
  }
  void force(const ZipTriangle& t, BorderEdgeId e) {
    if (s_.mesh.add(t.b, t.a, t.c) == EditMesh::none) return;
    ++added_;
    const BorderLoops::Sides sides = s_.borders.add_triangle(e, t.c);
    if (sides.left != BorderLoops::none) pending_.push_back(sides.left);
    if (sides.right != BorderLoops::none) pending_.push_back(sides.right);
  }

  // Closes the seam between two loops of one piece at which the largest number of triangles had to be left out. False
  // if there is none.
  bool make_handle() {
    using Pair = std::pair<std::uint32_t, std::uint32_t>;
    const auto pair_of = [&](const ZipTriangle& t) {
      const BorderEdgeId e = s_.borders.find(t.a, t.b), f = s_.borders.first(t.c);
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
  std::vector<BorderEdgeId> pending_;        // border edges for which no triangle was looked for yet
  std::vector<VertexId> front_;              // vertices of border edges, ascending
  std::vector<ZipTriangle> deferred_;        // triangles that would make a handle too many
  std::set<std::array<VertexId, 3>> known_;  // all that ever were deferred
  std::size_t added_ = 0;
};

}  // namespace

void mark_rims(const ModelBorder& border, SeamMesh& seam, Scheduler& scheduler) {
  seam.model_border = &border;
  scheduler.for_chunks(seam.position.size(), 4096, [&](ChunkRange range) {
    for (std::size_t k = range.begin; k < range.end; ++k)
      seam.rim[k] = seam.borders.first(VertexId(k)) != BorderLoops::none && border.is_near(seam.position[k]);
  });
}

std::size_t zip_seams(SeamMesh& seam, const ZipConfig& config, Scheduler& scheduler) {
  return Zipper(seam, config, scheduler).run();
}

}  // namespace lodestone
