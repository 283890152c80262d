#include "core/texture/redraw.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/mesh/tangents.h"
#include "core/mesh/uv_map.h"
#include "core/texture/chart_cover.h"
#include "core/texture/normal_space.h"
#include "core/texture/source_texture.h"
#include "core/texture/texel_wrap.h"

namespace lodestone {
namespace {

constexpr std::uint32_t least_side = 16, longest_side = 4096;
constexpr float tolerance = 16.0f / 255;  // of a channel
constexpr std::size_t tolerated = 100;    // one in so many texels
constexpr float farthest = 64;            // repetitions from the origin
constexpr std::size_t most_layers = 4;    // mean number of triangles on a texel: more repeat themselves

// From (x, y) of normals in the frame of `from` to those in the frame of `to`.
struct Turn {
  float xx = 1, xy = 0, yx = 0, yy = 1;
};

std::vector<Turn> turns_of(std::span<const RedrawTriangle> triangles) {
  std::vector<Triangle> soup;
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> from, to;
  for (const RedrawTriangle& t : triangles) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    soup.push_back({{first, first + 1, first + 2}});
    const Vec3f n = cross(t.positions[1] - t.positions[0], t.positions[2] - t.positions[0]);
    const float size = length(n);
    for (std::size_t k = 0; k < 3; ++k) {
      positions.push_back(t.positions[k]);
      normals.push_back(size > 0 ? (1 / size) * n : Vec3f{0, 0, 1});
      from.push_back(t.from[k]), to.push_back(t.to[k]);
    }
  }
  const std::vector<Tangent> a = tangents_of(soup, positions, from, normals),
                             b = tangents_of(soup, positions, to, normals);
  std::vector<Turn> turns;
  for (std::size_t k = 0; k < a.size(); k += 3) {
    const Vec3f from_y = a[k].side * cross(normals[k], a[k].along_u),
                to_y = b[k].side * cross(normals[k], b[k].along_u);
    turns.push_back(
        {dot(a[k].along_u, b[k].along_u), dot(from_y, b[k].along_u), dot(a[k].along_u, to_y), dot(from_y, to_y)});
  }
  return turns;
}

class Redrawing {
 public:
  Redrawing(const PlacedImage& from, PixelMeaning meaning, std::span<const RedrawTriangle> triangles)
      : from_(from), meaning_(meaning), triangles_(triangles) {}

  std::optional<PlacedImage> draw() {
    if (!set_size()) return std::nullopt;
    set_wrap();
    load();
    if (meaning_ == PixelMeaning::normals && !is_object_space(from_.image)) turns_ = turns_of(triangles_);
    for (std::size_t t = 0; t < triangles_.size(); ++t) draw_triangle(t);
    if (differing_ * tolerated > painted_count_) return std::nullopt;
    for (std::size_t t = 0; t < triangles_.size(); ++t) draw_barycentre(t);
    fill_rest();
    out_.image = to_pixels(pixels_, meaning_);
    return std::move(out_);
  }

 private:
  bool set_size() {
    double texels = 0, area = 0;
    for (const RedrawTriangle& t : triangles_) {
      texels += doubled_area(t.from), area += doubled_area(t.to);
      for (const Vec2f uv : t.to)
        if (!(std::abs(uv.x) <= farthest && std::abs(uv.y) <= farthest)) return false;
    }
    texels *= double{1} * from_.image.size.width * from_.image.size.height;
    if (!(texels > 0 && area > 0 && area <= 2.0 * most_layers)) return false;
    const double side = std::clamp(std::sqrt(texels / area), double{least_side}, double{longest_side});
    const std::uint32_t n = std::bit_ceil(static_cast<std::uint32_t>(side));
    pixels_.size = {n, n};
    return true;
  }

  // A sampler that continues beyond the sides only where triangles go there.
  void set_wrap() {
    const auto wrap = [&](float Vec2f::*axis) {
      for (const RedrawTriangle& t : triangles_)
        for (const Vec2f& uv : t.to)
          if (!(uv.*axis >= 0 && uv.*axis <= 1)) return TextureWrap::repeat;
      return TextureWrap::clamp;
    };
    out_.wrap_u = wrap(&Vec2f::x), out_.wrap_v = wrap(&Vec2f::y);
  }

  void load() {
    std::vector<ChartTriangle> charts;
    charts.reserve(triangles_.size());
    for (const RedrawTriangle& t : triangles_) charts.push_back({t.from, 0});
    source_ = SourceTexture(from_.image, meaning_, from_.wrap_u, from_.wrap_v,
                            chart_cover(charts, from_.image.size, from_.wrap_u, from_.wrap_v));
    pixels_.channels = from_.image.channels == 4 ? 4 : 3;
    const std::size_t count = std::size_t{pixels_.size.width} * pixels_.size.height;
    pixels_.values.assign(count * pixels_.channels, 0);
    painted_.assign(count, 0);
  }

  [[nodiscard]] std::size_t index_of(std::int64_t x, std::int64_t y) const {
    return std::size_t{wrapped(y, pixels_.size.height, out_.wrap_v)} * pixels_.size.width +
           wrapped(x, pixels_.size.width, out_.wrap_u);
  }

  // From texels, centres at whole numbers, to coordinates in the image.
  [[nodiscard]] std::optional<UvMap> lookup_of(const RedrawTriangle& t) const {
    PlaneTriangle texels, uv;
    const std::array<TexelPoint, 3> p = texel_points(t.to, pixels_.size);
    for (std::size_t k = 0; k < 3; ++k) texels[k] = {p[k].x, p[k].y}, uv[k] = {t.from[k].x, t.from[k].y};
    return map_between(texels, uv);
  }

  [[nodiscard]] Float4 value_at(std::size_t triangle, const UvMap& lookup, double x, double y) const {
    const auto narrow = [](double u, double v) { return Vec2f{static_cast<float>(u), static_cast<float>(v)}; };
    const auto& [u_x, u_y, v_x, v_y, u, v] = lookup;
    Float4 value =
        source_.filtered({narrow(u_x * x + u_y * y + u, v_x * x + v_y * y + v), narrow(u_x, v_x), narrow(u_y, v_y)});
    if (turns_.empty()) return value;
    const Turn& t = turns_[triangle];
    const float from_x = value[0], from_y = value[1];
    value[0] = t.xx * from_x + t.xy * from_y, value[1] = t.yx * from_x + t.yy * from_y;
    return value;
  }

  void paint(std::size_t pixel, Float4 value) {
    painted_[pixel] = 1;
    for (std::size_t c = 0; c < pixels_.channels; ++c) pixels_.values[pixel * pixels_.channels + c] = value[c];
  }

  void draw_triangle(std::size_t number) {
    const RedrawTriangle& t = triangles_[number];
    const std::optional<UvMap> lookup = lookup_of(t);
    if (!lookup) return;
    for_each_row(texel_points(t.to, pixels_.size), [&](std::int64_t first, std::int64_t last, std::int64_t y) {
      for (std::int64_t x = first; x <= last; ++x) {
        const std::size_t pixel = index_of(x, y);
        const Float4 value = value_at(number, *lookup, static_cast<double>(x), static_cast<double>(y));
        if (painted_[pixel] == 0) {
          ++painted_count_;
          paint(pixel, value);
        } else if (!is_near(pixel, value)) {
          ++differing_;
        }
      }
    });
  }

  [[nodiscard]] bool is_near(std::size_t pixel, Float4 value) const {
    // Light is darker than its bytes; normals have twice the range.
    const auto encoded = [&](float v) {
      return meaning_ == PixelMeaning::colours   ? std::sqrt(std::max(v, 0.0f))
             : meaning_ == PixelMeaning::normals ? 0.5f * v
                                                 : v;
    };
    for (std::size_t c = 0; c < pixels_.channels; ++c)
      if (std::abs(encoded(pixels_.values[pixel * pixels_.channels + c]) - encoded(value[c])) > tolerance) return false;
    return true;
  }

  // Triangles between the centres of texels must not get the colour of the nearest larger chart.
  void draw_barycentre(std::size_t number) {
    const std::optional<UvMap> lookup = lookup_of(triangles_[number]);
    if (!lookup) return;
    TexelPoint sum;
    for (const TexelPoint p : texel_points(triangles_[number].to, pixels_.size))
      sum = {sum.x + p.x / 3, sum.y + p.y / 3};
    const std::size_t pixel = index_of(std::llround(sum.x), std::llround(sum.y));
    if (painted_[pixel] == 0) paint(pixel, value_at(number, *lookup, sum.x, sum.y));
  }

  void fill_rest() {
    const std::size_t channels = pixels_.channels;
    const auto index = [&](std::int64_t x, std::int64_t y) { return index_of(x, y); };
    extend_cover(painted_, pixels_.size, std::numeric_limits<std::size_t>::max(), index,
                 [&](std::span<const std::size_t> beside, std::size_t to) {
                   for (std::size_t c = 0; c < channels; ++c) {
                     float sum = 0;
                     for (const std::size_t pixel : beside) sum += pixels_.values[pixel * channels + c];
                     pixels_.values[to * channels + c] = sum / static_cast<float>(beside.size());
                   }
                 });
  }

  const PlacedImage& from_;
  const PixelMeaning meaning_;
  const std::span<const RedrawTriangle> triangles_;
  SourceTexture source_;
  std::vector<Turn> turns_;  // by triangle; empty: normals are not turned
  LinearImage pixels_;
  std::vector<std::uint8_t> painted_;
  std::size_t painted_count_ = 0, differing_ = 0;
  PlacedImage out_;
};

}  // namespace

std::optional<PlacedImage> redraw(const PlacedImage& from, PixelMeaning meaning,
                                  std::span<const RedrawTriangle> triangles) {
  return Redrawing(from, meaning, triangles).draw();
}

}  // namespace lodestone
