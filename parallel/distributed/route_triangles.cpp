#include "parallel/distributed/route_triangles.h"

#include <algorithm>
#include <deque>
#include <utility>

#include "parallel/hierarchy/build_blocks.h"
#include "parallel/hierarchy/partition.h"

namespace lodestone {
namespace {

// The answer of the owner of a vertex of the input.
struct VertexAnswer {
  Vec3f position;
  std::uint32_t number;
};

// The triangles that are left of a part of the slice, with the positions and numbers of their corners.
class PieceMesh {
 public:
  PieceMesh(std::vector<Triangle>&& triangles, const CleanSlices& clean, Ranks& ranks) : corners_(triangles) {
    answers_ = Question(ranks, clean.vertices, corners_.vertices()).answer<VertexAnswer>([&](std::uint32_t v) {
      return VertexAnswer{clean.positions[v], clean.numbers[v]};
    });
    count_ = triangles.size();
  }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] CellCode cell(std::size_t triangle, int grid) const {
    const auto& v = corners_.of(triangle).v;
    return CellCode::from(
        cell_of(barycentre(answers_[v[0]].position, answers_[v[1]].position, answers_[v[2]].position), grid));
  }
  [[nodiscard]] Triangle numbers(std::size_t triangle) const {
    const auto& v = corners_.of(triangle).v;
    return {{answers_[v[0]].number, answers_[v[1]].number, answers_[v[2]].number}};
  }

 private:
  PieceCorners corners_;
  std::vector<VertexAnswer> answers_;
  std::size_t count_ = 0;
};

// By triangle that is looked at: where it is in the slice.
std::vector<std::uint32_t> sample_slice(const CleanSlices& clean, Ranks& ranks) {
  const std::vector<std::uint64_t> left = ranks.gather(clean.own_triangles);
  std::uint64_t number = Slices(left).begin(ranks.rank());  // among the triangles that are left
  const std::uint64_t stride = level_sample_stride(clean.triangles_left);
  std::vector<std::uint32_t> sample;
  const auto own = static_cast<std::uint32_t>(clean.triangles.size(ranks.rank()));
  for (std::uint32_t t = 0; t < own; ++t)
    if (!clean.dropped[t] && number++ % stride == 0) sample.push_back(t);
  return sample;
}

// Cells of max_level of the triangles that this rank looks at, in ascending order.
std::vector<CellCode> sample_cells(const MeshStream& stream, const CleanSlices& clean, Ranks& ranks) {
  const std::uint64_t first = clean.triangles.begin(ranks.rank());
  const std::vector<std::uint32_t> sample = sample_slice(clean, ranks);
  std::vector<CellCode> cells;
  for_pieces(ranks, sample.size(), [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<Triangle> triangles(end - begin);
    for (std::uint64_t i = begin; i < end; ++i)
      stream.read_triangles(first + sample[i], std::span(triangles).subspan(i - begin, 1));
    const PieceMesh piece(std::move(triangles), clean, ranks);
    for (std::size_t t = 0; t < piece.size(); ++t) cells.push_back(piece.cell(t, max_level));
  });
  std::ranges::sort(cells);
  return cells;
}

// A cell, and the number of triangles in it among those that are looked at.
struct CountedCell {
  std::uint64_t code, count;
};

// By all ranks together, the cells of a level; a cell of several ranks once for each of them.
std::vector<CountedCell> cells_of_all(const std::vector<CellCode>& own_sample, int level, Ranks& ranks) {
  std::vector<CountedCell> own, all;
  for (const CellCode finest : own_sample) {
    const std::uint64_t code = finest.morton >> (3 * (max_level - level));
    if (own.empty() || own.back().code != code) own.push_back({code, 0});
    ++own.back().count;
  }
  for (const std::vector<CountedCell>& of_rank : ranks.gather_lists(own))
    all.insert(all.end(), of_rank.begin(), of_rank.end());
  return all;
}

int choose_level(const std::vector<CellCode>& own_sample, std::uint64_t triangles, std::uint32_t cell_triangles,
                 Ranks& ranks) {
  const auto occupied = [&](int level) {
    std::vector<CountedCell> cells = cells_of_all(own_sample, level, ranks);
    std::ranges::sort(cells, {}, &CountedCell::code);
    const auto same = [](const CountedCell& a, const CountedCell& b) { return a.code == b.code; };
    return static_cast<std::size_t>(std::unique(cells.begin(), cells.end(), same) - cells.begin());
  };
  return finest_level_of(occupied, ranks.sum(own_sample.size()), triangles, cell_triangles);
}

// Joins the lists of each rank, in their order, in the order of the ranks.
std::vector<Triangle> joined(std::vector<std::deque<std::vector<Triangle>>>&& by_source) {
  std::size_t count = 0;
  for (const auto& parts : by_source)
    for (const std::vector<Triangle>& part : parts) count += part.size();
  std::vector<Triangle> all;
  all.reserve(count);
  for (auto& parts : by_source)
    for (; !parts.empty(); parts.pop_front()) all.insert(all.end(), parts.front().begin(), parts.front().end());
  return all;
}

// Replaces numbers of vertices by consecutive ones, whose numbers are returned.
std::vector<std::uint32_t> number_locally(std::vector<Triangle>& triangles) {
  KeyNumbers<std::uint32_t> numbers;
  numbers.clear(triangles.size() / 2 + triangles.size() / 16);
  if (!triangles.empty())
    numbers.number({triangles.data()->v.data(), 3 * triangles.size()}, triangles.data()->v.data());
  return {numbers.keys().begin(), numbers.keys().end()};
}

}  // namespace

void exchange_triangles(const MeshStream& stream, const CleanSlices& clean, const FinestChoice& finest, Ranks& ranks,
                        const TakeTriangles& take) {
  const std::uint64_t first = clean.triangles.begin(ranks.rank());
  for_pieces(ranks, clean.triangles.size(ranks.rank()), [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<Triangle> triangles(end - begin);
    stream.read_triangles(first + begin, triangles);
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (!clean.dropped[begin + t]) triangles[kept++] = triangles[t];
    triangles.resize(kept);
    const PieceMesh piece(std::move(triangles), clean, ranks);
    ByRank<Triangle> out = by_rank<Triangle>(ranks);
    for (std::size_t t = 0; t < piece.size(); ++t) {
      const int owner = finest.owners.owner(piece.cell(t, finest.grid), finest.level);
      out[static_cast<std::size_t>(owner)].push_back(piece.numbers(t));
    }
    take(ranks.exchange(out));
  });
}

// Positions of the vertices that are left, in the order of their numbers, and how many ranks ask for each.
void fetch_vertices(CleanSlices&& given, std::span<const std::uint32_t> numbers, Ranks& ranks,
                    const TakeVertices& take) {
  CleanSlices clean = std::move(given);
  std::vector<std::uint32_t>().swap(clean.numbers);
  clean.dropped = BitSet();
  std::vector<Vec3f>& positions = clean.positions;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (clean.left[i]) positions[kept++] = positions[i];
  positions.resize(kept);
  std::vector<std::uint8_t>().swap(clean.left);
  Askers askers(kept);
  const auto ask = [&](const auto& visit) {
    for_pieces(ranks, numbers.size(), [&](std::uint64_t begin, std::uint64_t end) {
      visit(Question(ranks, clean.vertices_left, numbers.subspan(begin, end - begin)));
    });
  };
  ranks.begin("fetching vertices");
  ask([&](const Question& question) {
    askers.add(question);
    take.positions(question.answer<Vec3f>([&](std::uint32_t v) { return positions[v]; }));
  });
  std::vector<Vec3f>().swap(positions);
  ranks.begin("finding shared vertices");
  ask([&](const Question& question) { take.used_by_others(askers.others(question)); });
}

FinestChoice choose_cells(const MeshStream& stream, const CleanSlices& clean, const BuildConfig& config, Ranks& ranks) {
  ranks.begin("choosing cells");
  const std::vector<CellCode> own_sample = sample_cells(stream, clean, ranks);
  const LevelGrids grids = grids_of(config);
  int level = config.finest_level;
  if (level < 0)
    level = grids.finest_level(choose_level(own_sample, clean.triangles_left, config.cell_triangles, ranks));
  const int grid = grids.of(level);
  std::vector<CellCode> sample;
  for (const CountedCell& cell : cells_of_all(own_sample, grid, ranks))
    sample.insert(sample.end(), cell.count, CellCode{cell.code});
  return {level, grid, CellOwners(level, sample, ranks.count(), grids)};
}

RoutedMesh route_triangles(const MeshStream& stream, CleanSlices&& given, const FinestChoice& finest, Ranks& ranks) {
  CleanSlices clean = std::move(given);
  RoutedMesh out;
  ranks.begin("sorting");
  out.vertices = clean.vertices_left;
  out.mesh.transform = clean.transform;
  std::vector<std::deque<std::vector<Triangle>>> came(static_cast<std::size_t>(ranks.count()));
  exchange_triangles(stream, clean, finest, ranks, [&](ByRank<Triangle>&& in) {
    for (std::size_t from = 0; from < in.size(); ++from)
      if (!in[from].empty()) came[from].push_back(std::move(in[from]));
  });
  out.mesh.triangles = joined(std::move(came));
  std::vector<std::uint32_t>().swap(clean.numbers);
  clean.dropped = BitSet();
  out.ids = number_locally(out.mesh.triangles);
  out.mesh.positions.reserve(out.ids.size());
  out.used_by_others.reserve(out.ids.size());
  const auto append = [](auto& all, auto some) { all.insert(all.end(), some.begin(), some.end()); };
  fetch_vertices(std::move(clean), out.ids, ranks,
                 {[&](std::span<const Vec3f> some) { append(out.mesh.positions, some); },
                  [&](std::span<const std::uint8_t> some) { append(out.used_by_others, some); }});
  return out;
}

}  // namespace lodestone
