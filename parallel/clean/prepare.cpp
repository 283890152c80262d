#include "parallel/clean/prepare.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "core/mesh/clean_kernels.h"
#include "parallel/clean/hash_partition.h"
#include "parallel/clean/prepare_wedges.h"
#include "parallel/clean/repeat_filter.h"
#include "parallel/scheduler/first_touch.h"

namespace lodestone {
namespace {

constexpr std::size_t grain = std::size_t{1} << 16;  // vertices or triangles per chunk

template <class T>
std::span<T> part(std::span<T> whole, ChunkRange range) {
  return whole.subspan(range.begin, range.end - range.begin);
}
template <class T>
std::span<T> part(std::vector<T>& whole, ChunkRange range) {
  return part(std::span(whole), range);
}

// Sums kernel(range) over the chunks.
template <class Kernel>
std::uint64_t sum_chunks(std::size_t count, Scheduler& scheduler, const Kernel& kernel) {
  std::vector<std::uint64_t> partial(chunk_count(count, grain));
  scheduler.for_chunks(count, grain, [&](ChunkRange range) { partial[range.index] = kernel(range); });
  std::uint64_t total = 0;
  for (const std::uint64_t value : partial) total += value;
  return total;
}

// Keeps what squeeze(chunk) moved to the front of each chunk; it returns how many. In place: no second copy.
template <class T, class Squeeze>
void squeeze(std::vector<T>& items, Scheduler& scheduler, const Squeeze& squeeze_chunk) {
  std::vector<std::size_t> kept(chunk_count(items.size(), grain));
  scheduler.for_chunks(items.size(), grain, [&](ChunkRange range) { kept[range.index] = squeeze_chunk(range); });
  std::size_t end = 0;
  for (std::size_t chunk = 0; chunk < kept.size(); ++chunk) {
    const auto from = items.begin() + static_cast<std::ptrdiff_t>(chunk * grain);
    const auto to = items.begin() + static_cast<std::ptrdiff_t>(end);
    if (from != to) std::copy(from, from + static_cast<std::ptrdiff_t>(kept[chunk]), to);
    end += kept[chunk];
  }
  items.resize(end);
  if (items.size() < items.capacity() / 2) items.shrink_to_fit();  // soups: most vertices go
}

Box3d box_of(std::span<const Vec3d> positions, std::span<const VertexState> states, Scheduler& scheduler) {
  std::vector<Box3d> boxes(chunk_count(positions.size(), grain));
  scheduler.for_chunks(positions.size(), grain, [&](ChunkRange range) {
    extend_box(part(positions, range), part(states, range), boxes[range.index]);
  });
  Box3d box;
  for (const Box3d& b : boxes) box.extend(b);
  return box;
}

// The steps of the recipe in prepare_mesh. Holds what they share: the mesh, and a state and an id per vertex.
class Preparation {
 public:
  Preparation(RawMesh&& raw, Repairs& repairs, Scheduler& scheduler)
      : raw_(std::move(raw)),
        repairs_(&repairs),
        scheduler_(&scheduler),
        wedges_(raw_, scheduler),
        states_(raw_.positions.size()) {
    mesh_.triangles = std::move(raw_.triangles);
  }

  void drop_non_finite_triangles() {
    const std::uint64_t not_finite = sum_chunks(raw_.positions.size(), *scheduler_, [&](ChunkRange range) {
      return classify_vertices(part(raw_.positions, range), part(states_, range));
    });
    if (not_finite == 0) {
      scheduler_->for_chunks(mesh_.triangles.size(), grain,
                             [&](ChunkRange range) { mark_corners(part(mesh_.triangles, range), states_); });
      return;
    }
    repairs_->non_finite_triangles = sum_chunks(mesh_.triangles.size(), *scheduler_, [&](ChunkRange range) {
      return drop_non_finite(part(mesh_.triangles, range), states_);
    });
  }

  void normalise(const std::string& name, Lattice lattice) {
    mesh_.transform = normalising_transform(box_of(raw_.positions, states_, *scheduler_), name);
    mesh_.transform.lattice = resolve_lattice(lattice, raw_.positions, mesh_.triangles, mesh_.transform.scale);
    resize_in_parallel(mesh_.positions, raw_.positions.size(), *scheduler_);
    scheduler_->for_chunks(raw_.positions.size(), grain, [&](ChunkRange range) {
      normalise_vertices(mesh_.transform, part(raw_.positions, range), part(states_, range),
                         part(mesh_.positions, range));
    });
    std::vector<Vec3d>().swap(raw_.positions);
  }

  void weld_vertices() {
    const std::vector<Vec3f>& positions = mesh_.positions;
    // -0 and NaN do not occur any more, so that equal positions are equal bits.
    repairs_->welded_vertices =
        HashPartition(
            positions.size(), [&](std::size_t i) { return states_[i] == VertexState::used; },
            [&](std::size_t i) { return hash_of(positions[i]); }, *scheduler_)
            .find_repeats([&](std::uint32_t a, std::uint32_t b) { return positions[a] == positions[b]; },
                          [&](std::uint32_t repeat, std::uint32_t first) {
                            std::call_once(any_repeat_, [&] { number_all(); });
                            ids_[repeat] = first;
                          },
                          *scheduler_);
  }

  void drop_degenerate_triangles() {
    const std::uint64_t degenerate = sum_chunks(mesh_.triangles.size(), *scheduler_, [&](ChunkRange range) {
      const std::span triangles = part(mesh_.triangles, range);
      return ids_.empty() ? drop_degenerate(triangles) : weld_triangles(ids_, triangles);
    });
    repairs_->degenerate_triangles = degenerate - repairs_->non_finite_triangles;
  }

  void drop_duplicate_triangles() {
    std::vector<Triangle>& triangles = mesh_.triangles;
    const std::vector<std::uint32_t> some =
        RepeatFilter(triangles, mesh_.positions.size(), *scheduler_).candidates(*scheduler_);
    repairs_->duplicate_triangles = HashPartition(
                                        some.size(), [](std::size_t) { return true; },
                                        [&](std::size_t i) { return hash_of(triangles[some[i]]); }, *scheduler_)
                                        .find_repeats(
                                            [&](std::uint32_t a, std::uint32_t b) {
                                              return canonical(triangles[some[a]]) == canonical(triangles[some[b]]);
                                            },
                                            [&](std::uint32_t repeat, std::uint32_t) {
                                              triangles[some[repeat]] = Triangle{{0, 0, 0}};
                                            },
                                            *scheduler_);
  }

  void squeeze_out() {
    if (is_sound()) return;
    ids_.resize(mesh_.positions.size());
    mark_survivors();
    number_survivors();
    const std::size_t before = mesh_.positions.size();
    squeeze(mesh_.positions, *scheduler_,
            [&](ChunkRange range) { return squeeze_vertices(part(states_, range), part(mesh_.positions, range)); });
    wedges_.squeeze(mesh_.triangles);
    squeeze(mesh_.triangles, *scheduler_,
            [&](ChunkRange range) { return squeeze_triangles(ids_, part(mesh_.triangles, range)); });
    repairs_->unreferenced_vertices = before - mesh_.positions.size() - repairs_->welded_vertices;
  }

  void attach_wedges() { wedges_.attach(mesh_); }

  [[nodiscard]] IndexedMesh&& result() && { return std::move(mesh_); }
  [[nodiscard]] const IndexedMesh& mesh() const { return mesh_; }

 private:
  // Nothing has gone, and nothing is unused: most meshes.
  [[nodiscard]] bool is_sound() const {
    const Repairs& r = *repairs_;
    if (r.non_finite_triangles + r.welded_vertices + r.degenerate_triangles + r.duplicate_triangles != 0) return false;
    return sum_chunks(states_.size(), *scheduler_, [&](ChunkRange range) {
             return static_cast<std::uint64_t>(std::ranges::count(part(std::span(states_), range), VertexState::used));
           }) == states_.size();
  }

  void number_all() {
    ids_.resize(mesh_.positions.size());
    std::iota(ids_.begin(), ids_.end(), 0u);
  }

  void mark_survivors() {
    scheduler_->for_chunks(states_.size(), grain,
                           [&](ChunkRange range) { std::ranges::fill(part(states_, range), VertexState::unused); });
    scheduler_->for_chunks(mesh_.triangles.size(), grain,
                           [&](ChunkRange range) { mark_used(part(mesh_.triangles, range), states_); });
  }

  void number_survivors() {
    std::vector<std::uint32_t> first(chunk_count(states_.size(), grain));
    scheduler_->for_chunks(states_.size(), grain, [&](ChunkRange range) {
      first[range.index] = static_cast<std::uint32_t>(std::ranges::count(part(states_, range), VertexState::used));
    });
    std::uint32_t total = 0;
    for (std::uint32_t& count : first) total += std::exchange(count, total);
    scheduler_->for_chunks(states_.size(), grain, [&](ChunkRange range) {
      number_vertices(part(states_, range), first[range.index], part(ids_, range));
    });
  }

  RawMesh raw_;
  Repairs* repairs_;
  Scheduler* scheduler_;
  WedgePreparation wedges_;
  IndexedMesh mesh_;
  std::vector<VertexState> states_;
  // Of each vertex: its representative, then its number in the result. Empty as long as each is its own.
  std::vector<std::uint32_t> ids_;
  std::once_flag any_repeat_;
};

void require_any_left(std::uint64_t dropped, std::size_t triangles, const Repairs& repairs, const std::string& name) {
  if (dropped == triangles) require_survivors({}, repairs, name);
}

}  // namespace

IndexedMesh prepare_mesh(RawMesh&& raw, Repairs& repairs, Scheduler& scheduler, const std::string& name,
                         Lattice lattice) {
  const std::size_t triangles = raw.triangles.size();
  if (triangles >= std::numeric_limits<std::uint32_t>::max())
    throw ResourceError(describe(name, "", "more triangles than 32-bit numbers reach", "split the model"));
  repairs = {};
  repairs.polygons_triangulated = raw.polygons_triangulated;
  repairs.faces_dropped = raw.faces_dropped;
  repairs.void_posts = raw.void_posts;
  repairs.filled_posts = raw.filled_posts;
  Preparation preparation(std::move(raw), repairs, scheduler);
  preparation.drop_non_finite_triangles();
  require_any_left(repairs.non_finite_triangles, triangles, repairs, name);
  preparation.normalise(name, lattice);
  preparation.weld_vertices();
  preparation.drop_degenerate_triangles();
  require_any_left(repairs.non_finite_triangles + repairs.degenerate_triangles, triangles, repairs, name);
  preparation.drop_duplicate_triangles();
  preparation.squeeze_out();
  preparation.attach_wedges();
  return std::move(preparation).result();
}

}  // namespace lodestone
