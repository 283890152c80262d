#include "core/texture/source_texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/base/prefetch.h"
#include "core/math/lanes/float8.h"
#include "core/texture/chart_cover.h"
#include "core/texture/colour.h"
#include "core/texture/texel_wrap.h"

namespace lodestone {
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
Float4 rough_log2(Float4 v) {
  return __builtin_convertvector(reinterpret_cast<Int4>(v), Float4) * all4(0x1p-23f) - all4(127);
}

Float4 rounded_up(Float4 v) {
  const Float4 towards_zero = __builtin_convertvector(__builtin_convertvector(v, Int4), Float4);
  return towards_zero + select(towards_zero < v, all4(1), Float4{});
}

}  // namespace

SourceTexture::SourceTexture(const PixelImage& image, PixelMeaning meaning, TextureWrap wrap_u, TextureWrap wrap_v,
                             std::vector<std::uint8_t> covered)
    : wrap_u_(wrap_u), wrap_v_(wrap_v), meaning_(meaning) {
  std::size_t count = 0;
  for (PixelSize size = image.size;; size = half_of(size)) {
    levels_.push_back(
        {size, static_cast<float>(size.width), static_cast<float>(size.height), static_cast<std::uint32_t>(count)});
    count += levels_.back().count();
    if (size == PixelSize{1, 1}) break;
  }
  texels_.resize(count + 1);
  set_finest(image);
  add_levels(std::move(covered));
}

void SourceTexture::set_finest(const PixelImage& image) {
  std::array<float, 256> value;
  std::array<std::uint16_t, 256> opaque;
  for (std::size_t byte = 0; byte < 256; ++byte) {
    value[byte] = meaning_ == PixelMeaning::colours ? linear_of_srgb()[byte] : static_cast<float>(byte) / 255;
    opaque[byte] = wide(value[byte]);
  }
  const std::size_t channels = image.channels, count = levels_.front().count();
  for (std::size_t p = 0; p < count; ++p) {
    const std::uint8_t* const pixel = &image.pixels[p * channels];
    const std::uint8_t alpha = channels == 4 ? pixel[3] : 255;
    const bool scaled = alpha != 255 && meaning_ == PixelMeaning::colours;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint8_t byte = pixel[channels == 1 ? 0 : c];
      texels_[p][c] = scaled ? wide(value[byte] * (static_cast<float>(alpha) / 255)) : opaque[byte];
    }
    texels_[p][3] = wide(static_cast<float>(alpha) / 255);
  }
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
        Texel& texel = to[y * size.width + x];
        const std::size_t corner = 2 * y * full.width + 2 * x;
        if (right == 2 * x + 2 && bottom == 2 * y + 2) {
          const std::uint8_t* const within = &covers.back()[corner];
          const int count = (within[0] + within[1]) + (within[full.width] + within[full.width + 1]);
          if (count == 0 || count == 4) {  // most of them: no division
            const Texel *const above = &from[corner], *const below = above + full.width;
            for (std::size_t c = 0; c < 4; ++c)
              texel[c] = static_cast<std::uint16_t>((above[0][c] + above[1][c] + below[0][c] + below[1][c] + 2) >> 2);
            cover[y * size.width + x] = count > 0;
            continue;
          }
        }
        std::array<std::uint32_t, 4> sum{}, all{};
        std::uint32_t count = 0, texels = 0;
        for (std::size_t j = 2 * y; j < bottom; ++j)
          for (std::size_t i = 2 * x; i < right; ++i, ++texels) {
            const Texel& part = from[j * full.width + i];
            const std::uint32_t within = covers.back()[j * full.width + i];
            for (std::size_t c = 0; c < 4; ++c) all[c] += part[c], sum[c] += within * part[c];
            count += within;
          }
        if (count == 0) sum = all;
        const std::uint32_t parts = count == 0 ? texels : count;
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
  const std::uint32_t first = level.first;
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
  const float ratio = std::min(wide_extent / narrow, 2 * longest_footprint);
  const float samples = std::clamp(-static_cast<float>(floor_of(0.25f - ratio)), 1.0f, longest_footprint);
  const float part = 1 / samples, texels = std::max(wide_extent * part * (1 / tap_extent), 1.0f);
  const float log = std::min(rough_log2(texels), static_cast<float>(levels_.size() - 1));
  const Level& level = levels_[static_cast<std::size_t>(log + 0.5f)];
  const Vec2f along = x > y ? footprint.along_x : footprint.along_y;
  for (float k = 0; k < samples; ++k) {
    const float shift = (k + 0.5f) * part - 0.5f;
    tap(level, {footprint.centre.x + shift * along.x, footprint.centre.y + shift * along.y}, part, body);
  }
}

Float4 SourceTexture::filtered(const Footprint& footprint) const {
  Float4 sum{};
  for_each_tap(footprint, [&](const TextureTap& tap) { sum += weighted(tap); });
  return decoded(sum);
}

// How four footprints are sampled: what for_each_tap() decides, operation by operation.
struct SourceTexture::Sampling4 {
  Float4 count, part;       // samples, and the inverse of their number
  Float4 along_u, along_v;  // the longer side
  Int4 level;
};

SourceTexture::Sampling4 SourceTexture::sampling_of(const Footprint4& f) const {
  const Float4 width = all4(levels_.front().width), height = all4(levels_.front().height);
  const auto square = [&](Float4 u, Float4 v) {
    const Float4 across = u * width, down = v * height;
    return across * across + down * down;
  };
  const Float4 x = square(f.along_x_u, f.along_x_v), y = square(f.along_y_u, f.along_y_v), longer = max(x, y);
  const Int4 is_wide = longer > all4(tap_square);
  if (bits(is_wide) == 0) return {all4(1), all4(1), Float4{}, Float4{}, Int4{}};
  const Float4 extent = sqrt(longer), narrow = sqrt(max(min(x, y), all4(tap_square)));
  const Float4 ratio = min(extent / narrow, all4(2 * longest_footprint));
  const Float4 count = min(max(rounded_up(ratio - all4(0.25f)), all4(1)), all4(longest_footprint));
  const Float4 part = all4(1) / count, texels = max(extent * part * all4(1 / tap_extent), all4(1));
  const Float4 log = min(rough_log2(texels), all4(static_cast<float>(levels_.size() - 1)));
  const Float4 along_u = select(x > y, f.along_x_u, f.along_y_u), along_v = select(x > y, f.along_x_v, f.along_y_v);
  return {select(is_wide, count, all4(1)), select(is_wide, part, all4(1)), select(is_wide, along_u, Float4{}),
          select(is_wide, along_v, Float4{}), is_wide & __builtin_convertvector(log + all4(0.5f), Int4)};
}

// The taps of as many lanes as there are ends; returns false if one of them is at the border of its level.
bool SourceTexture::add_inner_taps(const Footprint4& f, std::span<std::uint32_t> ends, TapList& taps) const {
  const Sampling4 sampling = sampling_of(f);
  const auto level = [&](std::size_t k) -> const Level& {
    return levels_[static_cast<std::size_t>(sampling.level[k])];
  };
  const Float4 width{level(0).width, level(1).width, level(2).width, level(3).width};
  const Float4 height{level(0).height, level(1).height, level(2).height, level(3).height};
  std::array<TextureTap*, 4> next{};
  TextureTap* end = &taps.room[taps.count];
  float most = 0;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    next[k] = end;
    end += static_cast<std::size_t>(sampling.count[k]);
    ends[k] = static_cast<std::uint32_t>(end - taps.room.data());
    most = std::max(most, sampling.count[k]);
  }
  for (float s = 0; s < most; ++s) {
    const Float4 shift = all4(s + 0.5f) * sampling.part - all4(0.5f);
    const Float4 x = (f.centre_u + shift * sampling.along_u) * width - all4(0.5f);
    const Float4 y = (f.centre_v + shift * sampling.along_v) * height - all4(0.5f);
    const Int4 is_inner = (x >= all4(0)) & (x < width - all4(1)) & (y >= all4(0)) & (y < height - all4(1));
    const Int4 i = __builtin_convertvector(x, Int4), j = __builtin_convertvector(y, Int4);
    const Float4 across = x - __builtin_convertvector(i, Float4), down = y - __builtin_convertvector(j, Float4);
    for (std::size_t k = 0; k < ends.size(); ++k) {
      if (s >= sampling.count[k]) continue;
      if (is_inner[k] == 0) return false;
      const std::uint32_t row = level(k).size.width;
      TextureTap& tap = *next[k]++;
      tap.upper = level(k).first + (static_cast<std::uint32_t>(j[k]) * row + static_cast<std::uint32_t>(i[k]));
      tap.lower = tap.upper + row;
      tap.across = across[k], tap.down = down[k], tap.weight = sampling.part[k];
      lodestone::prefetch(&texels_[tap.upper]);
      lodestone::prefetch(&texels_[tap.lower]);
    }
  }
  taps.count = ends.back();
  return true;
}

std::array<std::uint32_t, 4> SourceTexture::add_taps(const Footprint4& footprints, std::size_t count,
                                                     TapList& taps) const {
  if (taps.room.size() < taps.count + 4 * most_taps) taps.room.resize(2 * taps.count + 4 * most_taps);
  std::array<std::uint32_t, 4> ends{};
  if (add_inner_taps(footprints, std::span(ends).first(count), taps)) return ends;
  for (std::size_t k = 0; k < count; ++k) {
    for_each_tap(footprints.lane(k), [&](const TextureTap& tap) { taps.room[taps.count++] = tap; });
    ends[k] = static_cast<std::uint32_t>(taps.count);
  }
  return ends;
}

void SourceTexture::prefetch(std::span<const TextureTap> taps) const {
  for (const TextureTap& tap : taps) {
    lodestone::prefetch(&texels_[tap.upper]);
    lodestone::prefetch(&texels_[tap.lower]);
  }
}

}  // namespace lodestone
