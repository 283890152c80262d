#include "parallel/spherical/sphere_levels.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/prefetch.h"
#include "core/base/sort_unique.h"
#include "core/spherical/parameterize/tetrahedron.h"
#include "parallel/scheduler/phases.h"

namespace lodestone {
namespace {

using spherical::VertexSplit;

constexpr std::size_t split_grain = 64, list_grain = 32768;
constexpr std::size_t border_vertices = 256;  // of a block
constexpr std::size_t few_vertices = 4096;    // one worker is done with them before others have come
constexpr int first_sweeps = 2;               // of vertices that have just come in
constexpr int sweeps_in_tile = 2;
// Neighbours of a hub hardly move it, and come in one by one: each would sweep all of them again.
constexpr std::uint32_t most_relaxed = 64;

// Tiles fit into the cache with their blocks, and are several for each worker. A small level is one, and has no
// borders, which slow down the way of what the sweeps even out.
std::size_t tile_size(std::size_t vertices) {
  return vertices < few_vertices ? vertices : std::clamp<std::size_t>(vertices / 16, 1024, 4096);
}

}  // namespace

SphereLevels::SphereLevels(progressive::RingMesh& rings, std::span<const AlignedPoint4d> surface,
                           const SphereLevelsConfig& config, Scheduler& scheduler)
    : rings_(rings),
      config_(config),
      scheduler_(scheduler),
      kernel_(spherical::sphere_kernel(config.instructions)),
      directions_(surface.size()),
      state_{.rings = rings, .surface = surface, .directions = directions_, .guard = config.guard},
      colours_(surface.size(), spherical::absent_colour),
      arenas_(static_cast<std::size_t>(scheduler.workers())) {}

// A single chunk needs no scheduler.
template <class Body>
void SphereLevels::in_chunks(std::size_t count, std::size_t grain, const Body& body) {
  if (count <= grain)
    body(ChunkRange{0, count, 0});
  else
    scheduler_.for_chunks(count, grain, body);
}

bool SphereLevels::run(const spherical::SplitSchedule& schedule, std::span<const Id> base) {
  spherical::place_tetrahedron(rings_, base, directions_);
  for (std::size_t k = 0; k < base.size(); ++k) colours_[base[k]] = static_cast<std::uint8_t>(k);
  for (std::size_t level = 0; level + 1 < schedule.levels.size(); ++level) {
    const std::size_t vertices = 4 + schedule.waves[schedule.levels[level + 1]];
    state_.least_area = config_.least_area * (4 * std::numbers::pi) / static_cast<double>(2 * vertices - 4);
    alone_ = scheduler_.workers() == 1 || vertices < few_vertices;
    split(schedule, level);
    if (failed_) return false;
    list_vertices(vertices);
    build_tiles();
    sweep(sweeps_at(vertices));
  }
  return true;
}

// Coarse levels cost next to nothing, and what goes wrong there remains: all levels take at least so many steps, as a
// share of the vertices of the last.
int SphereLevels::sweeps_at(std::size_t vertices) const {
  constexpr double share = 0.1, most = 300;
  const double wanted = share * static_cast<double>(colours_.size()) / static_cast<double>(vertices);
  return std::max(config_.sweeps, static_cast<int>(std::min(wanted, most)));
}

// Around a hub vertices come in one by one: workers would only wait for each other.
void SphereLevels::for_phases(std::span<const std::size_t> ends, const std::function<void(std::size_t)>& body) {
  const bool one_by_one = 2 * ends.back() < 3 * ends.size();
  if (!alone_ && !one_by_one) return run_phases(scheduler_, ends, body);
  for (std::size_t item = 0; item < ends.back(); ++item) body(item);
}

// Wave by wave.
void SphereLevels::split(const spherical::SplitSchedule& schedule, std::size_t level) {
  const std::span splits(schedule.splits);
  std::vector<std::span<const VertexSplit>> chunks;
  std::vector<std::size_t> ends;
  for (std::size_t wave = schedule.levels[level]; wave < schedule.levels[level + 1]; ++wave) {
    const std::size_t end = schedule.waves[wave + 1];
    for (std::size_t begin = schedule.waves[wave]; begin < end; begin += split_grain)
      chunks.push_back(splits.subspan(begin, std::min(split_grain, end - begin)));
    ends.push_back(chunks.size());
  }
  if (config_.ring_sweeps == 0) {
    for_phases(ends, [&](std::size_t k) {
      if (!failed_) split_chunk(chunks[k], arenas_[static_cast<std::size_t>(scheduler_.worker_index())]);
    });
    return;
  }
  for (const auto& chunk : chunks) {
    if (!failed_) split_chunk(chunk, arenas_[0]);
    if (!failed_) relax_rings(chunk);
  }
}

void SphereLevels::relax_rings(std::span<const VertexSplit> wave) {
  std::vector<std::pair<std::uint8_t, Id>> moving;
  for (const VertexSplit& s : wave) {
    moving.emplace_back(colours_[s.vertex], s.vertex);
    for (const Id x : rings_.ring(s.vertex).neighbours())
      if (rings_.ring(x).size <= most_relaxed) moving.emplace_back(colours_[x], x);
  }
  sort_unique(moving);
  std::vector<spherical::SweepBlock> blocks;
  std::vector<Id> vertices;
  for (std::size_t k = 0; k < moving.size(); ++k) {
    vertices.push_back(moving[k].second);
    if (k + 1 < moving.size() && moving[k + 1].first == moving[k].first) continue;
    kernel_.build(state_, vertices, blocks.emplace_back());
    vertices.clear();
  }
  for (int sweeps = 0; sweeps < config_.ring_sweeps; ++sweeps)
    for (const spherical::SweepBlock& block : blocks) kernel_.sweep(state_, block);
}

// Nothing in a wave shares a vertex, so that whatever others do is done elsewhere.
void SphereLevels::split_chunk(std::span<const VertexSplit> chunk, progressive::RingArena& arena) {
  std::vector<Id> vertices;
  for (std::size_t k = 0; k < chunk.size(); ++k) {
    if (k + prefetch_distance < chunk.size()) prefetch(&rings_.ring(chunk[k + prefetch_distance].vertex));
    if (const std::size_t next = k + prefetch_distance / 2; next < chunk.size())
      for (const Id x : std::span(rings_.ring(chunk[next].vertex).ids, chunk[next].ring))
        prefetch(&rings_.ring(x)), prefetch(&directions_[x]);
    const VertexSplit& s = chunk[k];
    rings_.undo(s.vertex, s.target, s.ring, arena);
    const progressive::Ring& ring = rings_.ring(s.vertex);
    const std::uint8_t colour = spherical::free_colour(ring, colours_);
    if (colour == spherical::absent_colour || !spherical::place_vertex(s.vertex, s.target, ring, directions_))
      failed_ = true;
    colours_[s.vertex] = colour;
    vertices.push_back(s.vertex);
  }
  if (failed_) return;
  spherical::SweepBlock block;
  kernel_.build(state_, vertices, block);
  for (int k = 0; k < first_sweeps; ++k) kernel_.sweep(state_, block);
}

// The vertices that are there, in order, and where each is among them.
void SphereLevels::list_vertices(std::size_t count) {
  std::vector<std::size_t> first(chunk_count(colours_.size(), list_grain));
  std::vector<std::uint8_t> last(first.size());
  in_chunks(colours_.size(), list_grain, [&](ChunkRange c) {
    for (std::size_t v = c.begin; v < c.end; ++v)
      if (colours_[v] != spherical::absent_colour)
        ++first[c.index], last[c.index] = std::max(last[c.index], colours_[v]);
  });
  colour_count_ = std::size_t{*std::max_element(last.begin(), last.end())} + 1;
  std::exclusive_scan(first.begin(), first.end(), first.begin(), std::size_t{0});
  vertices_.resize(count), rank_.resize(colours_.size());
  in_chunks(colours_.size(), list_grain, [&](ChunkRange c) {
    for (std::size_t v = c.begin, rank = first[c.index]; v < c.end; ++v) {
      if (colours_[v] == spherical::absent_colour) continue;
      rank_[v] = static_cast<std::uint32_t>(rank);
      vertices_[rank++] = static_cast<Id>(v);
    }
  });
}

// Tiles are ranges of the vertices; those with all neighbours in their tile are inside. They stay in the cache.
void SphereLevels::build_tiles() {
  const std::size_t size = tile_size(vertices_.size());
  tiles_ = chunk_count(vertices_.size(), size);
  if (blocks_.size() < tiles_ * colour_count_) blocks_.resize(tiles_ * colour_count_);
  using Lists = std::vector<std::vector<Id>>;
  std::vector<Lists> borders(tiles_);
  in_chunks(tiles_, 1, [&](ChunkRange c) {
    for (std::size_t tile = c.begin; tile < c.end; ++tile) {
      Lists inside(colour_count_);
      borders[tile].resize(colour_count_);
      for (std::size_t k = tile * size; k < std::min(vertices_.size(), (tile + 1) * size); ++k) {
        const Id v = vertices_[k];
        const auto ring = rings_.ring(v).neighbours();
        const bool is_inside = std::all_of(ring.begin(), ring.end(), [&](Id x) { return rank_[x] / size == tile; });
        (is_inside ? inside : borders[tile])[colours_[v]].push_back(v);
      }
      for (std::size_t colour = 0; colour < colour_count_; ++colour)
        kernel_.build(state_, inside[colour], blocks_[tile * colour_count_ + colour]);
    }
  });
  build_borders(borders);
}

// All borders together, by colour.
void SphereLevels::build_borders(std::span<const std::vector<std::vector<Id>>> borders) {
  std::vector<std::vector<Id>> lists(colour_count_);
  first_border_.assign(1, 0);
  for (std::size_t colour = 0; colour < colour_count_; ++colour) {
    for (const auto& border : borders)
      lists[colour].insert(lists[colour].end(), border[colour].begin(), border[colour].end());
    first_border_.push_back(first_border_.back() + chunk_count(lists[colour].size(), border_vertices));
  }
  if (border_blocks_.size() < first_border_.back()) border_blocks_.resize(first_border_.back());
  in_chunks(first_border_.back(), 1, [&](ChunkRange c) {
    for (std::size_t k = c.begin; k < c.end; ++k) {
      const auto colour = static_cast<std::size_t>(std::upper_bound(first_border_.begin(), first_border_.end(), k) -
                                                   first_border_.begin() - 1);
      const std::span<const Id> list = lists[colour];
      const std::size_t begin = (k - first_border_[colour]) * border_vertices;
      kernel_.build(state_, list.subspan(begin, std::min(border_vertices, list.size() - begin)), border_blocks_[k]);
    }
  });
}

// The insides of the tiles, some times over, without a look at each other; then the borders as often.
void SphereLevels::sweep(int times) {
  struct Item {
    const spherical::SweepBlock* blocks;
    std::size_t count;
    int times;
  };
  std::vector<Item> items;
  std::vector<std::size_t> ends;
  for (int done = 0; done < times; done += sweeps_in_tile) {
    const int now = std::min(sweeps_in_tile, times - done);
    for (std::size_t tile = 0; tile < tiles_; ++tile)
      items.push_back({&blocks_[tile * colour_count_], colour_count_, now});
    ends.push_back(items.size());
    for (int k = 0; k < now; ++k)
      for (std::size_t colour = 0; colour < colour_count_; ++colour) {
        for (std::size_t b = first_border_[colour]; b < first_border_[colour + 1]; ++b)
          items.push_back({&border_blocks_[b], 1, 1});
        ends.push_back(items.size());
      }
  }
  for_phases(ends, [&](std::size_t k) {
    for (int again = 0; again < items[k].times; ++again)
      for (const spherical::SweepBlock& block : std::span(items[k].blocks, items[k].count))
        kernel_.sweep(state_, block);
  });
}

}  // namespace lodestone
