#include "render/backends/soft/setup_stage.h"

#include <algorithm>
#include <utility>

#include "render/backends/soft/clip.h"

namespace lodestone::soft {
namespace {

// True if no sample of the pixels of `rect` is on the inner side of the edge from a to b.
template <int Samples>
bool outside_edge(SnappedPoint a, SnappedPoint b, PixelRect rect) {
  constexpr int first = subpixels / 2 - sample_reach<Samples>, last = subpixels / 2 + sample_reach<Samples>;
  const std::int64_t dx = b.x - a.x, dy = b.y - a.y;
  // The edge function dx (y - a.y) - dy (x - a.x) is largest at a corner.
  const std::int64_t x = dy < 0 ? (rect.x1 - 1) * subpixels + last : rect.x0 * subpixels + first;
  const std::int64_t y = dx > 0 ? (rect.y1 - 1) * subpixels + last : rect.y0 * subpixels + first;
  return dx * (y - a.y) - dy * (x - a.x) < 0;
}

class CellSetup {
 public:
  CellSetup(const SetupContext& context, const DrawnCell& cell, const CellInWindow& window)
      : context_(context),
        cell_(cell),
        triangles_(window.triangles),
        vertices_(window.vertices),
        first_triangle_(window.first_triangle) {}

  [[nodiscard]] TriangleRecord record(std::uint32_t triangle) const {
    TriangleRecord r;
    for (std::size_t k = 0; k < 3; ++k) {
      const WindowVertex& v = vertices_[triangles_[triangle].v[k]];
      r.corners[k] = {v.x, v.y};
      r.z[k] = v.z;
      r.inverse_w[k] = v.inverse_w;
    }
    r.v = triangles_[triangle].v;
    r.triangle = first_triangle_ + triangle;
    return r;
  }

  // True if all of it is outside one plane.
  [[nodiscard]] bool out_of_view(std::uint32_t triangle) const {
    std::uint32_t common = ~0u;
    for (const std::uint32_t v : triangles_[triangle].v) common &= outcode(vertices_[v]);
    return common != 0;
  }

  // Calls visit(record) for triangles that together make up its part in the view.
  template <class Visit>
  void for_each_part(std::uint32_t triangle, const Visit& visit) const {
    const ClippedPolygon polygon =
        clip(clip_corners(cell_.model->*context_.projection, cell_, triangles_[triangle].v), *context_.viewport);
    std::array<WindowVertex, 10> corners;
    for (std::size_t k = 0; k < polygon.view().size(); ++k) {
      if (!(polygon.corners[k].w > 0)) return;  // only with a matrix that is not a camera's
      corners[k] = context_.viewport->snap(polygon.corners[k]);
    }
    for (std::size_t k = 2; k < polygon.view().size(); ++k) {
      TriangleRecord r{};  // inverse_w = 0
      for (const auto& [to, from] : {std::pair{0u, std::size_t{0}}, {1u, k - 1}, {2u, k}}) {
        r.corners[to] = {corners[from].x, corners[from].y};
        r.z[to] = corners[from].z;
      }
      r.v = triangles_[triangle].v;
      r.triangle = first_triangle_ + triangle;
      visit(r);
    }
  }

 private:
  [[nodiscard]] std::uint32_t outcode(const WindowVertex& v) const {
    if (v.inverse_w == 0) return static_cast<std::uint32_t>(v.x);
    const ImageSize size = context_.grid->size;
    return (v.x < 0 ? Outside::left : 0u) | (v.x > size.width * subpixels ? Outside::right : 0u) |
           (v.y < 0 ? Outside::top : 0u) | (v.y > size.height * subpixels ? Outside::bottom : 0u);
  }

  const SetupContext& context_;
  const DrawnCell& cell_;
  std::span<const Triangle> triangles_;
  const WindowVertex* vertices_;
  TriangleNumber first_triangle_;
};

}  // namespace

template <int Samples>
void bin_triangle(TriangleRecord record, const TileGrid& grid, Bins<TriangleRecord>& bins) {
  auto& [a, b, c] = record.corners;
  const std::int64_t area = doubled_area(a, b, c);
  if (area == 0) return;
  if (area < 0) {
    std::swap(b, c);
    std::swap(record.z[1], record.z[2]);
    std::swap(record.inverse_w[1], record.inverse_w[2]);
    std::swap(record.v[1], record.v[2]);
  }
  constexpr int first = subpixels / 2 - sample_reach<Samples>, last = subpixels / 2 + sample_reach<Samples>;
  const auto [left, right] = std::minmax({a.x, b.x, c.x});
  const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
  const int x0 = std::max((left + (subpixels - 1 - last)) >> subpixel_bits, 0),
            y0 = std::max((top + (subpixels - 1 - last)) >> subpixel_bits, 0),
            x1 = std::min((right - first) >> subpixel_bits, grid.size.width - 1),
            y1 = std::min((bottom - first) >> subpixel_bits, grid.size.height - 1);
  if (x0 > x1 || y0 > y1) return;
  const bool several = (x0 >> tile_bits) != (x1 >> tile_bits) && (y0 >> tile_bits) != (y1 >> tile_bits);
  for (int row = y0 >> tile_bits; row <= y1 >> tile_bits; ++row)
    for (int column = x0 >> tile_bits; column <= x1 >> tile_bits; ++column) {
      const auto tile = static_cast<std::size_t>(row * grid.columns + column);
      if (several) {
        const PixelRect rect = grid.rect(tile);
        if (outside_edge<Samples>(a, b, rect) || outside_edge<Samples>(b, c, rect) || outside_edge<Samples>(c, a, rect))
          continue;
      }
      bins.push(tile, record);
    }
}

template <int Samples>
void setup_cell(const SetupContext& context, const SampleKernels<Samples>& kernels, const DrawnCell& cell,
                const CellInWindow& window, SetupLists& lists, TileBins& bins) {
  const CellSetup setup(context, cell, window);
  const SetupJob job{window.triangles, window.vertices, window.first_triangle, context.grid, &bins.fragments};
  const auto count = static_cast<std::uint32_t>(window.triangles.size());
  for (std::uint32_t first = 0; first < count; first += run_triangles) {
    kernels.setup(job, first, std::min(run_triangles, count - first), lists);
    for (std::uint32_t k = 0; k < lists.large_count; ++k)
      bin_triangle<Samples>(setup.record(lists.large[k]), *context.grid, bins.triangles);
    for (std::uint32_t k = 0; k < lists.clipped_count; ++k) {
      if (setup.out_of_view(lists.clipped[k])) continue;
      setup.for_each_part(lists.clipped[k], [&](const TriangleRecord& part) {
        bin_triangle<Samples>(part, *context.grid, bins.triangles);
      });
    }
  }
}

template void bin_triangle<1>(TriangleRecord, const TileGrid&, Bins<TriangleRecord>&);
template void bin_triangle<4>(TriangleRecord, const TileGrid&, Bins<TriangleRecord>&);
template void setup_cell<1>(const SetupContext&, const SampleKernels<1>&, const DrawnCell&, const CellInWindow&,
                            SetupLists&, TileBins&);
template void setup_cell<4>(const SetupContext&, const SampleKernels<4>&, const DrawnCell&, const CellInWindow&,
                            SetupLists&, TileBins&);

}  // namespace lodestone::soft
