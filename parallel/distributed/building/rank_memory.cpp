#include "parallel/distributed/building/rank_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/byte_size.h"
#include "core/base/error.h"
#include "core/files/scratch_file.h"
#include "parallel/clean/find_repeats.h"
#include "parallel/hierarchy/shared_vertices.h"
#include "parallel/out_of_core/stored_blocks.h"

namespace lodestone {
namespace {

constexpr std::uint64_t process_bytes = 72 * mebibyte;  // program, MPI, and what is under way between the ranks
constexpr std::uint64_t worker_bytes = 8 * mebibyte;
constexpr std::uint64_t most_part = std::uint64_t{1} << 24;  // triangles
constexpr std::uint64_t fewest_items = std::uint64_t{1} << 16;
constexpr std::uint64_t most_parts = 32;
constexpr std::uint64_t cell_bytes = 400;      // of a rank's own cell; a run of its triangles for each part in addition
constexpr std::uint64_t item_bytes = 32;       // while items are compared
constexpr std::uint64_t slice_bytes = 20;      // by vertex of a slice: position, number, users and two states
constexpr std::uint64_t vertex_bytes = 20;     // by vertex of a rank: position, number in the whole, and sharing
constexpr std::uint64_t copy_bytes = 20;       // by copy of a vertex on a border, always
constexpr std::uint64_t met_copy_bytes = 110;  // while it is compared
constexpr std::uint64_t outer_bytes = 150;     // by vertex of several ranks, while their sums are added up
constexpr std::uint64_t welded_bytes = 100;    // by wedge of a rank, beside what it has read
constexpr std::uint64_t seam_bytes = 280;      // by wedge that a vertex has more than one: few vanish in coarser levels
constexpr std::uint64_t table_bytes = 500;     // by cell of the whole model, at rank 0

std::uint64_t least_part(std::uint64_t triangles) {
  return std::min(triangles, std::max(std::uint64_t{1} << 18, triangles / most_parts));
}

std::uint64_t largest(const Slices& slices, int ranks) {
  std::uint64_t most = 0;
  for (int r = 0; r < ranks; ++r) most = std::max(most, slices.size(r));
  return most;
}

}  // namespace

RankMemory::RankMemory(const RankInput& input, const RankLimit& limit, const BuildConfig& build, Ranks& ranks,
                       int workers)
    : input_(input.stream->name()),
      limit_(limit),
      vertices_(largest(input.vertices, ranks.count())),
      triangles_(largest(input.triangles, ranks.count())),
      all_vertices_(input.stream->vertex_count()),
      all_triangles_(input.stream->triangle_count()),
      wedges_(ranks.maximum(input.surface ? input.surface->wedges : 0)) {
  if (limit_.bytes == 0 && limit_.part == 0) return;
  if (limit_.scratch.empty()) limit_.scratch = ".";
  workers_ = ranks.maximum(static_cast<std::uint64_t>(workers));
  fixed_ = process_bytes + workers_ * worker_bytes + ranks.maximum(input.held_bytes) + triangles_ / 8;
  spills_ = limit_.part > 0 || limit_.bytes < in_core_bytes();
  if (limit_.bytes == 0) limit_.bytes = std::numeric_limits<std::uint64_t>::max() / 2;
  if (!spills_) return;
  if (wedges_ > 0) fail("attributes, which ranks do not put into temporary files, need", in_core_bytes());
  require_limit(build);
  if (!limit_.resume) require_room(ranks);  // else some of them may be there already
}

// Upper bounds of what was measured: 50 bytes a triangle of the own share, half a byte for each of all at rank 0.
// Wedges take the place of the vertices.
std::uint64_t RankMemory::in_core_bytes() const {
  const std::uint64_t more = wedges_ - std::min(vertices_, wedges_);
  return fixed_ + 26 * triangles_ + 52 * (vertices_ + more) + welded_bytes * wedges_ + seam_bytes * more +
         all_triangles_ / 2;
}

std::uint64_t RankMemory::stored_bytes(const BuildConfig& build) const {
  // Shares of ranks are not quite equal, and vertices between them are there twice.
  const std::uint64_t vertices = vertices_ + vertices_ / 32, triangles = triangles_ + triangles_ / 32;
  const double cell = build.finest_level < 0 ? std::max(build.cell_triangles, 2u) : 4000;
  const auto shared =
      static_cast<std::uint64_t>(std::min(1.0, 4 / std::sqrt(cell / 2)) * static_cast<double>(vertices));
  const double stored = build.half_levels ? 2.0 : 4.0 / 3;
  const auto cells_of = [&](std::uint64_t count) {
    return static_cast<std::uint64_t>(stored * static_cast<double>(count) / cell);
  };
  const std::uint64_t block = std::min(all_triangles_, static_cast<std::uint64_t>(48 * cell));
  const std::uint64_t own_cells = cells_of(triangles) * (cell_bytes + 16 * most_parts);
  const std::uint64_t copies = 2 * shared;
  return fixed_ + std::max({slice_bytes * vertices + item_bytes * std::max(triangles, vertices) / most_parts,
                            vertex_bytes * vertices + all_vertices_ / 7 + least_part(triangles) * sizeof(Triangle),
                            own_cells + vertex_bytes * vertices + shared * SharedVertices::peak_bytes_per_vertex,
                            own_cells + vertex_bytes * vertices + shared * SharedVertices::bytes_per_vertex +
                                block * StoredBlocks::bytes_per_triangle,
                            own_cells + cells_of(all_triangles_) * table_bytes + all_triangles_ / 7 +
                                copies * copy_bytes + copies * met_copy_bytes / most_parts});
}

void RankMemory::require_limit(const BuildConfig& build) {
  const std::uint64_t need = std::min(stored_bytes(build), in_core_bytes());
  if (limit_.bytes < need) fail("building by ranks needs", need);
}

// Triangles, twice while they are sorted, then with the cells.
void RankMemory::require_room(Ranks& ranks) const {
  const std::uint64_t need = 46 * triangles_ + 12 * vertices_, room = free_bytes(limit_.scratch);
  const std::string& own = ranks.host();
  std::uint64_t here = 0;  // ranks of this machine, which may have one disk
  for (const std::vector<std::string>& host : ranks.gather_texts({own})) here += host.front() == own;
  if (room < here * need)
    throw FileError(describe(limit_.scratch.string(), "",
                             "temporary files of " + std::to_string(here) + " ranks need about " +
                                 needed_mebibytes(here * need) + ", and " + available_mebibytes(room) + " are free",
                             "free some space there, or put them on another disk (--scratch)"));
}

void RankMemory::fail(const std::string& what, std::uint64_t need) const {
  throw ResourceError(describe(input_, "", what + " " + needed_mebibytes(need) + " of memory in each",
                               std::string(wedges_ > 0 ? "leave them out (--no-attributes), or " : "") +
                                   "give --memory-limit " + std::to_string((need + mebibyte - 1) / mebibyte) +
                                   "MiB, or more ranks"));
}

std::uint64_t RankMemory::left(std::uint64_t taken) const {
  return limit_.bytes > fixed_ + taken ? limit_.bytes - fixed_ - taken : 0;
}

std::uint64_t RankMemory::compared_items() const {
  if (!spills_) return all_in_memory;
  if (limit_.part > 0) return limit_.part;
  return std::max(left(slice_bytes * vertices_) / item_bytes, fewest_items);
}

std::uint64_t RankMemory::part(std::uint64_t vertices, std::uint64_t triangles) const {
  if (limit_.part > 0) return limit_.part;
  const std::uint64_t least = least_part(triangles);
  return std::clamp(left(vertex_bytes * vertices + all_vertices_ / 7) / 2 / sizeof(Triangle), least,
                    std::max(least, most_part));
}

std::size_t RankMemory::lanes(const FinestShare& share) const {
  const std::uint64_t always = vertex_bytes * share.vertices + cell_bytes * share.cells + 16 * share.runs;
  const std::uint64_t shared = SharedVertices::bytes_per_vertex * share.shared;
  const std::uint64_t lane = std::max<std::uint64_t>(share.largest_block * StoredBlocks::bytes_per_triangle, 1);
  const std::uint64_t need =
      fixed_ + always +
      std::max(SharedVertices::peak_bytes_per_vertex * share.shared + outer_bytes * share.outer, shared + lane);
  if (need > limit_.bytes) fail("the cells and blocks of a rank need", need);
  return std::clamp<std::uint64_t>(left(always + shared) / lane, 1, workers_);
}

std::uint64_t RankMemory::compared_copies(std::uint64_t cells, std::uint64_t copies) const {
  if (limit_.part > 0) return limit_.part;
  const std::uint64_t ranks = all_triangles_ / std::max<std::uint64_t>(triangles_, 1) + 1;
  const std::uint64_t tables = table_bytes * cells * ranks + all_triangles_ / 7;  // at rank 0
  // Each part reads all borders again; there is room for this one (stored_bytes).
  const std::uint64_t fewest = std::max(copies / most_parts, fewest_items);
  return std::max(left(cell_bytes * cells + tables + copy_bytes * copies) / met_copy_bytes, fewest);
}

}  // namespace lodestone
