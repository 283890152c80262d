#include "core/spherical/resample/source_texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/formats/common/colour.h"
#include "core/spherical/resample/chart_cover.h"
#include "core/texture/texel_wrap.h"

namespace lodestone::spherical {
namespace {

constexpr std::size_t rings = 3;        // texels that filters may find outside of a chart
constexpr float longest_footprint = 8;  // samples along a footprint

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
  Level& level = levels_.emplace_back(Level{image.size, {}});
  level.texels.resize(covered.size());
  const std::size_t channels = image.channels;
  for (std::size_t p = 0; p < covered.size(); ++p) {
    const std::uint8_t* const pixel = &image.pixels[p * channels];
    const bool scaled = channels == 4 && meaning == PixelMeaning::colours;
    const float alpha = channels == 4 ? static_cast<float>(pixel[3]) / 255 : 1;
    for (std::size_t c = 0; c < 3; ++c)
      level.texels[p][c] = wide(value[pixel[channels == 1 ? 0 : c]] * (scaled ? alpha : 1));
    level.texels[p][3] = wide(alpha);
  }
  add_levels(std::move(covered));
}

// A texel is the mean of the covered ones among the four, at odd ends six or nine, that it is made of.
void SourceTexture::add_levels(std::vector<std::uint8_t> covered) {
  std::vector<std::vector<std::uint8_t>> covers;
  covers.push_back(std::move(covered));
  while (levels_.back().size != PixelSize{1, 1}) {
    const PixelSize full = levels_.back().size, size = half_of(full);
    Level half{size, std::vector<Texel>(std::size_t{size.width} * size.height)};
    std::vector<std::uint8_t> cover(half.texels.size());
    for (std::size_t y = 0; y < size.height; ++y)
      for (std::size_t x = 0; x < size.width; ++x) {
        // The last texel of an odd row takes three.
        const std::size_t right = x + 1 == size.width ? full.width : 2 * x + 2;
        const std::size_t bottom = y + 1 == size.height ? full.height : 2 * y + 2;
        std::array<std::uint32_t, 4> sum{}, all{};
        std::uint32_t count = 0, texels = 0;
        for (std::size_t j = 2 * y; j < bottom; ++j)
          for (std::size_t i = 2 * x; i < right; ++i, ++texels) {
            const Texel& texel = levels_.back().texels[j * full.width + i];
            const std::uint32_t within = covers.back()[j * full.width + i];
            for (std::size_t c = 0; c < 4; ++c) all[c] += texel[c], sum[c] += within * texel[c];
            count += within;
          }
        if (count == 0) sum = all;
        const std::uint32_t parts = count == 0 ? texels : count;
        Texel& texel = half.texels[y * size.width + x];
        for (std::size_t c = 0; c < 4; ++c) texel[c] = static_cast<std::uint16_t>((sum[c] + parts / 2) / parts);
        cover[y * size.width + x] = count > 0;
      }
    levels_.push_back(std::move(half));
    covers.push_back(std::move(cover));
  }
  for (std::size_t l = 0; l < levels_.size(); ++l) extend(levels_[l], covers[l]);
}

void SourceTexture::extend(Level& level, std::vector<std::uint8_t>& covered) const {
  const PixelSize size = level.size;
  const auto index = [&](std::int64_t x, std::int64_t y) {
    if (x >= 0 && y >= 0 && x < size.width && y < size.height) return static_cast<std::size_t>(y * size.width + x);
    return std::size_t{wrapped(y, size.height, wrap_v_)} * size.width + wrapped(x, size.width, wrap_u_);
  };
  extend_cover(covered, size, rings, index, [&](std::span<const std::size_t> from, std::size_t to) {
    std::array<std::uint32_t, 4> sum{};
    for (const std::size_t texel : from)
      for (std::size_t c = 0; c < 4; ++c) sum[c] += level.texels[texel][c];
    const auto count = static_cast<std::uint32_t>(from.size());
    for (std::size_t c = 0; c < 4; ++c) level.texels[to][c] = static_cast<std::uint16_t>((sum[c] + count / 2) / count);
  });
}

Float4 SourceTexture::interpolated(const Level& level, Vec2f uv) const {
  using Short4 = std::uint16_t __attribute__((vector_size(8)));
  const auto [width, height] = level.size;
  const float x = uv.x * static_cast<float>(width) - 0.5f, y = uv.y * static_cast<float>(height) - 0.5f;
  const std::int64_t i = floor_of(x), j = floor_of(y);
  auto left = static_cast<std::size_t>(i), right = left + 1, top = static_cast<std::size_t>(j), bottom = top + 1;
  if (i < 0 || j < 0 || i + 1 >= width || j + 1 >= height) {
    left = wrapped(i, width, wrap_u_), right = wrapped(i + 1, width, wrap_u_);
    top = wrapped(j, height, wrap_v_), bottom = wrapped(j + 1, height, wrap_v_);
  }
  const Texel *const upper_row = &level.texels[top * width], *const lower_row = &level.texels[bottom * width];
  const auto texel = [](const Texel& from) {
    Short4 values;
    std::memcpy(&values, &from, sizeof values);
    return __builtin_convertvector(__builtin_convertvector(values, Int4), Float4);
  };
  const Float4 across = all4(x - static_cast<float>(i)), down = all4(y - static_cast<float>(j));
  const Float4 a = texel(upper_row[left]), b = texel(upper_row[right]);
  const Float4 c = texel(lower_row[left]), d = texel(lower_row[right]);
  const Float4 upper = a + across * (b - a), lower = c + across * (d - c);
  return upper + down * (lower - upper);
}

Float4 SourceTexture::filtered(const Footprint& footprint) const {
  const auto width = static_cast<float>(levels_.front().size.width);
  const auto height = static_cast<float>(levels_.front().size.height);
  const auto extent = [&](Vec2f along) {
    const float x = along.x * width, y = along.y * height;
    return std::sqrt(x * x + y * y);
  };
  const float x = extent(footprint.along_x), y = extent(footprint.along_y);
  const float wide_extent = std::max(x, y), narrow = std::max(std::min(x, y), 1.0f);
  Float4 sum{};
  if (!(wide_extent > 1)) {
    sum = interpolated(levels_.front(), footprint.centre);
  } else {
    const float samples =
        std::clamp(-static_cast<float>(floor_of(0.25f - wide_extent / narrow)), 1.0f, longest_footprint);
    const float log =
        std::min(rough_log2(std::max(wide_extent / samples, 1.0f)), static_cast<float>(levels_.size() - 1));
    const auto level = static_cast<std::size_t>(log);
    const float between = log - static_cast<float>(level);
    const Vec2f along = x > y ? footprint.along_x : footprint.along_y;
    for (float k = 0; k < samples; ++k) {
      const float shift = (k + 0.5f) / samples - 0.5f;
      const Vec2f uv{footprint.centre.x + shift * along.x, footprint.centre.y + shift * along.y};
      Float4 value = interpolated(levels_[level], uv);
      if (between > 0) value += all4(between) * (interpolated(levels_[level + 1], uv) - value);
      sum += value;
    }
    sum *= all4(1 / samples);
  }
  constexpr float scale = 1.0f / 65535;
  return meaning_ == PixelMeaning::colours ? all4(scale) * sum : all4(2 * scale) * sum - all4(1);
}

}  // namespace lodestone::spherical
