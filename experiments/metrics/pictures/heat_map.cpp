#include "experiments/metrics/pictures/heat_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace lodestone {
namespace {

using Colour = std::array<std::uint8_t, 4>;

// Straight between these, at equal distances; each is brighter than the one before, also in grey.
Colour heat_colour(double share) {
  constexpr std::array<std::array<double, 3>, 5> stops{
      {{0, 0, 0}, {96, 16, 128}, {224, 56, 56}, {255, 190, 40}, {255, 255, 255}}};
  const double at = std::clamp(share, 0.0, 1.0) * (stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double t = at - static_cast<double>(i);
  Colour colour{0, 0, 0, 255};
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = static_cast<std::uint8_t>(std::lround(stops[i][c] * (1 - t) + stops[i + 1][c] * t));
  return colour;
}

// Three pixels wide, five high, rows from the top: what numbers and a comparison are written with.
struct Glyph {
  char sign;
  std::array<std::string_view, 5> rows;
};
constexpr std::array<Glyph, 14> glyphs{{{'0', {"###", "# #", "# #", "# #", "###"}},
                                        {'1', {" # ", "## ", " # ", " # ", "###"}},
                                        {'2', {"###", "  #", "###", "#  ", "###"}},
                                        {'3', {"###", "  #", "###", "  #", "###"}},
                                        {'4', {"# #", "# #", "###", "  #", "  #"}},
                                        {'5', {"###", "#  ", "###", "  #", "###"}},
                                        {'6', {"###", "#  ", "###", "# #", "###"}},
                                        {'7', {"###", "  #", "  #", "  #", "  #"}},
                                        {'8', {"###", "# #", "###", "# #", "###"}},
                                        {'9', {"###", "# #", "###", "  #", "###"}},
                                        {'e', {" # ", "# #", "###", "#  ", " ##"}},
                                        {'.', {"   ", "   ", "   ", "   ", " # "}},
                                        {'+', {"   ", " # ", "###", " # ", "   "}},
                                        {'-', {"   ", "   ", "###", "   ", "   "}}}};
constexpr int glyph_scale = 3, glyph_width = 4 * glyph_scale;

class Canvas {
 public:
  explicit Canvas(ImageSize size) : image_{size, {}, {}} {
    image_.rgba.resize(std::size_t{4} * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
    fill(0, 0, size.width, size.height, {0, 0, 0, 255});
  }
  // Clipped to the picture.
  void fill(int left, int top, int width, int height, Colour colour) {
    for (int y = std::max(top, 0); y < std::min(top + height, image_.size.height); ++y)
      for (int x = std::max(left, 0); x < std::min(left + width, image_.size.width); ++x)
        std::ranges::copy(colour, image_.rgba.begin() + 4 * (std::ptrdiff_t{y} * image_.size.width + x));
  }
  void write(std::string_view text, int left, int top) {
    for (const char sign : text) {
      const auto glyph = std::ranges::find(glyphs, sign, &Glyph::sign);
      for (int y = 0; glyph != glyphs.end() && y < 5; ++y)
        for (int x = 0; x < 3; ++x)
          if (glyph->rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] == '#')
            fill(left + x * glyph_scale, top + y * glyph_scale, glyph_scale, glyph_scale, {255, 255, 255, 255});
      left += glyph_width;
    }
  }
  [[nodiscard]] Image take() && { return std::move(image_); }

 private:
  Image image_;
};

void paint(const ErrorMap& map, double top, Canvas& canvas) {
  auto value = map.value.begin();
  for (int y = 0; y < map.size.height; ++y)
    for (int x = 0; x < map.size.width; ++x) canvas.fill(x, y, 1, 1, heat_colour(*value++ / top));
}

int width_of(const std::string& text) { return static_cast<int>(text.size()) * glyph_width; }

}  // namespace

double heat_map_top(const ErrorMap& map) {
  std::vector<float> values = map.value;
  if (values.empty()) return 1;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  const double most = *at > 0 ? *at : *std::max_element(values.begin(), values.end());
  if (most <= 0) return 1;
  for (int power = -9; power < 0; ++power)
    for (const double digit : {1.0, 2.0, 5.0})
      if (const double top = digit * std::pow(10.0, power); top * (1 + 1e-6) >= most) return top;  // floats are rounded
  return 1;
}

Image heat_map(const ErrorMap& map) { return heat_map(map, heat_map_top(map)); }

Image heat_colours(const ErrorMap& map, double top) {
  Canvas canvas(map.size);
  paint(map, top, canvas);
  return std::move(canvas).take();
}

Image heat_map(const ErrorMap& map, double top) {
  const int width = map.size.width, bar = map.size.height + heat_bar_gap, labels = bar + heat_bar_height;
  Canvas canvas({width, labels + heat_label_height});
  paint(map, top, canvas);
  for (int x = 0; x < width; ++x)
    canvas.fill(x, bar, 1, heat_bar_height, heat_colour(static_cast<double>(x) / std::max(width - 1, 1)));
  const std::string most = fmt::format("{:g}+", top), half = fmt::format("{:g}", top / 2);
  const int below = labels + (heat_label_height - 5 * glyph_scale) / 2;
  canvas.write("0", 2, below);
  if (width > width_of(most) + width_of(half) + 4 * glyph_width)
    canvas.write(half, (width - width_of(half)) / 2, below);
  canvas.write(most, width - width_of(most), below);
  return std::move(canvas).take();
}

}  // namespace lodestone
