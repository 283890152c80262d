// Copies of a position meet at the rank of its hash, which finds the cells that use it; equal sets of cells then meet
// at the rank of theirs, from which rank 0 gets each once, and numbers them. What a copy's set has become goes back the
// same way.
#include "parallel/distributed/rank_signatures.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <utility>

#include "core/base/sort_unique.h"
#include "core/hierarchy/model/signature_sets.h"
#include "core/mesh/clean_kernels.h"
#include "parallel/distributed/messages/pieces.h"

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
  OwnCopies(std::span<const RankBorder> own, const ReadBorder& read, const Ranks& ranks)
      : own_(own), read_(read), ranks_(ranks), first_{0} {
    for (const RankBorder& border : own) first_.push_back(first_.back() + border.shared);
  }
  [[nodiscard]] std::uint64_t size() const { return first_.back(); }
  // Reads the border of its cell, unless that was the last one, too.
  [[nodiscard]] CopyItem item(std::uint64_t copy) {
    const auto c = static_cast<std::size_t>(std::ranges::upper_bound(first_, copy) - first_.begin()) - 1;
    if (c != at_hand_) border_ = read_(at_hand_ = c);
    const auto k = static_cast<std::uint32_t>(copy - first_[c]);
    return {border_.positions[k], own_[c].cell, k, border_.errors.empty() ? border_.cell_error : border_.errors[k]};
  }
  // The rank at which all copies of a position meet, and in which of so many turns. -0 is 0.
  struct Meeting {
    int rank;
    std::uint64_t turn;
  };
  [[nodiscard]] Meeting meeting(Vec3f p, std::uint64_t turns) const {
    const std::uint64_t hash = hash_of(Vec3f{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f});
    return {rank_of_hash(hash, ranks_), turn_of_hash(hash, turns)};
  }

 private:
  std::span<const RankBorder> own_;
  const ReadBorder& read_;
  std::size_t at_hand_ = ~std::size_t{0};
  SharedBorder border_;
  const Ranks& ranks_;
  std::vector<std::uint64_t> first_;  // by cell, and the end
};

// The copies whose positions meet at this rank in a turn.
struct Met {
  std::vector<int> from;  // by copy
  BorderCopies copies;
};

struct Turn {
  std::uint64_t index, count;
};

Met meet(OwnCopies& own, const Turn& turn, Ranks& ranks) {
  struct Came {
    CopyItem item;
    int from;
  };
  std::vector<Came> came;
  came.reserve((own.size() + own.size() / 16) / turn.count);  // growing would take it twice
  exchange_in_pieces<CopyItem>(
      ranks, own.size(),
      [&](std::uint64_t i, const auto& emit) {
        const CopyItem item = own.item(i);
        const auto [rank, at] = own.meeting(item.position, turn.count);
        if (at == turn.index) emit(rank, item);
      },
      [&](int from, const std::vector<CopyItem>& some) {
        for (const CopyItem& item : some) came.push_back({item, from});
      });
  std::ranges::sort(came, {}, [](const Came& c) { return number_of(c.item); });
  Met met;
  met.from.reserve(came.size());
  met.copies.positions.reserve(came.size()), met.copies.cells.reserve(came.size());
  met.copies.errors.reserve(came.size()), met.copies.numbers.reserve(came.size());
  for (const Came& c : came) {
    met.from.push_back(c.from);
    met.copies.positions.push_back(c.item.position);
    met.copies.cells.push_back(c.item.cell);
    met.copies.errors.push_back(c.item.error);
    met.copies.numbers.push_back(number_of(c.item));
  }
  return met;
}

// The sets of several lists as one, each once. Writes by list, by set, its number there.
CellSets united(const std::vector<CellSets>& lists, std::vector<std::vector<std::uint32_t>>& number) {
  struct Place {
    std::uint32_t list, set;
  };
  std::vector<Place> order;
  for (std::uint32_t l = 0; l < lists.size(); ++l) {
    for (std::uint32_t s = 0; s < lists[l].cells.size(); ++s) order.push_back({l, s});
    number.emplace_back(lists[l].cells.size());
  }
  const auto cells_of = [&](const Place& place) { return lists[place.list].cells[place.set]; };
  std::ranges::sort(order, [&](const Place& a, const Place& b) {
    return std::ranges::lexicographical_compare(cells_of(a), cells_of(b));
  });
  CellSets out;
  for (const Place& place : order) {
    const CellSets& list = lists[place.list];
    if (out.first.empty() || !std::ranges::equal(out.cells[out.cells.size() - 1], cells_of(place))) {
      out.cells.add(cells_of(place));
      out.first.push_back(list.first[place.set]), out.errors.push_back(0);
    }
    out.first.back() = std::min(out.first.back(), list.first[place.set]);
    out.errors.back() = std::max(out.errors.back(), list.errors[place.set]);
    number[place.list][place.set] = static_cast<std::uint32_t>(out.first.size() - 1);
  }
  return out;
}

// The rank at which all meet that have found a set.
int rank_of_set(std::span<const CellId> cells, const Ranks& ranks) {
  return rank_of_hash(hash_of(cells) * 0x9e37'79b9'7f4a'7c15u, ranks);  // whose upper bits the last cell has reached
}

// Sends every set to the rank to(its cells); returns by rank what has come from it, in its order.
template <class To>
std::vector<CellSets> exchange_sets(const CellSets& own, const To& to, Ranks& ranks) {
  std::vector<CellSets> parts(static_cast<std::size_t>(ranks.count()));
  exchange_in_pieces<std::uint32_t>(
      ranks, own.cells.size(),
      [&](std::uint64_t s, const auto& emit) {
        const int rank = to(own.cells[s]);
        emit(rank, static_cast<std::uint32_t>(own.first[s]));
        emit(rank, static_cast<std::uint32_t>(own.first[s] >> 32));
        emit(rank, std::bit_cast<std::uint32_t>(own.errors[s]));
        emit(rank, static_cast<std::uint32_t>(own.cells[s].size()));
        for (const CellId cell : own.cells[s]) emit(rank, std::uint32_t{cell});
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

// Makes signatures of the own sets and returns their numbers. Ranks that have found the same set meet, so
// that rank 0 gets it once: the vertices between two cells lie at any ranks.
std::vector<std::uint32_t> number_sets(const CellSets& own, const LevelBorders& all, Signatures::Table& table,
                                       Ranks& ranks) {
  const auto meeting = [&](std::span<const CellId> cells) { return rank_of_set(cells, ranks); };
  std::vector<CellSets> met = exchange_sets(own, meeting, ranks);
  std::vector<std::vector<std::uint32_t>> place;  // by rank, by set that came from it
  const CellSets distinct = united(met, place);
  std::vector<CellSets>().swap(met);
  const std::vector<CellSets> parts = exchange_sets(
      distinct, [](std::span<const CellId>) { return 0; }, ranks);
  std::unique_ptr<LevelSignatures> level;
  if (all.level) {
    level = std::make_unique<LevelSignatures>(parts, *all.level, Signatures::most);
    level->append_to(table);
  }
  const std::vector<std::uint32_t> numbers = numbers_of_sets(level.get(), parts, ranks);
  if (numbers.size() != distinct.cells.size()) throw Error("a message of another size than expected");

  std::vector<std::pair<int, std::uint32_t>> answers;  // for a rank, in its order
  for (std::size_t r = 0; r < place.size(); ++r)
    for (const std::uint32_t set : place[r]) answers.emplace_back(static_cast<int>(r), numbers[set]);
  ByRank<std::uint32_t> came = by_rank<std::uint32_t>(ranks);
  exchange_in_pieces<std::uint32_t>(
      ranks, answers.size(), [&](std::uint64_t i, const auto& emit) { emit(answers[i].first, answers[i].second); },
      [&](int from, const std::vector<std::uint32_t>& some) {
        std::vector<std::uint32_t>& of_rank = came[static_cast<std::size_t>(from)];
        of_rank.insert(of_rank.end(), some.begin(), some.end());
      });
  std::vector<std::size_t> next(came.size(), 0);
  std::vector<std::uint32_t> out;
  for (std::size_t s = 0; s < own.cells.size(); ++s) {
    const auto from = static_cast<std::size_t>(meeting(own.cells[s]));
    out.push_back(came[from].at(next[from]++));
  }
  return out;
}

// The copies of all turns, in the order in which they met: the rank of each, and the number of its position's set.
struct Numbered {
  std::vector<int> from;
  std::vector<std::uint32_t> set_of;
  std::vector<std::size_t> end_of_turn;
};

// By own copy: what its position's set has become.
std::vector<std::uint32_t> send_back(OwnCopies& own, const Numbered& met, Ranks& ranks) {
  ByRank<std::uint32_t> answers = by_rank<std::uint32_t>(ranks);  // of a rank: by turn, in the order of the own copies
  exchange_in_pieces<std::uint32_t>(
      ranks, met.from.size(), [&](std::uint64_t i, const auto& emit) { emit(met.from[i], met.set_of[i]); },
      [&](int from, const std::vector<std::uint32_t>& some) {
        std::vector<std::uint32_t>& all = answers[static_cast<std::size_t>(from)];
        all.insert(all.end(), some.begin(), some.end());
      });
  std::vector<std::size_t> next(answers.size(), 0);
  std::vector<std::uint32_t> out(own.size());
  const std::uint64_t turns = met.end_of_turn.size();
  for (std::uint64_t turn = 0; turn < turns; ++turn)
    for (std::uint64_t i = 0; i < own.size(); ++i) {
      const auto [rank, at] = own.meeting(own.item(i).position, turns);
      const auto from = static_cast<std::size_t>(rank);
      if (at == turn) out[i] = answers[from].at(next[from]++);
    }
  return out;
}

std::vector<std::uint8_t> places_of(std::span<const RankBorder> own, std::span<const std::uint32_t> number_of) {
  std::vector<std::uint8_t> places(number_of.size());
  std::size_t first = 0;
  for (const RankBorder& border : own) {
    const auto of_cell = number_of.subspan(first, border.shared);
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

void add_rank_signatures(std::span<const RankBorder> own, const ReadBorder& read, const LevelBorders& all,
                         Signatures::Table& table, Ranks& ranks, std::uint64_t most_copies) {
  OwnCopies copies(own, read, ranks);
  const std::uint64_t turns = std::min(most_turns, ranks.maximum(copies.size() / most_copies + 1));
  Numbered met;
  std::vector<CellSets> found;  // by turn
  for (std::uint64_t turn = 0; turn < turns; ++turn) {
    Met now = meet(copies, {turn, turns}, ranks);
    const std::size_t before = met.set_of.size();
    met.from.insert(met.from.end(), now.from.begin(), now.from.end());
    met.set_of.resize(met.from.size());
    met.end_of_turn.push_back(met.from.size());
    found.push_back(find_cell_sets(now.copies, std::span(met.set_of).subspan(before)));
  }
  std::vector<std::vector<std::uint32_t>> number;
  const CellSets sets = united(found, number);
  std::vector<CellSets>().swap(found);
  const std::vector<std::uint32_t> numbers = number_sets(sets, all, table, ranks);
  std::size_t copy = 0;
  for (std::size_t turn = 0; turn < turns; ++turn)
    for (; copy < met.end_of_turn[turn]; ++copy)
      if (std::uint32_t& set = met.set_of[copy]; set != no_set) set = numbers[number[turn][set]];
  gather_places(places_of(own, send_back(copies, met, ranks)), all, table.places, ranks);
}

}  // namespace lodestone
