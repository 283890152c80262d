// The steps of cleaning and welding, over a mesh in memory or in a file: as core/mesh/clean.h says, with the same
// bytes for any number of workers.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/clean.h"
#include "core/mesh/clean_kernels.h"
#include "parallel/clean/find_repeats.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// Sums kernel(range) over the chunks.
template <class Kernel>
std::uint64_t sum_chunks(std::size_t count, std::size_t grain, Scheduler& scheduler, const Kernel& kernel) {
  std::vector<std::uint64_t> partial(chunk_count(count, grain));
  scheduler.for_chunks(count, grain, [&](ChunkRange range) { partial[range.index] = kernel(range); });
  return std::accumulate(partial.begin(), partial.end(), std::uint64_t{0});
}

// Keeps what compact_chunk(range) moved to the front of each chunk; it returns how many. In place, without a second
// copy, which shrink_to_fit makes when no more than the capacity over `shrink_ratio` is left.
template <class T, class CompactChunk>
void compact(std::vector<T>& items, std::size_t grain, std::size_t shrink_ratio, Scheduler& scheduler,
             const CompactChunk& compact_chunk) {
  std::vector<std::size_t> kept(chunk_count(items.size(), grain));
  scheduler.for_chunks(items.size(), grain, [&](ChunkRange range) { kept[range.index] = compact_chunk(range); });
  std::size_t end = 0;
  for (std::size_t chunk = 0; chunk < kept.size(); ++chunk) {
    const auto from = items.begin() + static_cast<std::ptrdiff_t>(chunk * grain);
    const auto to = items.begin() + static_cast<std::ptrdiff_t>(end);
    if (from != to) std::copy(from, from + static_cast<std::ptrdiff_t>(kept[chunk]), to);
    end += kept[chunk];
  }
  items.resize(end);
  if (items.size() < items.capacity() / shrink_ratio) items.shrink_to_fit();
}

template <class T>
std::span<T> part(std::span<T> whole, ChunkRange range) {
  return whole.subspan(range.begin, range.end - range.begin);
}
template <class T>
std::span<T> part(std::vector<T>& whole, ChunkRange range) {
  return part(std::span(whole), range);
}

// Holds what every form shares: positions, and a state and a number per vertex. The form decides where the input is and
// how its triangles are changed. A triangle that is dropped reads as (0, 0, 0) from then on.
class Cleaning {
 public:
  virtual ~Cleaning() = default;

  // Throws InputError when no triangle is left or the bounding box is beyond double precision. `progress` gets the
  // share that is done, from time to time.
  void run(Lattice lattice, const std::function<void(double)>& progress = {});

 protected:
  static constexpr std::size_t grain = std::size_t{1} << 16;  // vertices or triangles per piece; a multiple of 64

  // Throws ResourceError for 2^32 triangles or more.
  Cleaning(std::string name, std::uint64_t vertices, std::uint64_t triangles, Scheduler& scheduler);

  using VisitVertices = std::function<void(std::span<const Vec3d>)>;
  using VisitTriangles = std::function<void(std::span<Triangle>)>;
  virtual void read_vertices(ChunkRange range, const VisitVertices& visit) const = 0;
  // A triangle that is degenerate after the visit is dropped; what else the visit changes may be lost. From any thread.
  virtual void update_triangles(ChunkRange range, const VisitTriangles& visit) = 0;
  [[nodiscard]] virtual Vec3d position(std::uint32_t vertex) const = 0;
  [[nodiscard]] virtual Triangle triangle(std::uint64_t index) const = 0;
  virtual void release_input_positions() {}  // they are normalised
  // Returns how many were dropped.
  virtual std::uint64_t drop_duplicate_triangles() = 0;
  // Triangles that are left move to the front, with the new numbers; empty numbers: vertices keep theirs.
  virtual void compact_triangles() = 0;

  void number_all();

  std::string name_;
  Scheduler& scheduler_;
  std::uint64_t vertex_count_, triangle_count_;
  std::vector<Vec3f> positions_;
  std::vector<VertexState> states_;
  // By vertex: its representative, then its number in the result. Empty as long as each is its own.
  std::vector<std::uint32_t> numbers_;
  Transform transform_;  // its up axis is set by the derived class
  Repairs repairs_;
  std::uint64_t dropped_ = 0;                  // triangles
  std::size_t working_bytes_ = all_in_memory;  // for finding equal vertices and triangles
  std::size_t shrink_ratio_ = 2;               // see compact()

 private:
  void drop_non_finite_triangles();
  void normalise(Lattice lattice);
  void weld_vertices();
  void drop_degenerate_triangles();
  void compact_all();
  void require_any_left() const;
  [[nodiscard]] std::uint64_t count_used();
  [[nodiscard]] Lattice choose_lattice() const;
  void number_survivors();
  template <class Visit>
  std::uint64_t sum_triangles(const Visit& visit);
  template <class Extend>
  [[nodiscard]] Box3d reduce_box(const Extend& extend_by);

  Box3d box_;  // of the input
  std::once_flag any_repeat_;
};

}  // namespace lodestone
