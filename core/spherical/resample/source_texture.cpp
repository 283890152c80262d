#include "core/spherical/resample/source_texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/base/prefetch.h"
#include "core/formats/common/colour.h"
#include "core/spherical/resample/chart_cover.h"
#include "core/texture/texel_wrap.h"

namespace lodestone::spherical {
namespace {

constexpr std::size_t rings = 3;        // texels that filters may find outside of a chart
constexpr float longest_footprint = 8;  // samples along a footprint
constexpr std::size_t most_taps = 2 * static_cast<std::size_t>(longest_footprint);  // two at a border of the image
// The side, in texels, of the box that spreads as much as interpolation between texels does: 1/12 for the texel and
// 1/6 for the tent make 1/4 of a texel's square, as does a box of the square root of 3. The
// level next to it is sharper by 1 dB than one with texels as large as the footprint, and than a mean of two levels.
constexpr float tap_square = 3, tap_extent = 1.7320508f;

std::uint16_t wide(float unit) { return static_cast<std::uint16_t>(unit * 65535 + 0.5f); }

// Without a call, where the processor has no instruction for it.
std::int64_t floor_of(float v) {
  const auto towards_zero = static_cast<std::int64_t>(v);
  return towards_zero - (v < static_cast<float>(towards_zero) ? 1 : 0);
}

// log2, linear between powers of two (blinn1997); for v >= 1.
float rough_log2(float v) { return static_cast<float>(std::bit_cast<std::uint32_t>(v)) * 0x1p-23f - 127; }

}  // namespace

SourceTexture::SourceTexture(const PixelImage& image, PixelMeaning meaning, TextureWrap wrap_u, TextureWrap wrap_v,
                             std::vector<std::uint8_t> covered)
    : wrap_u_(wrap_u), wrap_v_(wrap_v), meaning_(meaning) {
  std::array<float, 256> value;
  for (std::size_t byte = 0; byte < 256; ++byte)
    value[byte] = meaning == PixelMeaning::colours ? linear_of_srgb()[byte] : static_cast<float>(byte) / 255;
  std::size_t count = 0;
  for (PixelSize size = image.size;; size = half_of(size)) {
    levels_.push_back({size, count});
    count += levels_.back().count();
    if (size == PixelSize{1, 1}) break;
  }
  texels_.resize(count + 1);
  const std::size_t channels = image.channels;
  for (std::size_t p = 0; p < covered.size(); ++p) {
    const std::uint8_t* const pixel = &image.pixels[p * channels];
    const bool scaled = channels == 4 && meaning == PixelMeaning::colours;
    const float alpha = channels == 4 ? static_cast<float>(pixel[3]) / 255 : 1;
    for (std::size_t c = 0; c < 3; ++c)
      texels_[p][c] = wide(value[pixel[channels == 1 ? 0 : c]] * (scaled ? alpha : 1));
    texels_[p][3] = wide(alpha);
  }
  add_levels(std::move(covered));
}

// A texel is the mean of the covered ones among the four, at odd ends six or nine, that it is made of.
void SourceTexture::add_levels(std::vector<std::uint8_t> covered) {
  std::vector<std::vector<std::uint8_t>> covers;
  covers.push_back(std::move(covered));
  for (std::size_t l = 1; l < levels_.size(); ++l) {
    const PixelSize full = levels_[l - 1].size, size = levels_[l].size;
    const Texel* const from = &texels_[levels_[l - 1].first];
    Texel* const to = &texels_[levels_[l].first];
    std::vector<std::uint8_t> cover(levels_[l].count());
    for (std::size_t y = 0; y < size.height; ++y)
      for (std::size_t x = 0; x < size.width; ++x) {
        // The last texel of an odd row takes three.
        const std::size_t right = x + 1 == size.width ? full.width : 2 * x + 2;
        const std::size_t bottom = y + 1 == size.height ? full.height : 2 * y + 2;
        std::array<std::uint32_t, 4> sum{}, all{};
        std::uint32_t count = 0, texels = 0;
        for (std::size_t j = 2 * y; j < bottom; ++j)
          for (std::size_t i = 2 * x; i < right; ++i, ++texels) {
            const Texel& texel = from[j * full.width + i];
            const std::uint32_t within = covers.back()[j * full.width + i];
            for (std::size_t c = 0; c < 4; ++c) all[c] += texel[c], sum[c] += within * texel[c];
            count += within;
          }
        if (count == 0) sum = all;
        const std::uint32_t parts = count == 0 ? texels : count;
        Texel& texel = to[y * size.width + x];
        for (std::size_t c = 0; c < 4; ++c) texel[c] = static_cast<std::uint16_t>((sum[c] + parts / 2) / parts);
        cover[y * size.width + x] = count > 0;
      }
    covers.push_back(std::move(cover));
  }
  for (std::size_t l = 0; l < levels_.size(); ++l) extend(levels_[l], covers[l]);
}

void SourceTexture::extend(const Level& level, std::vector<std::uint8_t>& covered) {
  const PixelSize size = level.size;
  Texel* const texels = &texels_[level.first];
  const auto index = [&](std::int64_t x, std::int64_t y) {
    if (x >= 0 && y >= 0 && x < size.width && y < size.height) return static_cast<std::size_t>(y * size.width + x);
    return std::size_t{wrapped(y, size.height, wrap_v_)} * size.width + wrapped(x, size.width, wrap_u_);
  };
  extend_cover(covered, size, rings, index, [&](std::span<const std::size_t> from, std::size_t to) {
    std::array<std::uint32_t, 4> sum{};
    for (const std::size_t texel : from)
      for (std::size_t c = 0; c < 4; ++c) sum[c] += texels[texel][c];
    const auto count = static_cast<std::uint32_t>(from.size());
    for (std::size_t c = 0; c < 4; ++c) texels[to][c] = static_cast<std::uint16_t>((sum[c] + count / 2) / count);
  });
}

template <class Body>
void SourceTexture::tap(const Level& level, Vec2f uv, float weight, Body& body) const {
  const auto [width, height] = level.size;
  const float x = uv.x * static_cast<float>(width) - 0.5f, y = uv.y * static_cast<float>(height) - 0.5f;
  const std::int64_t i = floor_of(x), j = floor_of(y);
  const float across = x - static_cast<float>(i), down = y - static_cast<float>(j);
  const auto first = static_cast<std::uint32_t>(level.first);
  if (i >= 0 && j >= 0 && i + 1 < width && j + 1 < height) {
    const std::uint32_t upper = first + (static_cast<std::uint32_t>(j) * width + static_cast<std::uint32_t>(i));
    body(TextureTap{upper, upper + width, across, down, weight});
    return;
  }
  // The second column need not be beside the first: each is read alone.
  const std::uint32_t upper = first + wrapped(j, height, wrap_v_) * width;
  const std::uint32_t lower = first + wrapped(j + 1, height, wrap_v_) * width;
  const std::uint32_t left = wrapped(i, width, wrap_u_), right = wrapped(i + 1, width, wrap_u_);
  body(TextureTap{upper + left, lower + left, 0, down, (1 - across) * weight});
  body(TextureTap{upper + right, lower + right, 0, down, across * weight});
}

template <class Body>
void SourceTexture::for_each_tap(const Footprint& footprint, Body body) const {
  const auto width = static_cast<float>(levels_.front().size.width);
  const auto height = static_cast<float>(levels_.front().size.height);
  const auto square = [&](Vec2f along) {
    const float x = along.x * width, y = along.y * height;
    return x * x + y * y;
  };
  const float x = square(footprint.along_x), y = square(footprint.along_y);
  if (!(std::max(x, y) > tap_square)) {
    tap(levels_.front(), footprint.centre, 1, body);
    return;
  }
  const float wide_extent = std::sqrt(std::max(x, y)), narrow = std::sqrt(std::max(std::min(x, y), tap_square));
  const float samples =
      std::clamp(-static_cast<float>(floor_of(0.25f - wide_extent / narrow)), 1.0f, longest_footprint);
  const float part = 1 / samples, texels = std::max(wide_extent * part * (1 / tap_extent), 1.0f);
  const float log = std::min(rough_log2(texels), static_cast<float>(levels_.size() - 1));
  const Level& level = levels_[static_cast<std::size_t>(log + 0.5f)];
  const Vec2f along = x > y ? footprint.along_x : footprint.along_y;
  for (float k = 0; k < samples; ++k) {
    const float shift = (k + 0.5f) * part - 0.5f;
    tap(level, {footprint.centre.x + shift * along.x, footprint.centre.y + shift * along.y}, part, body);
  }
}

Float4 SourceTexture::weighted(const TextureTap& tap) const {
  const auto texel = [](const Texel& from) {
    using Short4 = std::uint16_t __attribute__((vector_size(8)));
    Short4 values;
    std::memcpy(&values, &from, sizeof values);
    return __builtin_convertvector(__builtin_convertvector(values, Int4), Float4);
  };
  const Texel *const above = &texels_[tap.upper], *const below = &texels_[tap.lower];
  const Float4 across = all4(tap.across), a = texel(above[0]), b = texel(above[1]), c = texel(below[0]),
               d = texel(below[1]);
  const Float4 upper = a + across * (b - a), lower = c + across * (d - c);
  return all4(tap.weight) * (upper + all4(tap.down) * (lower - upper));
}

Float4 SourceTexture::decoded(Float4 sum) const {
  constexpr float scale = 1.0f / 65535;
  return meaning_ == PixelMeaning::colours ? all4(scale) * sum : all4(2 * scale) * sum - all4(1);
}

Float4 SourceTexture::filtered(const Footprint& footprint) const {
  Float4 sum{};
  for_each_tap(footprint, [&](const TextureTap& tap) { sum += weighted(tap); });
  return decoded(sum);
}

void SourceTexture::add_taps(const Footprint& footprint, TapList& taps) const {
  if (taps.room.size() < taps.count + most_taps) taps.room.resize(2 * taps.count + most_taps);
  for_each_tap(footprint, [&, next = &taps.room[taps.count]](const TextureTap& tap) mutable {
    lodestone::prefetch(&texels_[tap.upper]);
    lodestone::prefetch(&texels_[tap.lower]);
    *next++ = tap;
    ++taps.count;
  });
}

void SourceTexture::prefetch(std::span<const TextureTap> taps) const {
  for (const TextureTap& tap : taps) {
    lodestone::prefetch(&texels_[tap.upper]);
    lodestone::prefetch(&texels_[tap.lower]);
  }
}

Float4 SourceTexture::value(std::span<const TextureTap> taps) const {
  Float4 sum{};
  for (const TextureTap& tap : taps) sum += weighted(tap);
  return decoded(sum);
}

}  // namespace lodestone::spherical
