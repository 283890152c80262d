// A row of pixels of a tile, taken apart: the parts of its pixels that each have one footprint in one chart, the points
// of the surface that they show, and the taps of their textures.
//
// Most pixels are in a single triangle. The means of all pixels' weights, and how these change across them, are
// therefore computed in lanes, as if all were; the others are gathered sample by sample.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/spherical/octahedron/sphere_raster.h"
#include "core/spherical/resample/surface_source.h"

namespace lodestone::spherical {

// Samples of a pixel on one side of all borders of charts.
struct PixelPart {
  std::uint32_t x = 0;                             // of the pixel in its row
  float samples = 0;                               // their number
  std::uint32_t points_begin = 0, points_end = 0;  // one for each triangle
};

class PixelRow {
 public:
  static constexpr std::size_t most_pixels = SampleTile::side / 2;

  // sides: samples along a pixel's side: 2, 4, 8. The source must outlive it.
  PixelRow(const SurfaceSource& source, std::uint32_t sides, SurfaceSource::Looks looks);

  // The row y of pixels of a tile, all of whose pixels are whole.
  void gather(const SampleTile& tile, std::uint32_t y);

  // The first part of pixel x is part x; it has no samples where the pixel has no source.
  [[nodiscard]] std::span<const PixelPart> parts() const { return std::span(parts_).first(part_count_); }
  // All points, filled up to a multiple of 4. The weights of a part's points sum up to 1.
  [[nodiscard]] std::span<const SurfacePoint> points() const {
    return std::span(points_).first((point_count_ + 3) / 4 * 4);
  }
  [[nodiscard]] std::span<const SurfacePoint> points(std::size_t p) const {
    return std::span(points_).subspan(parts_[p].points_begin, parts_[p].points_end - parts_[p].points_begin);
  }
  [[nodiscard]] std::uint32_t triangle(std::size_t p) const { return triangles_[p]; }  // of its first point
  [[nodiscard]] std::span<const TextureTap> colour_taps(std::size_t p) const {
    return taps_.between(ranges_[p].colour_begin, ranges_[p].colour_end);
  }
  [[nodiscard]] std::span<const TextureTap> normal_taps(std::size_t p) const {
    return taps_.between(ranges_[p].normal_begin, ranges_[p].normal_end);
  }

 private:
  static constexpr std::size_t most_samples = 64;                 // of a pixel
  using Numbers = std::array<std::array<float, most_pixels>, 3>;  // by corner of the triangle

  struct Samples {  // of a pixel that have a source
    std::array<SurfacePoint, most_samples> point;
    std::array<Vec2f, most_samples> uv;
    std::size_t count = 0;
  };

  template <std::size_t sides>
  void set_means(const SampleTile& tile, std::uint32_t y);
  void add_singles(std::uint32_t x, std::uint32_t count, const std::uint32_t* samples);
  void add_mixed(std::uint32_t x, const SampleTile& tile, std::size_t first);
  [[nodiscard]] bool are_together(std::size_t k, std::size_t l) const;
  [[nodiscard]] Footprint whole_footprint() const;
  void add_parts(std::uint32_t x);
  void add_part(std::uint32_t x, std::span<const SurfacePoint> points, const Footprint& footprint);
  void add_taps();

  const SurfaceSource& source_;
  std::uint32_t sides_;
  SurfaceSource::Looks looks_;
  float side_ = 0;  // of a sample on the sphere, in the middle of the tile
  Numbers weight_{}, by_x_{}, by_y_{};
  std::array<std::uint32_t, most_pixels> single_{};  // 0: samples are in several triangles
  Samples samples_;
  // As many as the row has samples, and 3 for the last lanes.
  std::vector<PixelPart> parts_;
  std::vector<std::uint32_t> triangles_;          // by part
  std::array<std::vector<float>, 6> footprints_;  // by part: the components of Footprint4
  std::vector<SurfaceTaps> ranges_;               // by part
  std::vector<SurfacePoint> points_;
  std::size_t part_count_ = 0, point_count_ = 0;
  TapList taps_;
};

}  // namespace lodestone::spherical
