// Images drawn anew for other texture coordinates show the same at every place of the surface.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/texture/redraw.h"

namespace lodestone {
namespace {

constexpr TextureWrap clamp = TextureWrap::clamp, repeat = TextureWrap::repeat;

PixelImage painted(PixelSize size, std::uint32_t channels,
                   const std::function<double(double, double, std::uint32_t)>& of) {
  PixelImage image{.size = size, .channels = channels, .pixels = {}};
  for (std::uint32_t y = 0; y < size.height; ++y)
    for (std::uint32_t x = 0; x < size.width; ++x)
      for (std::uint32_t c = 0; c < channels; ++c)
        image.pixels.push_back(
            static_cast<std::uint8_t>(std::lround(255 * of((x + 0.5) / size.width, (y + 0.5) / size.height, c))));
  return image;
}

double waves(double u, double v, std::uint32_t c) { return 0.5 + 0.4 * std::sin(6 * u + 4 * v + c); }

// A sheet of 2 n x n triangles on these coordinates of its points (i, j) / n.
std::vector<RedrawTriangle> sheet(int n, const std::function<Vec2f(double, double)>& from,
                                  const std::function<Vec2f(double, double)>& to) {
  std::vector<RedrawTriangle> triangles;
  const auto add = [&](std::array<std::array<int, 2>, 3> corners) {
    RedrawTriangle& t = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const double s = 1.0 * corners[k][0] / n, r = 1.0 * corners[k][1] / n;
      t.from[k] = from(s, r), t.to[k] = to(s, r);
      t.positions[k] = {static_cast<float>(s), static_cast<float>(r), static_cast<float>(0.3 * s * r)};
    }
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}});
      add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  return triangles;
}
Vec2f narrow(double u, double v) { return {static_cast<float>(u), static_cast<float>(v)}; }
Vec2f curved(double s, double r) { return narrow(0.1 + 0.8 * s + 0.05 * std::sin(5 * r), 0.1 + 0.7 * r + 0.1 * s * s); }
Vec2f turned(double s, double r) { return narrow(0.9 - 0.6 * r, 0.1 + 0.5 * s + 0.2 * s * r); }

// Weights of (x, y) in a triangle, or nothing outside of it.
std::optional<std::array<double, 3>> weights(const std::array<Vec2f, 3>& p, double x, double y) {
  const auto area = [](double ax, double ay, double bx, double by) { return ax * by - ay * bx; };
  const double all = area(p[1].x - p[0].x, p[1].y - p[0].y, p[2].x - p[0].x, p[2].y - p[0].y);
  std::array<double, 3> w{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2f a = p[(k + 1) % 3], b = p[(k + 2) % 3];
    w[k] = area(a.x - x, a.y - y, b.x - x, b.y - y) / all;
    if (w[k] < 0) return std::nullopt;
  }
  return w;
}

// Pixel by pixel, all triangles in turn: the value where the surface shows it, to a texel at borders. Returns the
// number compared.
int compare(const PixelImage& drawn, std::span<const RedrawTriangle> triangles,
            const std::function<double(double, double, std::uint32_t)>& of) {
  int compared = 0;
  double sum = 0;
  for (std::uint32_t y = 0; y < drawn.size.height; ++y)
    for (std::uint32_t x = 0; x < drawn.size.width; ++x)
      for (const RedrawTriangle& t : triangles) {
        const auto w = weights(t.to, (x + 0.5) / drawn.size.width, (y + 0.5) / drawn.size.height);
        if (!w) continue;
        double u = 0, v = 0;
        for (std::size_t k = 0; k < 3; ++k) u += (*w)[k] * t.from[k].x, v += (*w)[k] * t.from[k].y;
        for (std::uint32_t c = 0; c < drawn.channels; ++c) {
          const double off = drawn.pixels[(y * drawn.size.width + x) * drawn.channels + c] - 255 * of(u, v, c);
          EXPECT_NEAR(off, 0, 8);
          sum += std::abs(off) / drawn.channels;
        }
        ++compared;
      }
  EXPECT_LT(sum, 0.7 * compared) << "half a texel off would be 2.4";
  return compared;
}

TEST(Redraw, ShowsTheSameOnTheSurface) {
  const std::vector<RedrawTriangle> triangles = sheet(6, curved, turned);
  for (const std::uint32_t channels : {3u, 4u})
    for (const PixelMeaning meaning : {PixelMeaning::values, PixelMeaning::colours}) {
      const PlacedImage image{painted({128, 96}, channels, waves), clamp, clamp};
      const auto drawn = redraw(image, meaning, triangles);
      ASSERT_TRUE(drawn);
      EXPECT_EQ(drawn->image.size, (PixelSize{256, 256})) << "as many texels per area as before, at least";
      EXPECT_EQ(drawn->image.channels, channels);
      EXPECT_EQ(drawn->wrap_u, clamp);
      EXPECT_GT(compare(drawn->image, triangles, waves), 15000);
    }
}

TEST(Redraw, ContinuesBesideTheTriangles) {
  const PlacedImage image{painted({32, 32}, 3, [](double, double, std::uint32_t c) { return c == 1 ? 0.8 : 0.2; }),
                          repeat, repeat};
  const auto drawn = redraw(image, PixelMeaning::values,
                            sheet(2, curved, [](double s, double r) { return narrow(0.4 + 0.1 * s, 1.95 + 0.1 * r); }));
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->wrap_u, clamp);
  EXPECT_EQ(drawn->wrap_v, repeat);
  for (std::size_t k = 0; k < drawn->image.pixels.size(); ++k) EXPECT_EQ(drawn->image.pixels[k], k % 3 == 1 ? 204 : 51);
}

TEST(Redraw, RefusesPlacesThatShowDifferentThings) {
  const PlacedImage image{painted({64, 64}, 3, waves), clamp, clamp};
  const auto folded = [](double s, double r) { return narrow(std::abs(s - 0.5), r); };
  const auto parts = [](double s, double r) { return narrow(s, 0.5 * r); };
  EXPECT_FALSE(redraw(image, PixelMeaning::values, sheet(4, parts, folded)));
  EXPECT_TRUE(redraw(image, PixelMeaning::values, sheet(4, folded, folded))) << "the same things";
  const PlacedImage plain{painted({64, 64}, 3, [](double, double, std::uint32_t) { return 0.5; }), clamp, clamp};
  EXPECT_TRUE(redraw(plain, PixelMeaning::values, sheet(4, parts, folded)));
}

TEST(Redraw, RefusesCoordinatesThatAreNone) {
  const PlacedImage image{painted({8, 8}, 3, waves), clamp, clamp};
  EXPECT_FALSE(redraw(image, PixelMeaning::values, {}));
  const auto point = [](double, double) { return Vec2f{}; };
  EXPECT_FALSE(redraw(image, PixelMeaning::values, sheet(2, curved, point)));
  EXPECT_FALSE(redraw(image, PixelMeaning::values, sheet(2, point, curved)));
  for (const float far : {1e9f, std::nanf(""), 50.0f}) {
    const auto beyond = [&](double s, double r) {
      return Vec2f{far * static_cast<float>(s), far * static_cast<float>(r)};
    };
    EXPECT_FALSE(redraw(image, PixelMeaning::values, sheet(2, curved, beyond))) << far;
  }
}

// A normal in tangent space as a vector in space.
Vec3f in_space(const RedrawTriangle& t, const std::array<Vec2f, 3>& uv, Vec3f normal) {
  const Vec3f e1 = t.positions[1] - t.positions[0], e2 = t.positions[2] - t.positions[0];
  const float u1 = uv[1].x - uv[0].x, v1 = uv[1].y - uv[0].y, u2 = uv[2].x - uv[0].x, v2 = uv[2].y - uv[0].y;
  const float det = u1 * v2 - u2 * v1;
  const auto unit = [](Vec3f v) { return (1 / length(v)) * v; };
  const Vec3f n = unit(cross(e1, e2)), along_u = unit((1 / det) * (v2 * e1 - v1 * e2)),
              along_v = (1 / det) * (u1 * e2 - u2 * e1);
  Vec3f up = cross(n, along_u);
  if (dot(up, along_v) > 0) up = -1.0f * up;
  return normal.x * along_u + normal.y * up + normal.z * n;
}

TEST(Redraw, NormalsPointTheSameWay) {
  const Vec3f leaning{0.6f, 0.0f, 0.8f};
  const PlacedImage image{
      painted({64, 64}, 3, [&](double, double, std::uint32_t c) { return c == 0   ? 0.8
                                                                         : c == 1 ? 0.5
                                                                                  : 0.9; }), clamp,
      clamp};
  const auto mirrored = [](double s, double r) { return narrow(0.8 - 0.5 * s, 0.1 + 0.6 * r + 0.1 * s); };
  for (const auto& to :
       {std::function<Vec2f(double, double)>(turned), std::function<Vec2f(double, double)>(mirrored)}) {
    const std::vector<RedrawTriangle> triangles = sheet(3, curved, to);
    const auto drawn = redraw(image, PixelMeaning::normals, triangles);
    ASSERT_TRUE(drawn);
    for (const RedrawTriangle& t : triangles) {
      const auto middle = [&](float Vec2f::*axis) { return (t.to[0].*axis + t.to[1].*axis + t.to[2].*axis) / 3; };
      const auto [width, height] = drawn->image.size;
      const std::size_t pixel = static_cast<std::size_t>(middle(&Vec2f::y) * static_cast<float>(height)) * width +
                                static_cast<std::size_t>(middle(&Vec2f::x) * static_cast<float>(width));
      const auto component = [&](std::size_t c) { return drawn->image.pixels[3 * pixel + c] / 127.5f - 1; };
      const Vec3f found = in_space(t, t.to, {component(0), component(1), component(2)});
      EXPECT_LT(length(found - in_space(t, t.from, leaning)), 0.02f);
    }
  }
}

}  // namespace
}  // namespace lodestone
