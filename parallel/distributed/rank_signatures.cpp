// Copies of a position meet at the rank of its hash, which finds the cells that use it; rank 0 gets each set of cells
// from each of those ranks once, and numbers them. What a copy's set has become goes back the same way.
#include "parallel/distributed/rank_signatures.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <utility>

#include "core/base/sort_unique.h"
#include "core/hierarchy/model/signature_sets.h"
#include "core/mesh/clean_kernels.h"
#include "parallel/distributed/pieces.h"

namespace lodestone {
namespace {

struct CopyItem {
  Vec3f position;
  CellId cell;
  std::uint32_t vertex;  // among the shared ones of the cell
  float error;
};

std::uint64_t number_of(const CopyItem& item) { return std::uint64_t{item.cell} << 32 | item.vertex; }

// The shared vertices of the own cells, one after the other.
class OwnCopies {
 public:
  OwnCopies(std::span<const RankBorder> own, const Ranks& ranks) : own_(own), ranks_(ranks), first_{0} {
    for (const RankBorder& border : own) first_.push_back(first_.back() + border.positions.size());
  }
  [[nodiscard]] std::uint64_t size() const { return first_.back(); }
  [[nodiscard]] CopyItem item(std::uint64_t copy) const {
    const auto c = static_cast<std::size_t>(std::ranges::upper_bound(first_, copy) - first_.begin()) - 1;
    const RankBorder& border = own_[c];
    const auto k = static_cast<std::uint32_t>(copy - first_[c]);
    return {border.positions[k], border.cell, k, border.errors.empty() ? border.cell_error : border.errors[k]};
  }
  // -0 is 0.
  [[nodiscard]] int meeting(Vec3f p) const {
    return rank_of_hash(hash_of(Vec3f{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}), ranks_);
  }

 private:
  std::span<const RankBorder> own_;
  const Ranks& ranks_;
  std::vector<std::uint64_t> first_;  // by cell, and the end
};

// The copies whose positions meet at this rank.
struct Met {
  std::vector<int> from;  // by copy
  BorderCopies copies;
};

Met meet(const OwnCopies& own, Ranks& ranks) {
  struct Came {
    CopyItem item;
    int from;
  };
  std::vector<Came> came;
  came.reserve(own.size() + own.size() / 16);  // growing would take it twice
  exchange_in_pieces<CopyItem>(
      ranks, own.size(),
      [&](std::uint64_t i, const auto& emit) {
        const CopyItem item = own.item(i);
        emit(own.meeting(item.position), item);
      },
      [&](int from, const std::vector<CopyItem>& some) {
        for (const CopyItem& item : some) came.push_back({item, from});
      });
  std::ranges::sort(came, {}, [](const Came& c) { return number_of(c.item); });
  Met met;
  for (const Came& c : came) {
    met.from.push_back(c.from);
    met.copies.positions.push_back(c.item.position);
    met.copies.cells.push_back(c.item.cell);
    met.copies.errors.push_back(c.item.error);
    met.copies.numbers.push_back(number_of(c.item));
  }
  return met;
}

// At rank 0: the sets that each rank has found.
std::vector<CellSets> gather_sets(const CellSets& own, Ranks& ranks) {
  std::vector<CellSets> parts(static_cast<std::size_t>(ranks.count()));
  exchange_in_pieces<std::uint32_t>(
      ranks, own.cells.size(),
      [&](std::uint64_t s, const auto& emit) {
        emit(0, static_cast<std::uint32_t>(own.first[s]));
        emit(0, static_cast<std::uint32_t>(own.first[s] >> 32));
        emit(0, std::bit_cast<std::uint32_t>(own.errors[s]));
        emit(0, static_cast<std::uint32_t>(own.cells[s].size()));
        for (const CellId cell : own.cells[s]) emit(0, std::uint32_t{cell});
      },
      [&](int from, const std::vector<std::uint32_t>& words) {
        CellSets& part = parts[static_cast<std::size_t>(from)];
        std::vector<CellId> cells;
        for (std::size_t w = 0; w < words.size();) {
          const std::size_t left = words.size() - w;
          if (left < 4 || words[w + 3] > left - 4) throw Error("a message ends within a set of cells");
          part.first.push_back(words[w] | std::uint64_t{words[w + 1]} << 32);
          part.errors.push_back(std::bit_cast<float>(words[w + 2]));
          const std::size_t count = words[w + 3];
          cells.clear();
          for (std::size_t k = 0; k < count; ++k) cells.emplace_back(words[w + 4 + k]);
          part.cells.add(cells);
          w += 4 + count;
        }
      });
  return parts;
}

// The numbers that rank 0 has given to the own sets.
std::vector<std::uint32_t> numbers_of_sets(const LevelSignatures* level, const std::vector<CellSets>& parts,
                                           Ranks& ranks) {
  std::vector<std::pair<int, std::uint32_t>> numbers;  // for a rank, in its order
  for (std::size_t p = 0; level && p < parts.size(); ++p)
    for (std::uint32_t s = 0; s < parts[p].cells.size(); ++s) numbers.emplace_back(p, level->number(p, s));
  std::vector<std::uint32_t> own;
  exchange_in_pieces<std::uint32_t>(
      ranks, numbers.size(), [&](std::uint64_t i, const auto& emit) { emit(numbers[i].first, numbers[i].second); },
      [&](int, const std::vector<std::uint32_t>& some) { own.insert(own.end(), some.begin(), some.end()); });
  return own;
}

// By own copy: what its position's set has become.
std::vector<std::uint32_t> send_back(const OwnCopies& own, const Met& met, std::span<const std::uint32_t> set_of,
                                     Ranks& ranks) {
  ByRank<std::uint32_t> answers = by_rank<std::uint32_t>(ranks);  // those of a rank are in the order of the own copies
  exchange_in_pieces<std::uint32_t>(
      ranks, met.from.size(), [&](std::uint64_t i, const auto& emit) { emit(met.from[i], set_of[i]); },
      [&](int from, const std::vector<std::uint32_t>& some) {
        std::vector<std::uint32_t>& all = answers[static_cast<std::size_t>(from)];
        all.insert(all.end(), some.begin(), some.end());
      });
  std::vector<std::size_t> next(answers.size(), 0);
  std::vector<std::uint32_t> out;
  for (std::uint64_t i = 0; i < own.size(); ++i) {
    const auto meeting = static_cast<std::size_t>(own.meeting(own.item(i).position));
    out.push_back(answers[meeting].at(next[meeting]++));
  }
  return out;
}

std::vector<std::uint8_t> places_of(std::span<const RankBorder> own, std::span<const std::uint32_t> number_of) {
  std::vector<std::uint8_t> places(number_of.size());
  std::size_t first = 0;
  for (const RankBorder& border : own) {
    const auto of_cell = number_of.subspan(first, border.positions.size());
    std::vector<std::uint32_t> sets(of_cell.begin(), of_cell.end());
    std::erase(sets, no_set);
    sort_unique(sets);
    find_places(sets, of_cell, std::span(places).subspan(first, of_cell.size()));
    first += of_cell.size();
  }
  return places;
}

// The places of all cells, in their order, at rank 0.
void gather_places(std::span<const std::uint8_t> own, const LevelBorders& all, std::vector<std::uint8_t>& places,
                   Ranks& ranks) {
  ByRank<std::uint8_t> came = by_rank<std::uint8_t>(ranks);
  exchange_in_pieces<std::uint8_t>(
      ranks, own.size(), [&](std::uint64_t i, const auto& emit) { emit(0, own[i]); },
      [&](int from, const std::vector<std::uint8_t>& some) {
        std::vector<std::uint8_t>& of_rank = came[static_cast<std::size_t>(from)];
        of_rank.insert(of_rank.end(), some.begin(), some.end());
      });
  std::vector<std::size_t> next(came.size(), 0);
  for (const LevelBorders::Owner& owner : all.owners) {
    const auto rank = static_cast<std::size_t>(owner.rank);
    if (next[rank] + owner.shared > came[rank].size())
      throw Error("a rank has told of fewer shared vertices than it has");
    const auto first = came[rank].begin() + static_cast<std::ptrdiff_t>(next[rank]);
    places.insert(places.end(), first, first + owner.shared);
    next[rank] += owner.shared;
  }
}

}  // namespace

void add_rank_signatures(std::span<const RankBorder> own, const LevelBorders& all, Signatures::Table& table,
                         Ranks& ranks) {
  const OwnCopies copies(own, ranks);
  Met met = meet(copies, ranks);
  std::vector<std::uint32_t> set_of(met.from.size());
  const CellSets sets = find_cell_sets(met.copies, set_of);
  met.copies = {};
  const std::vector<CellSets> parts = gather_sets(sets, ranks);
  std::unique_ptr<LevelSignatures> level;
  if (all.level) {
    level = std::make_unique<LevelSignatures>(parts, *all.level, Signatures::most);
    level->append_to(table);
  }
  const std::vector<std::uint32_t> numbers = numbers_of_sets(level.get(), parts, ranks);
  if (numbers.size() != sets.cells.size()) throw Error("a message of another size than expected");
  for (std::uint32_t& set : set_of)
    if (set != no_set) set = numbers[set];
  gather_places(places_of(own, send_back(copies, met, set_of, ranks)), all, table.places, ranks);
}

}  // namespace lodestone
