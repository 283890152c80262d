#include "core/spherical/resample/resampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/texture/chart_cover.h"

namespace lodestone::spherical {
namespace {

ResampleConfig checked(const ResampleConfig& config) {
  const bool sides = config.sides == 2 || config.sides == 4 || config.sides == 8;
  if (sides && config.size >= 1 && config.size <= 32768 / config.sides) return config;
  throw InputError(describe("", "octahedral image",
                            "has " + std::to_string(config.size) + " pixels along a side of " +
                                std::to_string(config.sides) + " samples each",
                            "give 2, 4 or 8 samples, and at least one pixel and at most 32768 samples along a side"));
}

}  // namespace

Resampler::Resampler(const Surface& surface, std::span<const Vec3d> directions, const SurfaceSource& source,
                     const ResampleConfig& config)
    : source_(source),
      config_(checked(config)),
      raster_(surface.triangles, directions, {config_.size * config_.sides, SampleGrid::Placing::in_cells}) {
  const std::size_t pixels = std::size_t{config_.size} * config_.size;
  if (config_.colours) images_.colour = {{config_.size, config_.size}, 4, std::vector<float>(4 * pixels)};
  if (config_.normals) images_.normal = {{config_.size, config_.size}, 3, std::vector<float>(3 * pixels)};
  covered_.resize(pixels);
}

// The sums over the parts of each pixel of a row; memory is reused.
struct Resampler::Row {
  PixelRow pixels;
  std::vector<Float4> mapped{}, normal{};                       // by point
  std::array<Float4, PixelRow::most_pixels> light{}, vector{};  // by pixel
  std::array<float, PixelRow::most_pixels> samples{};           // by pixel; 0: without a source
};

// Light and vectors are added up with the samples as weight. The first part of a pixel has its number.
void Resampler::add_up(Row& row) const {
  const std::span<const PixelPart> parts = row.pixels.parts();
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const PixelPart& part = parts[p];
    if (p == part.x) row.samples[p] = 0, row.light[p] = row.vector[p] = Float4{};
    if (part.samples == 0) continue;
    row.samples[part.x] += part.samples;
    if (config_.colours)
      row.light[part.x] += all4(part.samples) * source_.colour(row.pixels.points(p), row.pixels.colour_taps(p));
  }
  if (config_.normals) add_normals(row);
}

void Resampler::add_normals(Row& row) const {
  const std::span<const PixelPart> parts = row.pixels.parts();
  row.mapped.resize(row.pixels.points().size()), row.normal.resize(row.mapped.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].samples == 0) continue;
    const Float4 mapped = source_.mapped_normal(row.pixels.triangle(p), row.pixels.normal_taps(p));
    for (std::uint32_t k = parts[p].points_begin; k < parts[p].points_end; ++k) row.mapped[k] = mapped;
  }
  source_.set_normals(row.pixels.points(), row.mapped, row.normal);
  for (const PixelPart& part : parts)
    if (part.samples > 0)
      for (std::uint32_t k = part.points_begin; k < part.points_end; ++k)
        row.vector[part.x] += all4(part.samples) * row.normal[k];
}

// `first` is the number of the row's first pixel.
void Resampler::set(const Row& row, std::size_t first, std::size_t count) {
  for (std::size_t x = 0; x < count; ++x) {
    if (row.samples[x] == 0) continue;
    covered_[first + x] = 1;
    if (config_.colours) store(&images_.colour.values[4 * (first + x)], all4(1 / row.samples[x]) * row.light[x]);
    if (!config_.normals) continue;
    const Vec3f normal = to_vec3f(row.vector[x]);
    const float size = length(normal), scale = size > 0 ? 1 / size : 0;
    float* const to = &images_.normal.values[3 * (first + x)];
    to[0] = scale * normal.x, to[1] = scale * normal.y, to[2] = scale * normal.z;
  }
}

void Resampler::draw(std::size_t tile, SampleTile& room) {
  raster_.cover(tile, room);
  Row row{PixelRow(source_, config_.sides, {config_.colours, config_.normals})};
  for (std::uint32_t y = 0; y < room.height / config_.sides; ++y) {
    row.pixels.gather(room, y);
    add_up(row);
    set(row, std::size_t{room.y / config_.sides + y} * config_.size + room.x / config_.sides,
        room.width / config_.sides);
  }
}

// Pixels without a source.
void Resampler::fill() {
  const auto n = static_cast<std::int64_t>(config_.size);
  const auto index = [n](std::int64_t x, std::int64_t y) {
    const Texel at = continued({x, y}, n);
    return static_cast<std::size_t>(at.y * n + at.x);
  };
  const auto set_mean = [](std::span<const std::size_t> from, std::size_t to, LinearImage& image) {
    for (std::size_t c = 0; c < image.channels && !image.values.empty(); ++c) {
      float sum = 0;
      for (const std::size_t texel : from) sum += image.values[texel * image.channels + c];
      image.values[to * image.channels + c] = sum / static_cast<float>(from.size());
    }
  };
  extend_cover(covered_, {config_.size, config_.size}, covered_.size(), index,
               [&](std::span<const std::size_t> from, std::size_t to) {
                 set_mean(from, to, images_.colour);
                 set_mean(from, to, images_.normal);
               });
}

ResampledImages Resampler::finish() {
  images_.filled = covered_.size() - std::accumulate(covered_.begin(), covered_.end(), std::uint64_t{0});
  if (images_.filled > 0 && images_.filled < covered_.size()) fill();
  for (LinearImage* const image : {&images_.colour, &images_.normal})
    if (!image->values.empty()) average_border(*image);
  return std::move(images_);
}

ResampledImages resample(const Surface& surface, std::span<const Vec3d> directions, const SurfaceSource& source,
                         const ResampleConfig& config) {
  Resampler resampler(surface, directions, source, config);
  resampler.raster().prepare();
  SampleTile room;
  for (std::size_t tile = 0; tile < resampler.raster().tile_count(); ++tile) resampler.draw(tile, room);
  return resampler.finish();
}

}  // namespace lodestone::spherical
