// The triangles that the samples of a tile see: the visibility buffer (burns2013) with its depth.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "render/backends/soft/bins.h"
#include "render/backends/soft/raster_types.h"

namespace lodestone::soft {

// The place of an item in the lists of a tile.
class Reference {
 public:
  static constexpr int item_bits = 7;
  static constexpr std::uint32_t record_bit = 0x8000'0000u;

  // Item k of run `run`, of fragments or with record_bit of records, is first_of_run(run) + k.
  [[nodiscard]] static constexpr std::uint32_t first_of_run(std::size_t run) {
    return static_cast<std::uint32_t>(run << item_bits);
  }
  [[nodiscard]] static constexpr bool is_record(std::uint32_t reference) { return (reference & record_bit) != 0; }
};

// The items of a tile: runs of the workers' lists.
struct TileSources {
  std::vector<const Fragment*> fragment_runs;
  std::vector<const TriangleRecord*> record_runs;

  [[nodiscard]] const Fragment& fragment(std::uint32_t reference) const { return item(fragment_runs, reference); }
  [[nodiscard]] const TriangleRecord& record(std::uint32_t reference) const {
    return item(record_runs, reference & ~Reference::record_bit);
  }
  [[nodiscard]] TriangleNumber triangle(std::uint32_t reference) const {
    return Reference::is_record(reference) ? record(reference).triangle : fragment(reference).triangle;
  }

 private:
  static_assert(Bins<Fragment>::run_items <= 1u << Reference::item_bits);
  static_assert(Bins<TriangleRecord>::run_items <= 1u << Reference::item_bits);
  template <class T>
  static const T& item(const std::vector<const T*>& runs, std::uint32_t reference) {
    return runs[reference >> Reference::item_bits][reference & ((1u << Reference::item_bits) - 1)];
  }
};

// The nearest triangle wins, among equally near ones the one that is drawn first. This is a minimum: the order in which
// triangles arrive does not matter.
template <int Samples>
struct TileBuffer {
  static constexpr std::size_t samples = tile_pixels * static_cast<std::size_t>(Samples);
  static constexpr int block_size = 8, blocks_per_row = tile_size / block_size;

  // Sample s of all pixels, row by row, then the next sample. Depth 1: background.
  alignas(64) std::array<float, samples> depth;
  alignas(64) std::array<std::uint32_t, samples> reference;
  // Hierarchical depth (greene1993), one level: no sample of a block of 8x8 pixels is farther.
  std::array<float, blocks_per_row * blocks_per_row> farthest;
  std::array<std::uint8_t, blocks_per_row * blocks_per_row> changes;  // since `farthest` was computed
  TileSources sources;

  void clear() {
    depth.fill(1);
    farthest.fill(1);
    changes.fill(0);
    sources.fragment_runs.clear();
    sources.record_runs.clear();
  }
  [[nodiscard]] bool empty() const { return sources.fragment_runs.empty() && sources.record_runs.empty(); }

  void draw_fragments(const Fragment* first, const Fragment* last) {
    std::uint32_t own = Reference::first_of_run(sources.fragment_runs.size());
    sources.fragment_runs.push_back(first);
    for (const Fragment* f = first; f != last; ++f, ++own) {
      const float old = depth[f->sample];
      if (f->z < old || (f->z == old && f->triangle < sources.triangle(reference[f->sample]))) {
        depth[f->sample] = f->z;
        reference[f->sample] = own;
      }
    }
  }
};

}  // namespace lodestone::soft
