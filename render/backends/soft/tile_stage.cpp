#include "render/backends/soft/tile_stage.h"

#include "render/backends/soft/edge_walk.h"
#include "render/shading.h"

namespace lodestone::soft {
namespace {

struct Corners {
  const WindowVertex &a, &b, &c;
};

Corners corners(const TriangleRef& ref, std::span<const Batch> batches, std::span<const WindowVertex> vertices) {
  const auto corner = [&](std::uint32_t v) -> const WindowVertex& {
    return (v & clipped_bit) != 0 ? batches[ref.batch()].clipped[v & ~clipped_bit] : vertices[v];
  };
  return {corner(ref.v[0]), corner(ref.v[1]), corner(ref.v[2])};
}

std::size_t slot(const PixelRect& rect, int x, int y) {
  return static_cast<std::size_t>(y - rect.y0) * tile_size + static_cast<std::size_t>(x - rect.x0);
}

void rasterize(const TriangleRef& ref, const Corners& t, const PixelRect& rect, TileScratch& scratch) {
  const SnappedPoint a{t.a.x, t.a.y}, b{t.b.x, t.b.y}, c{t.c.x, t.c.y};
  const float inverse_area = 1 / static_cast<float>(doubled_area(a, b, c));
  // Depth is linear in the window. Interpolating with shares stays between the corners' depths even in slivers, where
  // a plane equation would not.
  const float z_a = t.a.z, z_ab = t.b.z - t.a.z, z_ac = t.c.z - t.a.z;
  for_each_covered(a, b, c, covered_box(a, b, c, rect), [&](int x, int y, auto edge_b, auto edge_c) {
    const float share_b = static_cast<float>(edge_b) * inverse_area,
                share_c = static_cast<float>(edge_c) * inverse_area;
    const float z = (z_a + share_b * z_ab) + share_c * z_ac;
    const std::size_t i = slot(rect, x, y);
    if (!(z < scratch.depth[i])) return;
    scratch.depth[i] = z;
    scratch.triangle[i] = &ref;
    scratch.share_b[i] = share_b;
    scratch.share_c[i] = share_c;
  });
}

// Perspective-correct: what is linear on the surface is linear in the window only after division by w.
Vec3f interpolate_normal(const Corners& t, float share_b, float share_c) {
  const float a = (1 - share_b - share_c) * t.a.inverse_w, b = share_b * t.b.inverse_w, c = share_c * t.c.inverse_w;
  return (1 / (a + b + c)) * (a * t.a.normal + b * t.b.normal + c * t.c.normal);
}

void put(std::uint8_t* pixel, Vec3f colour) {
  pixel[0] = shading::to_byte(colour.x);
  pixel[1] = shading::to_byte(colour.y);
  pixel[2] = shading::to_byte(colour.z);
  pixel[3] = 255;
}

}  // namespace

void draw_tile(const Frame& frame, const TileGrid& grid, std::size_t tile, std::span<const Batch> batches,
               std::span<const WindowVertex> vertices, TileScratch& scratch, Image& image) {
  const PixelRect rect = grid.rect(tile);
  scratch.depth.fill(1);
  scratch.triangle.fill(nullptr);
  for (const Batch& batch : batches)
    for (std::uint32_t k = batch.tile_begin[tile]; k < batch.tile_begin[tile + 1]; ++k)
      rasterize(batch.triangles[k], corners(batch.triangles[k], batches, vertices), rect, scratch);

  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      const std::size_t i = slot(rect, x, y);
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.size.width) + static_cast<std::size_t>(x);
      image.depth[pixel] = scratch.depth[i];
      const TriangleRef* ref = scratch.triangle[i];
      if (!ref) {
        std::copy(shading::background.begin(), shading::background.end(), &image.rgba[4 * pixel]);
        continue;
      }
      const Vec3f normal = interpolate_normal(corners(*ref, batches, vertices), scratch.share_b[i], scratch.share_c[i]);
      put(&image.rgba[4 * pixel],
          shading::brightness(normal, frame.light) * shading::albedo_of(ref->level(), frame.tint_by_level));
    }
  }
}

}  // namespace lodestone::soft
