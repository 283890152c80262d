// Follows the cells as build_rank_levels does: a block runs where CellOwners says, and its cells go, by code and in
// rounds of exchange_round_bytes, to the ranks of the next coarser blocks.
#include "parallel/distributed/plan_ranks.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <random>

#include "core/hierarchy/construct/cell_table.h"
#include "core/hierarchy/model/find_signatures.h"
#include "parallel/distributed/cell_message.h"
#include "parallel/distributed/cell_owners.h"
#include "parallel/distributed/rank_blocks.h"
#include "parallel/distributed/rank_save.h"
#include "parallel/hierarchy/partition.h"

namespace lodestone {
namespace {

// Numbers of the triangles that are looked at, ascending, of so many that are numbered cell by cell.
std::vector<std::uint64_t> sample_numbers(std::uint64_t triangles, std::uint64_t seed) {
  const std::uint64_t stride = level_sample_stride(triangles);
  std::vector<std::uint64_t> numbers((triangles + stride - 1) / stride);
  for (std::uint64_t i = 0; i < numbers.size(); ++i) numbers[i] = i * stride;
  if (seed == 0 || stride == 1) return numbers;
  std::mt19937_64 random(seed);
  for (std::uint64_t& number : numbers) number = random() % triangles;
  std::ranges::sort(numbers);
  return numbers;
}

std::vector<CellCode> sample_cells(std::span<const Cell> finest, const std::vector<std::uint64_t>& numbers) {
  std::vector<CellCode> sample;
  sample.reserve(numbers.size());
  std::uint64_t end = 0;
  for (const Cell& cell : finest) {
    end += cell.triangles.size();
    while (sample.size() < numbers.size() && numbers[sample.size()] < end) sample.push_back(cell.code);
  }
  return sample;
}

double imbalance_of(const std::vector<std::uint64_t>& values) {
  const std::uint64_t sum = std::accumulate(values.begin(), values.end(), std::uint64_t{0});
  return sum == 0 ? 1
                  : static_cast<double>(std::ranges::max(values)) * static_cast<double>(values.size()) /
                        static_cast<double>(sum);
}

// The bytes that a rank sends to each other one in a round.
class SentRound {
 public:
  explicit SentRound(std::size_t ranks) : to_(ranks, 0) {}
  void add(int to, std::uint64_t bytes) {
    std::uint64_t& message = to_[static_cast<std::size_t>(to)];
    if (message == 0) touched_.push_back(to);
    message += bytes, sum_ += bytes;
  }
  [[nodiscard]] bool full() const { return sum_ >= exchange_round_bytes; }
  // Returns the largest message.
  std::uint64_t end() {
    std::uint64_t largest = 0;
    for (const int to : touched_) largest = std::max(largest, std::exchange(to_[static_cast<std::size_t>(to)], 0));
    touched_.clear(), sum_ = 0;
    return largest;
  }

 private:
  std::vector<std::uint64_t> to_;
  std::vector<int> touched_;
  std::uint64_t sum_ = 0;
};

class Planning {
 public:
  Planning(const Hierarchy& hierarchy, const PlanConfig& config)
      : hierarchy_(hierarchy), finest_(hierarchy.finest()), numbers_(sample_numbers(finest_triangles(), config.seed)) {
    plan_.ranks = config.ranks;
    plan_.samples = numbers_.size();
    const CellOwners owners(finest_, sample_cells(hierarchy.cells_of(finest_), numbers_), config.ranks,
                            hierarchy.grids);
    for (int l = 0; l <= finest_; ++l)
      for (const Cell& cell : hierarchy.cells_of(l)) owner_.push_back(owners.owner(cell.code, l));
  }

  RankPlan plan() && {
    for (int l = 0; l <= finest_; ++l) plan_.levels.push_back(level_plan(l));
    plan_.imbalance = imbalance_of(triangles_of_ranks(finest_));
    count_border();
    count_tables();
    return std::move(plan_);
  }

 private:
  [[nodiscard]] std::uint64_t finest_triangles() const { return hierarchy_.levels.back().triangles; }
  [[nodiscard]] std::size_t ranks() const { return static_cast<std::size_t>(plan_.ranks); }
  [[nodiscard]] std::vector<std::uint64_t> zero_by_rank() const { return std::vector<std::uint64_t>(ranks(), 0); }
  [[nodiscard]] const Level& level(int l) const { return hierarchy_.levels[static_cast<std::size_t>(l)]; }

  [[nodiscard]] std::vector<std::uint64_t> triangles_of_ranks(int l) const {
    std::vector<std::uint64_t> triangles = zero_by_rank();
    for (CellId c = level(l).first_cell; c < level(l).end_cell(); ++c)
      triangles[static_cast<std::size_t>(owner_[c])] += hierarchy_.cells[c].triangles.size();
    return triangles;
  }

  // The rank that makes a cell above the finest level has its children.
  [[nodiscard]] int maker(CellId cell) const { return owner_[hierarchy_.cells[cell].first_child]; }

  LevelPlan level_plan(int l) const {
    LevelPlan out;
    out.cells = level(l).cell_count, out.triangles = level(l).triangles, out.blocks = count_blocks(l);
    std::vector<std::uint64_t> has_cells = zero_by_rank();
    for (CellId c = level(l).first_cell; c < level(l).end_cell(); ++c)
      has_cells[static_cast<std::size_t>(owner_[c])] = 1;
    out.busy_ranks = static_cast<int>(std::accumulate(has_cells.begin(), has_cells.end(), std::uint64_t{0}));
    out.most_triangles = std::ranges::max(triangles_of_ranks(l));
    if (l < finest_) move_cells(l, out);
    return out;
  }

  void move_cells(int l, LevelPlan& out) const {
    std::vector<std::vector<CellId>> made(ranks());
    for (CellId c = level(l).first_cell; c < level(l).end_cell(); ++c)
      made[static_cast<std::size_t>(maker(c))].push_back(c);
    std::vector<std::uint64_t> received = zero_by_rank();
    SentRound round(ranks());
    for (const std::vector<CellId>& cells : made) {
      std::uint64_t sent = 0, rounds = 1;
      for (const CellId c : cells) {
        if (round.full()) out.largest_message = std::max(out.largest_message, round.end()), ++rounds;
        const int owner = owner_[c];
        if (owner == maker(c)) continue;
        const std::uint64_t bytes = message_bytes(hierarchy_.cells[c]);
        round.add(owner, bytes);
        received[static_cast<std::size_t>(owner)] += bytes;
        sent += bytes, ++out.moved_cells;
      }
      out.largest_message = std::max(out.largest_message, round.end());
      out.moved_bytes += sent;
      out.most_sent = std::max(out.most_sent, sent);
      out.rounds = std::max(out.rounds, rounds);
    }
    out.most_received = std::ranges::max(received);
  }

  [[nodiscard]] std::uint64_t message_bytes(const Cell& cell) const {
    return cell_message_bytes(
        {cell.positions.size(), cell.shared_ids.size(), cell.triangles.size(), hierarchy_.attributes});
  }

  // Those that consume cells of the level; the root counts as one.
  [[nodiscard]] std::uint64_t count_blocks(int l) const {
    if (l == 0) return 1;
    std::vector<std::uint64_t> blocks;
    for (const Cell& cell : hierarchy_.cells_of(l))
      blocks.push_back(CellCode::from(block_of_parent(hierarchy_.grids.parent(cell.code, l).coord(),
                                                      hierarchy_.grids.keeps_cells(l)))
                           .morton);
    std::ranges::sort(blocks);
    return static_cast<std::uint64_t>(std::unique(blocks.begin(), blocks.end()) - blocks.begin());
  }

  // By signature of the finest level: over how many cells of each rank its vertices are spread.
  void count_border() {
    const std::shared_ptr<const Signatures> signatures = signatures_of(hierarchy_);
    std::vector<double> vertices(ranks(), 0);
    for (CellId c = level(finest_).first_cell; c < level(finest_).end_cell(); ++c) {
      const std::span<const std::uint32_t> own = signatures->of(c);
      std::vector<double> share(own.size(), 0);  // of a vertex of the signature that counts for this cell
      for (std::size_t s = 0; s < own.size(); ++s) {
        const std::span<const CellId> users = signatures->users(own[s]).cells;
        const auto here = std::ranges::count_if(users, [&](CellId user) { return owner_[user] == owner_[c]; });
        if (static_cast<std::size_t>(here) < users.size()) share[s] = 1 / static_cast<double>(here);
      }
      for (const std::uint8_t place : signatures->places(c))
        vertices[static_cast<std::size_t>(owner_[c])] += share[place];
    }
    double sum = 0;
    for (const double of_rank : vertices) sum += of_rank;
    plan_.border_vertices = static_cast<std::uint64_t>(sum + 0.5);
    plan_.most_border_vertices = static_cast<std::uint64_t>(std::ranges::max(vertices) + 0.5);
  }

  void count_tables() {
    std::uint64_t shared = 0;
    for (const Cell& cell : hierarchy_.cells) shared += cell.shared_ids.size();
    plan_.first_rank_bytes = table_bytes_per_cell * hierarchy_.cells.size() + table_bytes_per_shared * shared;
  }

  const Hierarchy& hierarchy_;
  int finest_;
  std::vector<std::uint64_t> numbers_;
  std::vector<int> owner_;  // by cell
  RankPlan plan_;
};

}  // namespace

std::uint64_t RankPlan::moved_bytes() const {
  std::uint64_t sum = 0;
  for (const LevelPlan& level : levels) sum += level.moved_bytes;
  return sum;
}

RankPlan plan_ranks(const Hierarchy& hierarchy, const PlanConfig& config) {
  assert(config.ranks >= 1);
  return Planning(hierarchy, config).plan();
}

}  // namespace lodestone
