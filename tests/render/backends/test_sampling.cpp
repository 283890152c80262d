// Attributes shown by surfaces, compared with the attributes as functions of the position.
#include <gtest/gtest.h>

#include "core/texture/downsample.h"
#include "render/backends/make_renderer.h"
#include "render/frame/appearance.h"
#include "tests/render/conformance.h"
#include "tests/render/planar_model.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

TexturedScene over_plane(std::shared_ptr<const Hierarchy> model, Vec3d eye, Vec3d target) {
  TexturedScene scene{"plane", {{model, {}, appearance_of(*model)}}};
  scene.eye = eye, scene.target = target;
  scene.kappa0 = 2;
  scene.settings.lighting.ambient = 1;
  return scene;
}

Vec3d normalized(Vec3d v) { return (1 / length(v)) * v; }

struct Differences {
  std::size_t pixels = 0, differing = 0;
  double mean = 0, worst = 0;
};

// expected(x, y, p) for all pixels that show the plane at p.
template <class Expected>
Differences compare(const Image& image, const PlaneView& view, double tolerance, const Expected& expected) {
  Differences d;
  for (int y = 0; y < image.size.height; ++y)
    for (int x = 0; x < image.size.width; ++x) {
      Vec3d p;
      const auto at = static_cast<std::size_t>(y * image.size.width + x);
      if (!view.meet(x + 0.5, y + 0.5, p) || image.depth[at] == 1) continue;  // coarse levels are smaller
      const Vec3d wanted = expected(x + 0.5, y + 0.5, p);
      const std::uint8_t* rgba = &image.rgba[4 * at];
      const double off =
          std::max({std::abs(rgba[0] - wanted.x), std::abs(rgba[1] - wanted.y), std::abs(rgba[2] - wanted.z)});
      ++d.pixels;
      d.differing += off > tolerance;
      d.mean += off;
      d.worst = std::max(d.worst, off);
    }
  d.mean /= static_cast<double>(d.pixels);
  return d;
}

// Texels that a pixel covers, from the lines of sight through its borders.
double footprint(const PlaneView& view, const Plan& plan, PixelSize size, double x, double y) {
  const auto extent = [&](double dx, double dy) {
    Vec3d from, to;
    (void)view.meet(x - dx, y - dy, from), (void)view.meet(x + dx, y + dy, to);
    const Vec2f a = plan.at({static_cast<float>(from.x), static_cast<float>(from.y)}),
                b = plan.at({static_cast<float>(to.x), static_cast<float>(to.y)});
    return std::hypot(static_cast<double>(b.x - a.x) * size.width, static_cast<double>(b.y - a.y) * size.height);
  };
  return std::max(extent(0.5, 0), extent(0, 0.5));
}

struct Sampled {
  const char* name;
  TextureWrap wrap_u, wrap_v;
  PixelSize size;
  Vec3d eye, target;
  Plan plan;
};
using enum TextureWrap;
void PrintTo(const Sampled& s, std::ostream* out) { *out << s.name; }

const Sampled sampled[]{
    {"repeated", repeat, repeat, {32, 32}, {0.5, -0.4, 0.7}, {0.5, 0.5, 0}, {{3, 0.2f}, {-0.5f, 4}}},
    {"mirrored", mirror, mirror, {32, 16}, {0.5, -0.4, 0.7}, {0.5, 0.5, 0}, {{3, 0.2f}, {-0.5f, 4}}},
    {"clamped", clamp, clamp, {20, 32}, {0.5, -0.4, 0.7}, {0.5, 0.5, 0}, {{2.5f, -1}, {-1, 2}}},
    {"clamped_repeated", clamp, repeat, {17, 31}, {0.5, -0.4, 0.7}, {0.5, 0.5, 0}, {{2, -0.5f}, {-1, 2}}},
    {"minified", repeat, mirror, {512, 256}, {0.6, -0.5, 0.6}, {0.5, 0.5, 0}, {{4, 1}, {-1, 3}}},
    {"grazing", repeat, repeat, {128, 128}, {0.5, -0.3, 0.06}, {0.5, 0.5, 0}, {{2, 0}, {0, 2}}},
    {"magnified", mirror, repeat, {8, 8}, {0.4, 0.3, 0.05}, {0.45, 0.45, 0}, {{7, 0.5f}, {0, 9}}},
};

class Sampling : public ::testing::TestWithParam<std::tuple<Sampled, const char*>> {
 protected:
  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
};

TEST_P(Sampling, ShowsTheTextureAtEachPoint) {
  const auto& [s, backend] = GetParam();
  std::string why;
  const auto renderer = renderer_if_possible(backend, *scheduler_, why);
  if (!renderer) GTEST_SKIP() << why;
  const PixelImage pixels = painted(s.size, motley);
  const auto model = planar_model(0, s.plan, {as_texture("motley", pixels, s.wrap_u, s.wrap_v)},
                                  {{"motley", {1, 1, 1, 1}, 0, no_texture}});
  TexturedScene scene = over_plane(model, s.eye, s.target);
  scene.models[0].appearance.vertex_colours = false;
  TexturedFrame frame(scene);
  ASSERT_TRUE(frame.frame.only().effects.contains(Effect::texture));
  const Image image = frame.draw(*renderer);
  const ObviousTexture twin{make_mip_chain(pixels, PixelMeaning::colours, s.wrap_u, s.wrap_v), s.wrap_u, s.wrap_v};
  const PlaneView view(frame.frame);
  const Plan& plan = s.plan;
  const Differences d = compare(image, view, 6, [&](double x, double y, Vec3d p) {
    const double u = double{plan.u.x} * p.x + double{plan.u.y} * p.y,
                 v = double{plan.v.x} * p.x + double{plan.v.y} * p.y;
    return twin.sample(u, v, footprint(view, plan, pixels.size, x, y));
  });
  EXPECT_GT(d.pixels, 5000u);
  // The logarithm of both backends is up to 0.043 off; hardware has eight bits for places between texels, and llvmpipe
  // loses some more of them near the eye.
  const bool soft = std::string(backend) == "soft";
  EXPECT_LE(static_cast<double>(d.differing), soft ? 0 : 0.02 * static_cast<double>(d.pixels)) << d.worst;
  EXPECT_LT(d.worst, soft ? 6 : 16);
  EXPECT_LT(d.mean, soft ? 1 : 1.5);
}

INSTANTIATE_TEST_SUITE_P(All, Sampling,
                         ::testing::Combine(::testing::ValuesIn(sampled), ::testing::Values("soft", "gl")),
                         [](const auto& instance) {
                           return std::string(std::get<0>(instance.param).name) + "_" + std::get<1>(instance.param);
                         });

// Colours are positions: of any point, whatever its corners' lambda.
TEST(VertexColours, AreInterpolatedAndMorphedWithThePosition) {
  const auto model = planar_model(0, {}, {}, {});
  const auto scheduler = make_serial_scheduler();
  for (const float kappa0 : {0.01f, 1.0f, 2.0f, 1000.0f}) {
    TexturedScene scene = over_plane(model, {0.5, -0.4, 0.7}, {0.5, 0.5, 0});
    scene.kappa0 = kappa0;
    TexturedFrame frame(scene);
    const Image image = frame.draw(*make_renderer("soft", *scheduler));
    const Differences d = compare(image, PlaneView(frame.frame), 1.01, [](double, double, Vec3d p) { return 255 * p; });
    EXPECT_GT(d.pixels, 5000u);
    EXPECT_EQ(d.differing, 0u) << kappa0 << ": " << d.worst;
  }
}

// If lambda is 1 or 0 at all corners and colours are flat, the stored bytes are shown unchanged.
TEST(VertexColours, ComeOutAsTheyAreStored) {
  auto model = std::make_shared<Hierarchy>(*planar_model(0.1, {}, {}, {}));
  const std::vector<Rgba8> one(100'000, Rgba8{203, 17, 94, 255});
  for (Cell& cell : model->cells) cell.attributes.colours = std::span(one).first(cell.positions.size());
  const auto scheduler = make_serial_scheduler();
  for (const float kappa0 : {0.01f, 2.0f}) {
    TexturedScene scene = over_plane(model, {0.5, -0.4, 0.7}, {0.5, 0.5, 0});
    scene.kappa0 = kappa0;
    TexturedFrame frame(scene);
    const Image image = frame.draw(*make_renderer("soft", *scheduler));
    std::size_t seen = 0;
    for (std::size_t i = 0; i < image.depth.size(); ++i) {
      if (image.depth[i] == 1) continue;
      ++seen;
      ASSERT_EQ(image.rgba[4 * i], 203);
      ASSERT_EQ(image.rgba[4 * i + 1], 17);
      ASSERT_EQ(image.rgba[4 * i + 2], 94);
    }
    EXPECT_GT(seen, 5000u);
  }
}

// x along u as far as the plane's normal lets, y against v, whichever way the chart is turned.
TEST(NormalMap, TangentSpaceFollowsTheChart) {
  const auto scheduler = make_serial_scheduler();
  const PixelImage pixels = painted({64, 64}, bumps);
  for (const Plan plan : {Plan{{2, 0}, {0, 2}}, Plan{{2, 0.6f}, {0, 3}}, Plan{{-2, 0}, {0, 2}}, Plan{{0, 2}, {2, 0}}})
    for (const bool smooth : {true, false})
      for (const char* backend : {"soft", "gl"}) {
        std::string why;
        const auto renderer = renderer_if_possible(backend, *scheduler, why);
        if (!renderer) continue;
        const auto model =
            planar_model(0, plan, {as_texture("bumps", pixels)}, {{"bumpy", {1, 1, 1, 1}, no_texture, 0}});
        TexturedScene scene = over_plane(model, {0.5, -0.4, 0.7}, {0.5, 0.5, 0});
        scene.settings.lighting.ambient = 0.1f;
        Appearance& appearance = scene.models[0].appearance;
        appearance.vertex_colours = false, appearance.smooth = smooth, appearance.base_colour = {1, 1, 1};
        TexturedFrame frame(scene);
        frame.frame.only().towards_eye = {0.48f, 0.6f, 0.64f};
        const Image image = frame.draw(*renderer);
        const ObviousTexture twin{make_mip_chain(pixels, PixelMeaning::normals, repeat, repeat)};
        const PlaneView view(frame.frame);
        // The columns of the inverse of plan: where positions go as u and v grow.
        const double det = double{plan.u.x} * plan.v.y - double{plan.u.y} * plan.v.x;
        const Vec3d t = normalized(Vec3d{plan.v.y / det, -plan.v.x / det, 0}), n{0, 0, 1};
        Vec3d b = cross(n, t);
        if (b.x * -plan.u.y / det + b.y * plan.u.x / det > 0) b = -1.0 * b;
        const Differences d = compare(image, view, 6, [&](double x, double y, Vec3d p) {
          const double u = double{plan.u.x} * p.x + double{plan.u.y} * p.y,
                       v = double{plan.v.x} * p.x + double{plan.v.y} * p.y;
          const Vec3d m = (1 / 127.5) * twin.sample(u, v, footprint(view, plan, pixels.size, x, y)) - Vec3d{1, 1, 1};
          const Vec3d normal = normalized(m.x * t + m.y * b + m.z * n);
          const double light = std::abs(dot(normal, to_double(frame.frame.only().towards_eye)));
          const double grey = 255 * (0.1 + 0.9 * light);
          return Vec3d{grey, grey, grey};
        });
        EXPECT_GT(d.pixels, 5000u);
        EXPECT_EQ(d.differing, 0u) << backend << " of " << d.pixels << ", the worst by " << d.worst;
        EXPECT_LT(d.mean, 1.5) << backend;
      }
}

}  // namespace
}  // namespace lodestone
