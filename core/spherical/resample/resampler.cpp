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
  bool whole = false;   // all samples are in one part of one chart; if in one triangle, `point` is their mean alone
  Footprint footprint;  // if whole
};

struct Resampler::Row {
  struct Job {
    std::size_t number = 0;  // of the pixel
    float samples = 0;
    std::size_t points_begin = 0, points_end = 0;  // of points
    SurfaceTaps taps;
  };
  std::vector<Job> jobs;
  std::vector<SurfacePoint> points;
  TapList taps;
  TextureFrame frame;
  void clear() { jobs.clear(), points.clear(), taps.count = 0; }
};

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

// The same as gather(), faster, if all samples are in one triangle; else returns false.
bool Resampler::gather_single(const SampleTile& tile, std::size_t first, Pixel& pixel) const {
  const std::size_t sides = config_.sides, right = sides - 1, below = right * SampleTile::side;
  const std::uint32_t triangle = tile.triangle[first];
  for (std::size_t j = 0; j < sides; ++j)
    for (std::size_t i = 0; i < sides; ++i)
      if (tile.triangle[first + j * SampleTile::side + i] != triangle) return false;
  if (triangle == no_triangle || !source_.has(triangle)) return false;
  pixel.whole = true, pixel.count = 1;
  SurfacePoint& middle = pixel.point[0];
  middle.triangle = triangle;
  const float scale = 0.5f * static_cast<float>(sides) / static_cast<float>(sides - 1);
  std::array<float, 3> by_x, by_y;
  for (std::size_t c = 0; c < 3; ++c) {
    const float* const w = &tile.weight[c][first];
    float sum = 0;
    for (std::size_t j = 0; j < sides; ++j)
      for (std::size_t i = 0; i < sides; ++i) sum += w[j * SampleTile::side + i];
    middle.weight[c] = sum / static_cast<float>(sides * sides);
    by_x[c] = scale * ((w[right] - w[0]) + (w[below + right] - w[below]));
    by_y[c] = scale * ((w[below] - w[0]) + (w[below + right] - w[right]));
  }
  pixel.footprint = source_.footprint(middle, by_x, by_y);
  return true;
}

// True if two samples are on one side of all borders of charts.
bool Resampler::are_together(const Pixel& pixel, std::size_t k, std::size_t l) const {
  const std::uint32_t triangle = pixel.point[k].triangle, other = pixel.point[l].triangle;
  const float allowed = reach * source_.uv_scale(triangle) * pixel.side * static_cast<float>(config_.sides);
  return triangle == other ||
         (source_.chart(triangle) == source_.chart(other) && extent(difference(pixel.uv[k], pixel.uv[l])) <= allowed);
}

// False if no sample has a source.
bool Resampler::gather(const SampleTile& tile, std::size_t first, Pixel& pixel) const {
  if (gather_single(tile, first, pixel)) return true;
  const std::size_t sides = config_.sides;
  pixel.count = 0;
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
  for (std::size_t k = 1; k < pixel.count && pixel.whole; ++k) pixel.whole = are_together(pixel, 0, k);
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

// The normal need not be of unit length.
void Resampler::set(std::size_t number, Float4 colour, Vec3f normal) {
  if (config_.colours)
    for (int c = 0; c < 4; ++c) images_.colour.values[4 * number + static_cast<std::size_t>(c)] = colour[c];
  if (!config_.normals) return;
  const float size = length(normal);
  if (size > 0) normal = (1 / size) * normal;
  images_.normal.values[3 * number] = normal.x;
  images_.normal.values[3 * number + 1] = normal.y;
  images_.normal.values[3 * number + 2] = normal.z;
}

// Jobs of one pixel follow each other: light and vectors are added up with the samples as weight.
void Resampler::draw_jobs(Row& row) {
  for (std::size_t k = 0; k < row.jobs.size();) {
    const std::size_t number = row.jobs[k].number;
    Float4 colour{};
    Vec3f normal{};
    float weight = 0;
    for (; k < row.jobs.size() && row.jobs[k].number == number; ++k) {
      const Row::Job& job = row.jobs[k];
      const std::span<const SurfacePoint> points(&row.points[job.points_begin], job.points_end - job.points_begin);
      weight += job.samples;
      if (config_.colours)
        colour +=
            all4(job.samples) * source_.colour(points, row.taps.between(job.taps.colour_begin, job.taps.colour_end));
      if (config_.normals)
        normal =
            normal + job.samples * source_.normal(points, row.taps.between(job.taps.normal_begin, job.taps.normal_end),
                                                  row.frame);
    }
    set(number, all4(1 / weight) * colour, normal);
  }
}

// The samples of one part of a chart, with a footprint of their area; those in one triangle become one point.
void Resampler::add_job(std::size_t number, std::span<const SurfacePoint> points, const Footprint& footprint,
                        Row& row) const {
  const std::size_t first = row.points.size();
  const auto samples = static_cast<float>(points.size());
  for (const SurfacePoint& point : points) {
    const auto same = std::find_if(row.points.begin() + static_cast<std::ptrdiff_t>(first), row.points.end(),
                                   [&](const SurfacePoint& p) { return p.triangle == point.triangle; });
    SurfacePoint& sum = same == row.points.end() ? row.points.emplace_back(SurfacePoint{point.triangle, {}}) : *same;
    for (std::size_t c = 0; c < 3; ++c) sum.weight[c] += point.weight[c] / samples;
  }
  Row::Job& job = row.jobs.emplace_back(Row::Job{number, samples, first, row.points.size(), {}});
  job.taps = source_.add_taps(points[0].triangle, footprint, {config_.colours, config_.normals}, row.taps);
}

// Samples on both sides of a border between charts: those that belong together.
void Resampler::add_parts(std::size_t number, Pixel& pixel, Row& row) const {
  for (std::size_t begin = 0, end = 0; begin < pixel.count; begin = end) {
    Vec2f centre = pixel.uv[begin];
    end = begin + 1;
    for (std::size_t k = end; k < pixel.count; ++k) {
      if (!are_together(pixel, begin, k)) continue;
      std::swap(pixel.point[k], pixel.point[end]);
      std::swap(pixel.uv[k], pixel.uv[end]);
      centre = {centre.x + pixel.uv[end].x, centre.y + pixel.uv[end].y};
      ++end;
    }
    const auto samples = static_cast<float>(end - begin);
    const float side = source_.uv_scale(pixel.point[begin].triangle) * pixel.side * std::sqrt(samples);
    const Footprint footprint{{centre.x / samples, centre.y / samples}, {side, 0}, {0, side}};
    add_job(number, std::span(pixel.point).subspan(begin, end - begin), footprint, row);
  }
}

void Resampler::draw_row(const SampleTile& tile, std::uint32_t y, Pixel& pixel, Row& row) {
  row.clear();
  for (std::uint32_t x = 0; x < tile.width / config_.sides; ++x) {
    const std::size_t first = (std::size_t{y} * SampleTile::side + x) * config_.sides,
                      later = first + prefetch_distance;
    if (later < tile.triangle.size() && tile.triangle[later] != no_triangle) source_.prefetch(tile.triangle[later]);
    if (!gather(tile, first, pixel)) continue;
    const std::size_t number = std::size_t{tile.y / config_.sides + y} * config_.size + (tile.x / config_.sides + x);
    covered_[number] = 1;
    if (pixel.whole) {
      add_job(number, std::span(pixel.point).first(pixel.count), pixel.footprint, row);
    } else {
      add_parts(number, pixel, row);
    }
  }
  draw_jobs(row);
}

void Resampler::draw(std::size_t tile, SampleTile& room) {
  raster_.cover(tile, room);
  Pixel pixel;  // reused: larger than what is done with it
  Row row;
  pixel.side = side_in(room);
  for (std::uint32_t y = 0; y < room.height / config_.sides; ++y) draw_row(room, y, pixel, row);
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
