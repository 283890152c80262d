// The inner loops, compiled once per instruction set and chosen at run time. Every set gives the same bytes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/backends/soft/bins.h"
#include "render/backends/soft/raster_types.h"
#include "render/backends/soft/soft_renderer.h"
#include "render/backends/soft/tile_buffer.h"
#include "render/backends/soft/viewport.h"
#include "render/effects/ambient_occlusion.h"
#include "render/lod/limits.h"
#include "render/surface/shading_job.h"

namespace lodestone::soft {

// Stage 1: all vertices of a cell.
struct VertexJob {
  std::span<const Vec3f> positions;
  // Positions of the parent cell, and the index of each vertex's parent there; null for a cell that does not morph.
  const Vec3f* coarser = nullptr;
  Indices parents;
  Vec3f viewpoint;
  DistanceMetric metric = DistanceMetric::euclidean;
  Blend blend = Blend::smoothstep;
  float band_begin = 0, band_end = 0;
  DetailLimits limits{};  // those near the cell
  const ViewProjection* view_projection = nullptr;
  const Viewport* viewport = nullptr;
  WindowVertex* out = nullptr;  // one per position
  float* lambdas = nullptr;     // the same, where the cell morphs
  bool has_lambdas = false;     // they are there (adaptive radii), not to be found by distance
};

// Stage 2: the triangles of a cell, a run at a time.
struct SetupJob {
  std::span<const Triangle> triangles;
  const WindowVertex* vertices = nullptr;  // of the cell
  TriangleNumber first_triangle = 0;
  const TileGrid* grid = nullptr;
  Bins<Fragment>* fragments = nullptr;
};
// Triangles below this extent, in subpixels, are small: at most six pixels wide and high.
inline constexpr std::int32_t small_extent = 6 * subpixels;
inline constexpr std::uint32_t run_triangles = 1024;

// Indices in the cell, in order. The small triangles have been drawn; the others remain to be drawn.
struct SetupLists {
  static constexpr std::uint32_t room = run_triangles + 16;  // appending writes a full vector
  std::uint32_t small_count = 0, large_count = 0, clipped_count = 0;
  std::uint32_t small[room], large[room], clipped[room];
};

// Points shaded, by effect.
using WorkCounts = std::array<std::uint64_t, effect_count>;

// A sample of a tile that a transparent triangle covers.
struct LayerItem {
  std::uint32_t sample = 0;  // as Fragment has it
  float z = 0;
  TriangleNumber triangle = 0;
  std::uint32_t reference = 0;  // into the lists of the tile
};

// Growing, in memory that is used again.
struct LayerList {
  LayerItem* data = nullptr;
  std::size_t count = 0, room = 0;

  void push(const LayerItem& item) {
    if (count == room) grow();
    data[count++] = item;
  }

 private:
  void grow();  // in layers.cpp: one copy, whatever instruction set the caller is compiled for
  std::vector<LayerItem> items_;
};

// Light that the layers over the samples of a tile add, and the share that they let through; the depth of what is
// opaque, masked layers included, and the share of that which is seen; the depth of the first layer that is not opaque.
struct LayerLight {
  float *red = nullptr, *green = nullptr, *blue = nullptr, *through = nullptr;
  float *seen = nullptr, *depth = nullptr, *first = nullptr;
};

// Stage 4: the visible surfaces of a tile become colour and depth of the picture.
struct ResolveJob : ShadingJob {
  const Viewport* viewport = nullptr;
  const DrawnCells* drawn = nullptr;
  PixelRect rect;
  Image* image = nullptr;
  WorkCounts* work = nullptr;
  const LayerLight* layers = nullptr;  // over the tile; only for resolve_layered
  bool keeps_through = false;          // alpha tells how much of the opaque surfaces is seen; else 255
};

// Kernels for one number of samples a pixel.
template <int Samples>
struct SampleKernels {
  void (*setup)(const SetupJob& job, std::uint32_t first, std::uint32_t count, SetupLists& lists);
  // Stage 3: a run of triangles in a tile, whose pixels are `rect`.
  void (*draw_triangles)(const TriangleRecord* first, const TriangleRecord* last, PixelRect rect,
                         TileBuffer<Samples>& tile);
  // Adds 1 to the count of each sample of the tile, in the order of TileBuffer, that a triangle covers, for a run of
  // them.
  void (*count_triangles)(const TriangleRecord* first, const TriangleRecord* last, PixelRect rect,
                          std::int32_t* counts);
  void (*resolve)(const ResolveJob& job, const TileBuffer<Samples>& tile);
  // Transparent surfaces: what of a run of triangles lies before the opaque ones, the first of them known as
  // `reference`; a layer of them shaded; and the picture under the layers of the job.
  void (*collect_layers)(const TriangleRecord* first, const TriangleRecord* last, PixelRect rect,
                         const TileBuffer<Samples>& opaque, std::uint32_t reference, LayerList& found);
  void (*shade_layer)(const ResolveJob& job, const TileBuffer<Samples>& layer, const LayerLight& light);
  void (*resolve_layered)(const ResolveJob& job, const TileBuffer<Samples>& tile);
};

struct Kernels {
  void (*transform)(const VertexJob& job);
  // Rows [first, last) of the picture.
  void (*occlude)(const effects::OcclusionJob& job, int first, int last, Image& image);
  SampleKernels<1> single;
  SampleKernels<4> multi;

  template <int Samples>
  [[nodiscard]] const SampleKernels<Samples>& of() const {
    if constexpr (Samples == 1)
      return single;
    else
      return multi;
  }
};

// Throws UnsupportedError where this processor does not have the set.
[[nodiscard]] const Kernels& find_kernels(InstructionSet set);

namespace plain {
extern const Kernels kernels;
}
namespace avx2 {
extern const Kernels kernels;
}

}  // namespace lodestone::soft
