#include "core/spherical/resample/resampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/spherical/octahedron/octahedral_image.h"
#include "core/spherical/resample/chart_cover.h"

namespace lodestone::spherical {
namespace {

constexpr std::size_t most_samples = 64;
// Two points of a chart whose texture coordinates are further apart than a pixel covers, times this, are on both sides
// of a border of the chart with itself.
constexpr float reach = 4;

Vec2f difference(Vec2f a, Vec2f b) { return {a.x - b.x, a.y - b.y}; }
float extent(Vec2f a) { return std::max(std::abs(a.x), std::abs(a.y)); }

// The side of a sample in the middle of the tile, from the diagonal of its neighbours; of a single one, anything.
float side_in(const SampleTile& tile) {
  const std::uint32_t x = tile.width / 2, y = tile.height / 2;
  const std::size_t at = std::size_t{y} * SampleTile::side + x;
  const std::size_t before = at - (x > 0 ? 1 : 0) - (y > 0 ? SampleTile::side : 0);
  double square = 0;
  for (const std::vector<double>& d : tile.direction) square += (d[at] - d[before]) * (d[at] - d[before]);
  return static_cast<float>(std::sqrt(0.5 * square));
}

ResampleConfig checked(const ResampleConfig& config) {
  const bool sides = config.sides == 2 || config.sides == 4 || config.sides == 8;
  if (sides && config.size >= 1 && config.size <= 32768 / config.sides) return config;
  throw InputError(describe("", "octahedral image",
                            "has " + std::to_string(config.size) + " pixels along a side of " +
                                std::to_string(config.sides) + " samples each",
                            "give 2, 4 or 8 samples, and at least one pixel and at most 32768 samples along a side"));
}

}  // namespace

struct Resampler::Pixel {
  std::array<SurfacePoint, most_samples> point;  // those that have a source
  std::array<Vec2f, most_samples> uv;
  std::size_t count = 0;
  float side = 0;       // of a sample on the sphere, in the middle of the tile
  bool single = false;  // all samples are in one triangle, at `middle` in the mean; then `point` and `uv` are unused
  bool whole = false;   // all samples are in one part of one chart
  SurfacePoint middle;
  Footprint footprint;  // if whole
};

Resampler::Resampler(const Surface& surface, std::span<const Vec3d> directions, const SurfaceSource& source,
                     const ResampleConfig& config)
    : source_(source),
      config_(checked(config)),
      raster_(surface.triangles, directions, {config_.size * config_.sides, SampleGrid::Placing::in_cells}) {
  const std::size_t pixels = std::size_t{config_.size} * config_.size;
  images_.colour = {{config_.size, config_.size}, 4, std::vector<float>(4 * pixels)};
  if (config_.normals) images_.normal = {{config_.size, config_.size}, 3, std::vector<float>(3 * pixels)};
  covered_.resize(pixels);
}

// The same as gather(), faster, if all samples are in one triangle; else returns false.
bool Resampler::gather_single(const SampleTile& tile, std::size_t first, Pixel& pixel) const {
  const std::size_t sides = config_.sides, right = sides - 1, below = right * SampleTile::side;
  const std::uint32_t triangle = tile.triangle[first];
  for (std::size_t j = 0; j < sides; ++j)
    for (std::size_t i = 0; i < sides; ++i)
      if (tile.triangle[first + j * SampleTile::side + i] != triangle) return false;
  if (triangle == no_triangle || !source_.has(triangle)) return false;
  pixel.single = pixel.whole = true;
  pixel.middle.triangle = triangle;
  const float scale = 0.5f * static_cast<float>(sides) / static_cast<float>(sides - 1);
  std::array<float, 3> by_x, by_y;
  for (std::size_t c = 0; c < 3; ++c) {
    const float* const w = &tile.weight[c][first];
    float sum = 0;
    for (std::size_t j = 0; j < sides; ++j)
      for (std::size_t i = 0; i < sides; ++i) sum += w[j * SampleTile::side + i];
    pixel.middle.weight[c] = sum / static_cast<float>(sides * sides);
    by_x[c] = scale * ((w[right] - w[0]) + (w[below + right] - w[below]));
    by_y[c] = scale * ((w[below] - w[0]) + (w[below + right] - w[right]));
  }
  pixel.footprint = source_.footprint(pixel.middle, by_x, by_y);
  return true;
}

// False if no sample has a source.
bool Resampler::gather(const SampleTile& tile, std::size_t first, Pixel& pixel) const {
  if (gather_single(tile, first, pixel)) return true;
  const std::size_t sides = config_.sides;
  pixel.count = 0;
  pixel.single = false;
  for (std::size_t j = 0; j < sides; ++j)
    for (std::size_t i = 0; i < sides; ++i) {
      const std::size_t sample = first + j * SampleTile::side + i;
      const std::uint32_t triangle = tile.triangle[sample];
      if (triangle == no_triangle || !source_.has(triangle)) continue;
      SurfacePoint& point = pixel.point[pixel.count];
      point = {triangle, {tile.weight[0][sample], tile.weight[1][sample], tile.weight[2][sample]}};
      pixel.uv[pixel.count++] = source_.uv(point);
    }
  if (pixel.count == 0) return false;
  pixel.whole = pixel.count == sides * sides;
  const float allowed = reach * source_.uv_scale(pixel.point[0].triangle) * pixel.side * static_cast<float>(sides);
  const std::uint32_t triangle = pixel.point[0].triangle;
  for (std::size_t k = 1; k < pixel.count && pixel.whole; ++k) {
    if (pixel.point[k].triangle == triangle) continue;
    pixel.whole = source_.chart(pixel.point[k].triangle) == source_.chart(triangle) &&
                  extent(difference(pixel.uv[k], pixel.uv[0])) <= allowed;
  }
  if (!pixel.whole) return true;
  // From corner to corner, means over both sides, extended by one sample.
  const Vec2f a = pixel.uv[0], b = pixel.uv[sides - 1], c = pixel.uv[pixel.count - sides],
              d = pixel.uv[pixel.count - 1];
  const float scale = 0.5f * static_cast<float>(sides) / static_cast<float>(sides - 1);
  pixel.footprint = {{0.25f * ((a.x + d.x) + (b.x + c.x)), 0.25f * ((a.y + d.y) + (b.y + c.y))},
                     {scale * ((b.x - a.x) + (d.x - c.x)), scale * ((b.y - a.y) + (d.y - c.y))},
                     {scale * ((c.x - a.x) + (d.x - b.x)), scale * ((c.y - a.y) + (d.y - b.y))}};
  return true;
}

void Resampler::draw_pixel(const SampleTile& tile, std::uint32_t x, std::uint32_t y, Pixel& pixel) {
  if (!gather(tile, (std::size_t{y} * SampleTile::side + x) * config_.sides, pixel)) return;
  const std::size_t number = std::size_t{tile.y / config_.sides + y} * config_.size + (tile.x / config_.sides + x);
  covered_[number] = 1;
  // Where a part of a chart is filtered at once, any point will do: the colour depends on the footprint alone.
  const SurfacePoint& point = pixel.single ? pixel.middle : pixel.point[0];
  const auto footprint = [&](std::size_t k) {
    const float side = source_.uv_scale(pixel.point[k].triangle) * pixel.side;
    return Footprint{pixel.uv[k], {side, 0}, {0, side}};
  };
  Float4 colour{};
  if (pixel.single || (pixel.whole && !source_.has_vertex_colours())) {
    colour = source_.colour(point, pixel.footprint);
  } else {
    for (std::size_t k = 0; k < pixel.count; ++k) colour += source_.colour(pixel.point[k], footprint(k));
    colour *= all4(1 / static_cast<float>(pixel.count));
  }
  for (int c = 0; c < 4; ++c) images_.colour.values[4 * number + static_cast<std::size_t>(c)] = colour[c];
  if (!config_.normals) return;
  Vec3f normal{};
  if (pixel.single || (pixel.whole && source_.has_object_space_normals(point.triangle))) {
    normal = source_.normal(point, pixel.footprint);
  } else {
    for (std::size_t k = 0; k < pixel.count; ++k) normal = normal + source_.normal(pixel.point[k], footprint(k));
  }
  const float size = length(normal);
  if (size > 0) normal = (1 / size) * normal;
  images_.normal.values[3 * number] = normal.x;
  images_.normal.values[3 * number + 1] = normal.y;
  images_.normal.values[3 * number + 2] = normal.z;
}

void Resampler::draw(std::size_t tile, SampleTile& room) {
  raster_.cover(tile, room);
  Pixel pixel;  // reused: larger than what is done with it
  pixel.side = side_in(room);
  for (std::uint32_t y = 0; y < room.height / config_.sides; ++y)
    for (std::uint32_t x = 0; x < room.width / config_.sides; ++x) {
      const std::size_t later = (std::size_t{y} * SampleTile::side + x) * config_.sides + prefetch_distance;
      if (later < room.triangle.size() && room.triangle[later] != no_triangle) source_.prefetch(room.triangle[later]);
      draw_pixel(room, x, y, pixel);
    }
}

void Resampler::fill(LinearImage& image, std::vector<std::uint8_t> covered) const {
  if (image.values.empty() || std::ranges::count(covered, 1) == 0) return;
  const std::size_t channels = image.channels, n = image.size.width;
  const auto index = [n](std::int64_t x, std::int64_t y) {
    const Texel at = continued({x, y}, static_cast<std::int64_t>(n));
    return static_cast<std::size_t>(at.y) * n + static_cast<std::size_t>(at.x);
  };
  extend_cover(covered, image.size, covered.size(), index, [&](std::span<const std::size_t> from, std::size_t to) {
    for (std::size_t c = 0; c < channels; ++c) {
      float sum = 0;
      for (const std::size_t texel : from) sum += image.values[texel * channels + c];
      image.values[to * channels + c] = sum / static_cast<float>(from.size());
    }
  });
}

ResampledImages Resampler::finish() {
  images_.filled = static_cast<std::uint64_t>(std::ranges::count(covered_, 0));
  for (LinearImage* const image : {&images_.colour, &images_.normal}) {
    fill(*image, covered_);
    if (!image->values.empty()) average_border(*image);
  }
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
