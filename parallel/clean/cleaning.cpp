#include "parallel/clean/cleaning.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "parallel/clean/find_repeats.h"
#include "parallel/scheduler/first_touch.h"

namespace lodestone {
namespace {

Vec3d lower(Vec3d a, Vec3d b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3d upper(Vec3d a, Vec3d b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

}  // namespace

Cleaning::Cleaning(std::string name, std::uint64_t vertices, std::uint64_t triangles, Scheduler& scheduler)
    : name_(std::move(name)), scheduler_(scheduler), vertex_count_(vertices), triangle_count_(triangles) {
  if (triangles >= std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(name_, "", "more triangles than 32-bit numbers reach", "split the model"));
  states_.resize(vertices);
}

void Cleaning::run(Lattice lattice, const std::function<void(double)>& progress) {
  const auto at = [&](double share) {
    if (progress) progress(share);
  };
  drop_non_finite_triangles();
  at(0.2);
  normalise(lattice);
  at(0.3);
  weld_vertices();
  at(0.5);
  drop_degenerate_triangles();
  require_any_left();
  at(0.6);
  repairs_.duplicate_triangles = drop_duplicate_triangles();
  dropped_ += repairs_.duplicate_triangles;
  compact_all();
  at(1);
}

// Also drops those that are degenerate as they are, and finds the box of the finite vertices.
void Cleaning::drop_non_finite_triangles() {
  std::atomic<std::uint64_t> not_finite{0}, non_finite_triangles{0};
  box_ = reduce_box([&](ChunkRange range, std::span<const Vec3d> positions, Box3d& box) {
    const auto states = part(states_, range);
    not_finite += classify_vertices(positions, states);
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (states[i] == VertexState::unused) box = {lower(box.lo, positions[i]), upper(box.hi, positions[i])};
  });
  dropped_ = sum_triangles([&](std::span<Triangle> triangles) {
    if (not_finite == 0) {
      mark_corners(triangles, states_);
    } else {
      non_finite_triangles += drop_non_finite(triangles, states_);
    }
    return drop_degenerate(triangles);
  });
  repairs_.non_finite_triangles = non_finite_triangles;
  if (repairs_.non_finite_triangles == triangle_count_) require_any_left();
}

void Cleaning::normalise(Lattice lattice) {
  // Vertices that no triangle uses do not count.
  if (count_used() < vertex_count_)
    box_ = reduce_box([&](ChunkRange range, std::span<const Vec3d> positions, Box3d& box) {
      extend_box(positions, part(states_, range), box);
    });
  const Up up = transform_.up;
  transform_ = normalising_transform(box_, name_);
  transform_.up = up;
  transform_.lattice = lattice.bits == Lattice::automatic ? choose_lattice() : resolve_lattice(lattice, {}, {}, 1);
  resize_in_parallel(positions_, vertex_count_, scheduler_);
  scheduler_.for_chunks(vertex_count_, grain, [&](ChunkRange range) {
    read_vertices(range, [&](std::span<const Vec3d> positions) {
      normalise_vertices(transform_, positions, part(states_, range), part(positions_, range));
    });
  });
  release_input_positions();
}

// -0 and NaN do not occur any more, so that equal positions have equal bits.
void Cleaning::weld_vertices() {
  repairs_.welded_vertices = find_repeats(
      positions_.size(), working_bytes_,
      [&](ChunkRange range, const auto& emit) {
        for (std::size_t i = range.begin; i < range.end; ++i)
          if (states_[i] == VertexState::used) emit(i, hash_of(positions_[i]));
      },
      [&](std::uint32_t a, std::uint32_t b) { return positions_[a] == positions_[b]; },
      [&](std::uint32_t repeat, std::uint32_t first) {
        std::call_once(any_repeat_, [&] { number_all(); });
        numbers_[repeat] = first;
      },
      scheduler_);
}

void Cleaning::drop_degenerate_triangles() {
  if (repairs_.welded_vertices > 0 || dropped_ > 0) {
    scheduler_.for_chunks(vertex_count_, grain,
                          [&](ChunkRange range) { std::ranges::fill(part(states_, range), VertexState::unused); });
    dropped_ = sum_triangles([&](std::span<Triangle> triangles) {
      const std::uint64_t degenerate =
          numbers_.empty() ? drop_degenerate(triangles) : weld_triangles(numbers_, triangles);
      mark_used(triangles, states_);
      return degenerate;
    });
  }
  repairs_.degenerate_triangles = dropped_ - repairs_.non_finite_triangles;
}

// Vertices and triangles that are left move to the front, in order.
void Cleaning::compact_all() {
  const std::uint64_t used = count_used();
  if (used == vertex_count_) {
    std::vector<std::uint32_t>().swap(numbers_);
  } else {
    number_survivors();
    compact(positions_, grain, shrink_ratio_, scheduler_,
            [&](ChunkRange range) { return compact_vertices(part(states_, range), part(positions_, range)); });
  }
  if (used < vertex_count_ || dropped_ > 0) compact_triangles();
  repairs_.unreferenced_vertices = vertex_count_ - used - repairs_.welded_vertices;
}

void Cleaning::require_any_left() const {
  if (dropped_ == triangle_count_) require_survivors({}, repairs_, name_);
}

std::uint64_t Cleaning::count_used() {
  return sum_chunks(states_.size(), grain, scheduler_, [&](ChunkRange range) {
    return static_cast<std::uint64_t>(std::ranges::count(part(states_, range), VertexState::used));
  });
}

// As core/math/lattice.h chooses it.
Lattice Cleaning::choose_lattice() const {
  std::vector<double> edges;
  const std::uint64_t stride = lattice_sample_stride(triangle_count_);
  for (std::uint64_t t = 0; t < triangle_count_; t += stride) {
    const Triangle at = triangle(t);
    if (!is_degenerate(at))
      append_edges(position(at.v[0]), position(at.v[1]), position(at.v[2]), transform_.scale, edges);
  }
  return lattice_for(std::move(edges));
}

void Cleaning::number_all() {
  numbers_.resize(vertex_count_);
  std::iota(numbers_.begin(), numbers_.end(), 0u);
}

// Vertices in use first, then those that have become one of them.
void Cleaning::number_survivors() {
  numbers_.resize(vertex_count_);
  std::vector<std::uint32_t> first(chunk_count(states_.size(), grain));
  scheduler_.for_chunks(states_.size(), grain, [&](ChunkRange range) {
    first[range.index] = static_cast<std::uint32_t>(std::ranges::count(part(states_, range), VertexState::used));
  });
  std::exclusive_scan(first.begin(), first.end(), first.begin(), 0u);
  scheduler_.for_chunks(states_.size(), grain, [&](ChunkRange range) {
    std::uint32_t next = first[range.index];
    for (std::size_t i = range.begin; i < range.end; ++i)
      if (states_[i] == VertexState::used) numbers_[i] = next++;
  });
  if (repairs_.welded_vertices == 0) return;
  scheduler_.for_chunks(states_.size(), grain, [&](ChunkRange range) {
    for (std::size_t i = range.begin; i < range.end; ++i)
      if (states_[i] != VertexState::used && states_[numbers_[i]] == VertexState::used)
        numbers_[i] = numbers_[numbers_[i]];
  });
}

// Sums visit(triangles) over the pieces.
template <class Visit>
std::uint64_t Cleaning::sum_triangles(const Visit& visit) {
  return sum_chunks(triangle_count_, grain, scheduler_, [&](ChunkRange range) {
    std::uint64_t value = 0;
    update_triangles(range, [&](std::span<Triangle> triangles) { value = visit(triangles); });
    return value;
  });
}

template <class Extend>
Box3d Cleaning::reduce_box(const Extend& extend_by) {
  std::vector<Box3d> boxes(chunk_count(vertex_count_, grain));
  scheduler_.for_chunks(vertex_count_, grain, [&](ChunkRange range) {
    read_vertices(range, [&](std::span<const Vec3d> positions) { extend_by(range, positions, boxes[range.index]); });
  });
  Box3d all;
  for (const Box3d& box : boxes) all.extend(box);
  return all;
}

}  // namespace lodestone
