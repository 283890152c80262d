#include "core/spherical/resample/pixel_row.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lodestone::spherical {
namespace {

// Two points of a chart whose texture coordinates are further apart than a pixel covers, times this, are on both sides
// of a border of the chart with itself.
constexpr float reach = 4;

Vec2f difference(Vec2f a, Vec2f b) { return {a.x - b.x, a.y - b.y}; }
float extent(Vec2f a) { return std::max(std::abs(a.x), std::abs(a.y)); }

// The side of a sample in the middle of the tile, from the diagonal of its neighbours; of a single one, anything.
float side_in(const SampleTile& tile) {
  const std::uint32_t x = tile.width / 2, y = tile.height / 2;
  const std::size_t at = std::size_t{y} * SampleTile::side + x;
  const auto direction = [&](std::size_t sample) {
    const Vec3d ray{tile.ray[0][sample], tile.ray[1][sample], tile.ray[2][sample]};
    return (1 / length(ray)) * ray;
  };
  const std::size_t before = at - (x > 0 ? 1 : 0) - (y > 0 ? SampleTile::side : 0);
  return static_cast<float>(std::sqrt(0.5) * length(direction(at) - direction(before)));
}

// From means over two sides, across all samples but one, to a whole pixel.
constexpr float to_pixel(std::size_t sides) { return 0.5f * static_cast<float>(sides) / static_cast<float>(sides - 1); }

}  // namespace

PixelRow::PixelRow(const SurfaceSource& source, std::uint32_t sides, SurfaceSource::Looks looks)
    : source_(source), sides_(sides), looks_(looks) {
  const std::size_t most = std::size_t{SampleTile::side} * sides + 3;
  parts_.resize(most), triangles_.resize(most), ranges_.resize(most), points_.resize(most);
  for (std::vector<float>& component : footprints_) component.resize(most);
}

template <std::size_t sides>
void PixelRow::set_means(const SampleTile& tile, std::uint32_t y) {
  constexpr std::size_t count = SampleTile::side / sides, last = sides - 1;
  constexpr float scale = to_pixel(sides), part = 1 / static_cast<float>(sides * sides);
  const std::size_t begin = std::size_t{y} * sides * SampleTile::side;
  const std::uint32_t* const triangle = &tile.triangle[begin];
  for (std::size_t x = 0; x < count; ++x) {
    std::uint32_t others = 0;
    for (std::size_t j = 0; j < sides; ++j)
      for (std::size_t i = 0; i < sides; ++i)
        others |= triangle[j * SampleTile::side + x * sides + i] ^ triangle[x * sides];
    single_[x] = others == 0 ? 1 : 0;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const float* const weight = &tile.weight[c][begin];
    for (std::size_t x = 0; x < count; ++x) {
      const float* const w = weight + x * sides;
      const float* const below = w + last * SampleTile::side;
      float sum = 0;
      for (std::size_t j = 0; j < sides; ++j)
        for (std::size_t i = 0; i < sides; ++i) sum += w[j * SampleTile::side + i];
      weight_[c][x] = part * sum;
      by_x_[c][x] = scale * ((w[last] - w[0]) + (below[last] - below[0]));
      by_y_[c][x] = scale * ((below[0] - w[0]) + (below[last] - w[last]));
    }
  }
}

void PixelRow::gather(const SampleTile& tile, std::uint32_t y) {
  if (y == 0) side_ = side_in(tile);
  sides_ == 2 ? set_means<2>(tile, y) : sides_ == 4 ? set_means<4>(tile, y) : set_means<8>(tile, y);
  const std::uint32_t pixels = tile.width / sides_;
  const std::size_t begin = std::size_t{y} * sides_ * SampleTile::side;
  part_count_ = pixels, point_count_ = 0, taps_.count = 0;
  for (std::uint32_t x = 0; x < pixels; x += 4) add_singles(x, std::min(pixels - x, 4u), &tile.triangle[begin]);
  for (std::uint32_t x = 0; x < pixels; ++x)
    if (single_[x] == 0) add_mixed(x, tile, begin + std::size_t{x} * sides_);
  add_taps();
  for (std::size_t p = point_count_; p % 4 != 0; ++p) points_[p] = points_[point_count_ - 1];
}

// Four pixels, as if each were in one triangle.
void PixelRow::add_singles(std::uint32_t x, std::uint32_t count, const std::uint32_t* samples) {
  std::array<std::uint32_t, 4> triangles{};
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t triangle = samples[(x + k) * sides_];
    const bool is_single = single_[x + k] != 0 && triangle != no_triangle && source_.has(triangle);
    triangles[k] = is_single ? triangle : 0;
    const auto point = static_cast<std::uint32_t>(point_count_);
    parts_[x + k] = {x + k, is_single ? static_cast<float>(sides_ * sides_) : 0, point, point + 1};
    points_[point] = {triangle, {weight_[0][x + k], weight_[1][x + k], weight_[2][x + k]}};
    point_count_ += is_single ? 1 : 0;
  }
  const auto lanes = [x](const Numbers& numbers) {
    return SurfaceSource::Weights4{load<Float4>(&numbers[1][x]), load<Float4>(&numbers[2][x])};
  };
  const Footprint4 f = source_.footprints(triangles, lanes(weight_), lanes(by_x_), lanes(by_y_));
  std::copy_n(triangles.begin(), 4, &triangles_[x]);
  const std::array<Float4, 6> components{f.centre_u, f.centre_v, f.along_x_u, f.along_x_v, f.along_y_u, f.along_y_v};
  for (std::size_t c = 0; c < 6; ++c) store(&footprints_[c][x], components[c]);
}

void PixelRow::add_taps() {
  for (std::size_t p = 0; p < part_count_; p += 4) {
    const std::size_t count = std::min<std::size_t>(part_count_ - p, 4);
    const auto lanes = [&](std::size_t c) { return load<Float4>(&footprints_[c][p]); };
    source_.add_taps(std::span(triangles_).subspan(p, count),
                     {lanes(0), lanes(1), lanes(2), lanes(3), lanes(4), lanes(5)}, looks_, taps_,
                     std::span(ranges_).subspan(p, count));
  }
}

// Samples in several triangles, four at a time.
void PixelRow::add_mixed(std::uint32_t x, const SampleTile& tile, std::size_t first) {
  samples_.count = 0;
  const std::size_t count = std::size_t{sides_} * sides_;
  for (std::size_t s = 0; s < count; s += 4) {
    std::array<std::size_t, 4> at;
    for (std::size_t k = 0; k < 4; ++k) at[k] = first + (s + k) / sides_ * SampleTile::side + (s + k) % sides_;
    std::array<std::uint32_t, 4> triangles;
    for (std::size_t k = 0; k < 4; ++k) triangles[k] = tile.triangle[at[k]] == no_triangle ? 0 : tile.triangle[at[k]];
    const auto lanes = [&](std::size_t c) {
      const std::vector<float>& w = tile.weight[c];
      return Float4{w[at[0]], w[at[1]], w[at[2]], w[at[3]]};
    };
    const SurfaceSource::Weights4 weights{lanes(1), lanes(2)};
    const SurfaceSource::Coordinates4 uv = source_.uv(triangles, weights);
    for (std::size_t k = 0; k < 4; ++k) {
      if (tile.triangle[at[k]] == no_triangle || !source_.has(triangles[k])) continue;
      samples_.point[samples_.count] = {triangles[k], {tile.weight[0][at[k]], weights.b[k], weights.c[k]}};
      samples_.uv[samples_.count++] = {uv.u[k], uv.v[k]};
    }
  }
  bool whole = samples_.count == count;
  for (std::size_t k = 1; k < samples_.count && whole; ++k) whole = are_together(0, k);
  if (whole) return add_part(x, std::span(samples_.point).first(samples_.count), whole_footprint());
  add_parts(x);
}

// True if two samples are on one side of all borders of charts.
bool PixelRow::are_together(std::size_t k, std::size_t l) const {
  const std::uint32_t triangle = samples_.point[k].triangle, other = samples_.point[l].triangle;
  if (triangle == other) return true;
  const float allowed = reach * source_.uv_scale(triangle) * side_ * static_cast<float>(sides_);
  return source_.chart(triangle) == source_.chart(other) &&
         extent(difference(samples_.uv[k], samples_.uv[l])) <= allowed;
}

// From corner to corner of the pixel, means over both sides.
Footprint PixelRow::whole_footprint() const {
  const Vec2f a = samples_.uv[0], b = samples_.uv[sides_ - 1], c = samples_.uv[samples_.count - sides_],
              d = samples_.uv[samples_.count - 1];
  const float scale = to_pixel(sides_);
  return {{0.25f * ((a.x + d.x) + (b.x + c.x)), 0.25f * ((a.y + d.y) + (b.y + c.y))},
          {scale * ((b.x - a.x) + (d.x - c.x)), scale * ((b.y - a.y) + (d.y - c.y))},
          {scale * ((c.x - a.x) + (d.x - b.x)), scale * ((c.y - a.y) + (d.y - b.y))}};
}

// Samples on both sides of a border between charts: those that belong together, with a footprint of their area.
void PixelRow::add_parts(std::uint32_t x) {
  for (std::size_t begin = 0, end = 0; begin < samples_.count; begin = end) {
    Vec2f centre = samples_.uv[begin];
    end = begin + 1;
    for (std::size_t k = end; k < samples_.count; ++k) {
      if (!are_together(begin, k)) continue;
      std::swap(samples_.point[k], samples_.point[end]);
      std::swap(samples_.uv[k], samples_.uv[end]);
      centre = {centre.x + samples_.uv[end].x, centre.y + samples_.uv[end].y};
      ++end;
    }
    const auto samples = static_cast<float>(end - begin);
    const float side = source_.uv_scale(samples_.point[begin].triangle) * side_ * std::sqrt(samples);
    add_part(x, std::span(samples_.point).subspan(begin, end - begin),
             {{centre.x / samples, centre.y / samples}, {side, 0}, {0, side}});
  }
}

// Those in one triangle become one point.
void PixelRow::add_part(std::uint32_t x, std::span<const SurfacePoint> points, const Footprint& footprint) {
  const std::size_t first = point_count_;
  const auto samples = static_cast<float>(points.size());
  const float share = 1 / samples;
  for (const SurfacePoint& point : points) {
    std::size_t same = first;
    while (same < point_count_ && points_[same].triangle != point.triangle) ++same;
    if (same == point_count_) points_[point_count_++] = {point.triangle, {}};
    for (std::size_t c = 0; c < 3; ++c) points_[same].weight[c] += share * point.weight[c];
  }
  const std::size_t part = parts_[x].samples == 0 ? x : part_count_++;
  parts_[part] = {x, samples, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(point_count_)};
  triangles_[part] = points[0].triangle;
  const std::array<float, 6> components{footprint.centre.x,  footprint.centre.y,  footprint.along_x.x,
                                        footprint.along_x.y, footprint.along_y.x, footprint.along_y.y};
  for (std::size_t c = 0; c < 6; ++c) footprints_[c][part] = components[c];
}

}  // namespace lodestone::spherical
