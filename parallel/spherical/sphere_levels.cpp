#include "parallel/spherical/sphere_levels.h"

#include <algorithm>
#include <utility>

#include "core/base/prefetch.h"
#include "core/spherical/parameterize/tetrahedron.h"

namespace lodestone {
namespace {

using spherical::VertexSplit;

constexpr std::size_t split_grain = 64, list_grain = 32768, block_vertices = 512;
constexpr int first_sweeps = 2;  // of vertices that have just come in

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
void SphereLevels::for_chunks(std::size_t count, std::size_t grain, const Body& body) {
  if (count <= grain)
    body(ChunkRange{0, count, 0}, arenas_[0]);
  else
    scheduler_.for_chunks(count, grain,
                          [&](ChunkRange c) { body(c, arenas_[static_cast<std::size_t>(scheduler_.worker_index())]); });
}

bool SphereLevels::run(const spherical::SplitSchedule& schedule, std::span<const Id> base) {
  constexpr double sphere_area = 12.566370614359172;
  spherical::place_tetrahedron(rings_, base, directions_);
  for (std::size_t k = 0; k < base.size(); ++k) colours_[base[k]] = static_cast<std::uint8_t>(k);
  for (std::size_t level = 0; level + 1 < schedule.levels.size(); ++level) {
    const std::size_t vertices = 4 + schedule.waves[schedule.levels[level + 1]];
    state_.least_area = config_.least_area * sphere_area / static_cast<double>(2 * vertices - 4);
    for (std::size_t wave = schedule.levels[level]; wave < schedule.levels[level + 1]; ++wave)
      if (!split(std::span(schedule.splits)
                     .subspan(schedule.waves[wave], schedule.waves[wave + 1] - schedule.waves[wave])))
        return false;
    list_colours();
    build_blocks();
    for (int k = sweeps_at(vertices); k > 0; --k) sweep();
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

bool SphereLevels::split(std::span<const VertexSplit> wave) {
  for_chunks(wave.size(), split_grain, [&](ChunkRange c, progressive::RingArena& arena) {
    split_chunk(wave.subspan(c.begin, c.end - c.begin), arena);
  });
  if (config_.ring_sweeps > 0 && !failed_) relax_rings(wave);
  return !failed_;
}

void SphereLevels::relax_rings(std::span<const VertexSplit> wave) {
  std::vector<std::pair<std::uint8_t, Id>> moving;
  for (const VertexSplit& s : wave) {
    moving.emplace_back(colours_[s.vertex], s.vertex);
    for (const Id x : rings_.ring(s.vertex).neighbours()) moving.emplace_back(colours_[x], x);
  }
  std::sort(moving.begin(), moving.end());
  moving.erase(std::unique(moving.begin(), moving.end()), moving.end());
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

// The vertices of each colour, by number.
void SphereLevels::list_colours() {
  using Counts = std::array<std::uint32_t, 256>;
  std::vector<Counts> first(chunk_count(colours_.size(), list_grain));
  for_chunks(colours_.size(), list_grain, [&](ChunkRange c, progressive::RingArena&) {
    Counts& counts = first[c.index] = {};
    for (std::size_t v = c.begin; v < c.end; ++v) ++counts[colours_[v]];
  });
  Counts total{};
  for (Counts& counts : first)
    for (std::size_t colour = 0; colour < spherical::absent_colour; ++colour)
      counts[colour] = std::exchange(total[colour], total[colour] + counts[colour]);
  std::size_t used = 0;
  while (used < spherical::absent_colour && total[used] > 0) ++used;
  lists_.resize(used);
  for (std::size_t colour = 0; colour < used; ++colour) lists_[colour].resize(total[colour]);
  for_chunks(colours_.size(), list_grain, [&](ChunkRange c, progressive::RingArena&) {
    for (std::size_t v = c.begin; v < c.end; ++v)
      if (const std::uint8_t colour = colours_[v]; colour != spherical::absent_colour)
        lists_[colour][first[c.index][colour]++] = static_cast<Id>(v);
  });
}

void SphereLevels::build_blocks() {
  first_block_.assign(1, 0);
  for (const std::vector<Id>& list : lists_)
    first_block_.push_back(first_block_.back() + chunk_count(list.size(), block_vertices));
  if (blocks_.size() < first_block_.back()) blocks_.resize(first_block_.back());
  for_chunks(first_block_.back(), 1, [&](ChunkRange c, progressive::RingArena&) {
    for (std::size_t k = c.begin; k < c.end; ++k) {
      const std::size_t colour =
          static_cast<std::size_t>(std::upper_bound(first_block_.begin(), first_block_.end(), k) -
                                   first_block_.begin()) -
          1;
      const std::span<const Id> list = lists_[colour];
      const std::size_t begin = (k - first_block_[colour]) * block_vertices;
      kernel_.build(state_, list.subspan(begin, std::min(block_vertices, list.size() - begin)), blocks_[k]);
    }
  });
}

void SphereLevels::sweep() {
  for (std::size_t colour = 0; colour + 1 < first_block_.size(); ++colour) {
    const std::size_t begin = first_block_[colour];
    for_chunks(first_block_[colour + 1] - begin, 1, [&](ChunkRange c, progressive::RingArena&) {
      for (std::size_t k = c.begin; k < c.end; ++k) kernel_.sweep(state_, blocks_[begin + k]);
    });
  }
}

}  // namespace lodestone
