// The software backend as a whole: against a slow obvious twin, for any number of threads, and at the hard places.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "render/backends/soft/clip.h"
#include "render/backends/soft/kernels.h"
#include "render/backends/soft/soft_renderer.h"
#include "render/camera/camera.h"
#include "render/frame/shading.h"
#include "tests/render/backends/obvious_renderer.h"
#include "tests/render/conformance.h"

namespace lodestone {
namespace {

using test::conformance_scenes;
using test::ConformanceScene;
using test::draw_scene;
using test::DrawnScene;

const ConformanceScene& scene(const std::string& name) {
  static const std::vector<ConformanceScene> scenes = conformance_scenes();
  return *std::ranges::find(scenes, name, &ConformanceScene::name);
}

DrawnScene draw_soft(const ConformanceScene& s) {
  const auto scheduler = make_serial_scheduler();
  return draw_scene(s, *make_soft_renderer(*scheduler));
}

TEST(Soft, DrawsWhatTheObviousRendererDraws) {
  for (const char* name : {"morphing", "tinted", "root_only", "straight_down"})
    for (const int samples : {1, 4}) {
      ConformanceScene small = scene(name);
      small.size = {101, 67};
      small.samples = samples;
      test::ObviousRenderer obvious;
      const Image expected = draw_scene(small, obvious).image, image = draw_soft(small).image;
      // The same samples are covered; depth and colour differ by the rounding of float alone.
      const ImageDifference d = image_difference(image, expected, 1);
      EXPECT_LE(d.differing_share, 0.001) << name << ": of two surfaces at one depth the other may win";
      for (std::size_t i = 0; i < image.depth.size(); ++i) {
        EXPECT_EQ(image.depth[i] == 1, expected.depth[i] == 1) << name;
        EXPECT_NEAR(image.depth[i], expected.depth[i], 1e-6) << name;
      }
    }
}

TEST(Soft, SameBytesFromEveryInstructionSet) {
  const auto scheduler = make_serial_scheduler();
  if (!is_available(InstructionSet::avx2)) GTEST_SKIP() << "no AVX2 here";
  for (const ConformanceScene& s : conformance_scenes()) {
    const Image baseline = draw_scene(s, *make_soft_renderer(*scheduler, {InstructionSet::plain})).image;
    const Image avx2 = draw_scene(s, *make_soft_renderer(*scheduler, {InstructionSet::avx2})).image;
    EXPECT_TRUE(avx2.rgba == baseline.rgba) << s.name;
    EXPECT_TRUE(avx2.depth == baseline.depth) << s.name;
  }
}

TEST(Soft, SameBytesForAnyNumberOfThreads) {
  for (const char* name : {"morphing", "near_plane", "tinted", "near_plane_4x"}) {
    const Image serial = draw_soft(scene(name)).image;
    for (const int threads : {1, 2, 3, 7}) {
      const auto scheduler = make_tbb_scheduler(threads);
      const auto renderer = make_soft_renderer(*scheduler);
      for (int repeat = 0; repeat < 2; ++repeat) {
        const Image image = draw_scene(scene(name), *renderer).image;
        EXPECT_TRUE(image.rgba == serial.rgba) << name << ", " << threads << " threads";
        EXPECT_TRUE(image.depth == serial.depth) << name << ", " << threads << " threads";
      }
    }
  }
}

TEST(Soft, ReportsItsStages) {
  const FrameStats stats = draw_soft(scene("morphing")).stats;
  double sum = 0;
  for (const char* stage : {"geometry", "raster"}) {
    ASSERT_EQ(stats.milliseconds.count(stage), 1u);
    sum += stats.milliseconds.at(stage);
  }
  EXPECT_GE(stats.milliseconds.at("total"), sum);
  EXPECT_GT(stats.triangles, 0u);
}

TEST(Soft, TheStaticPathEqualsTheMorph) {
  // kappa0 so large that all is finest and static; forcing `morphing` must change nothing.
  const ConformanceScene& s = scene("finest");
  const Radii radii = make_radii(*s.hierarchy, s.radii);
  Frame frame;
  frame.only().morph = {s.hierarchy.get(), &radii, s.blend, viewpoint(s.camera, s.hierarchy->transform)};
  frame.only().view_projection = view_projection(s.camera, *s.hierarchy, s.size);
  frame.size = s.size;
  Selection selection;
  select_cells(*s.hierarchy, radii, frame.only().morph.viewpoint, {}, selection);
  ASSERT_TRUE(std::ranges::none_of(selection.cells, &SelectedCell::morphing));
  frame.only().selection = &selection;
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_soft_renderer(*scheduler);
  renderer->upload(*s.hierarchy);
  renderer->draw(frame);
  const Image still = renderer->read_back();
  for (SelectedCell& cell : selection.cells) cell.morphing = true;
  renderer->draw(frame);
  EXPECT_TRUE(renderer->read_back().rgba == still.rgba);
}

// A floor of two triangles that passes under the camera and far behind it.
ConformanceScene floor_scene() {
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  ConformanceScene s{"floor", test::detail::shared(std::move(mesh), 0), {}, {}};
  s.camera = {{0.47, 0.1, 0.004}, {0.5, 0.9, 0.0}};
  return s;
}

TEST(Soft, NearPlaneCutsWhereItShould) {
  const ConformanceScene s = floor_scene();
  const Image image = draw_soft(s).image;
  const ViewProjection vp = view_projection(s.camera, *s.hierarchy, s.size);
  const auto row = [&](std::size_t r, Vec3d p) {
    return vp.m[4 * r] * p.x + vp.m[4 * r + 1] * p.y + vp.m[4 * r + 2] * p.z + vp.m[4 * r + 3];
  };
  int floor = 0, sky = 0;
  for (int y = 0; y < s.size.height; ++y)
    for (int x = 0; x < s.size.width; ++x) {
      const double nx = (x + 0.5) / s.size.width * 2 - 1, ny = 1 - (y + 0.5) / s.size.height * 2;
      // The point of the plane z = 0 that is seen here: rows 0 and 1 of the matrix give two linear equations.
      const double a = vp.m[0] - nx * vp.m[12], b = vp.m[1] - nx * vp.m[13], e = nx * vp.m[15] - vp.m[3];
      const double c = vp.m[4] - ny * vp.m[12], d = vp.m[5] - ny * vp.m[13], f = ny * vp.m[15] - vp.m[7];
      const double det = a * d - b * c;
      const Vec3d p{(e * d - b * f) / det, (a * f - e * c) / det, 0};
      const float depth = image.depth[static_cast<std::size_t>(y * s.size.width + x)];
      const double w = row(3, p), margin = 0.01;
      if (w > 0 && row(2, p) > -w && p.x > margin && p.x < 1 - margin && p.y > margin && p.y < 1 - margin) {
        EXPECT_NEAR(depth, 0.5 + 0.5 * row(2, p) / w, 1e-3) << x << ' ' << y;
        ++floor;
      } else if (w <= 0 || p.x < -margin || p.x > 1 + margin || p.y < -margin || p.y > 1 + margin) {
        EXPECT_EQ(depth, 1) << x << ' ' << y;
        ++sky;
      }
    }
  EXPECT_GT(floor, 10000);
  EXPECT_GT(sky, 10000);
}

TEST(Soft, EveryPixelOfAnEnclosingSurfaceIsDrawn) {
  // From inside a closed surface, with corners behind the camera and far outside the guard band, there is no hole.
  for (const double fov : {0.1, 0.785, 2.2}) {
    ConformanceScene s = scene("inside");
    s.camera.vertical_fov = fov;
    const Image image = draw_soft(s).image;
    EXPECT_TRUE(std::ranges::none_of(image.depth, [](float z) { return z == 1; })) << fov;
    EXPECT_TRUE(std::ranges::all_of(image.depth, [](float z) { return z >= 0 && z < 1; })) << fov;
  }
}

TEST(Soft, NothingInViewIsBackground) {
  const DrawnScene drawn = draw_soft(scene("looking_away"));
  EXPECT_EQ(drawn.stats.cells, 0u);
  for (std::size_t i = 0; i < drawn.image.rgba.size(); ++i)
    ASSERT_EQ(drawn.image.rgba[i], shading::background_bytes[i % 4]);
  EXPECT_TRUE(std::ranges::all_of(drawn.image.depth, [](float z) { return z == 1; }));
}

TEST(Soft, TrianglesWithoutAreaDrawNothing) {
  IndexedMesh mesh;
  mesh.positions = {{0, 0.5f, 0}, {0.5f, 0.5f, 0.5f}, {1, 0.5f, 1}, {0.25f, 0.5f, 0.25f}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 3, 1}}, {{3, 2, 0}}};  // all on one line
  const auto h = test::detail::shared(std::move(mesh), 1);
  const DrawnScene drawn = draw_soft({"line", h, {{0.5, -2, 0.5}, {0.5, 0.5, 0.5}}, {}});
  EXPECT_GT(drawn.stats.triangles, 0u);
  // Snapping may open such a triangle by a subpixel, but what it covers has a depth and a colour.
  EXPECT_LT(std::ranges::count_if(drawn.image.depth, [](float z) { return z != 1; }), 300);
  EXPECT_TRUE(std::ranges::all_of(drawn.image.depth, [](float z) { return z >= 0 && z <= 1; }));
}

// ---- clipping ----

soft::ClipVertex at(float x, float y, float z, float w) { return {x, y, z, w}; }

TEST(Clip, InsideIsUntouched) {
  const soft::Viewport viewport({100, 100});
  const auto polygon = soft::clip({at(0, 0, 0, 1), at(0.5f, 0, 0, 1), at(0, 0.5f, 0.5f, 1)}, viewport);
  ASSERT_EQ(polygon.count, 3);
  EXPECT_EQ(polygon.corners[1].x, 0.5f);
}

TEST(Clip, NeighboursAgreeOnTheCrossing) {
  const soft::Viewport viewport({100, 100});
  const soft::ClipVertex in = at(0.3f, 0.1f, 0.7f, 1.3f), out = at(-0.7f, 3.1f, -2.9f, -1.7f);
  const auto one = soft::clip({in, out, at(0.9f, 0.2f, 0, 1)}, viewport);
  const auto other = soft::clip({out, in, at(-0.9f, 0.2f, 0, 1)}, viewport);
  const auto crossings = [](const soft::ClippedPolygon& p) {
    std::vector<std::array<float, 4>> found;
    for (const soft::ClipVertex& v : p.view())
      if (std::abs(v.z + v.w) < 1e-5f) found.push_back({v.x, v.y, v.z, v.w});
    return found;
  };
  int agreed = 0;
  for (const auto& a : crossings(one))
    for (const auto& b : crossings(other)) agreed += a == b;
  EXPECT_EQ(agreed, 1);
}

TEST(Clip, ResultIsInsideAndOutsideIsNothing) {
  const soft::Viewport viewport({640, 480});
  std::mt19937 random(9);
  std::uniform_real_distribution<float> along(-60, 60), w(-2, 4);
  int kept = 0;
  for (int i = 0; i < 3000; ++i) {
    std::array<soft::ClipVertex, 3> t;
    for (soft::ClipVertex& v : t) v = at(along(random), along(random), along(random) / 20, w(random));
    const soft::ClippedPolygon polygon = soft::clip(t, viewport);
    for (const soft::ClipVertex& v : polygon.view()) {
      ++kept;
      EXPECT_GE(v.w, -1e-4f);
      EXPECT_LE(std::abs(v.z), v.w + 1e-4f);
      EXPECT_LE(std::abs(v.x), viewport.guard_x() * v.w + 1e-3f);
      EXPECT_LE(std::abs(v.y), viewport.guard_y() * v.w + 1e-3f);
    }
  }
  EXPECT_GT(kept, 1000);
  EXPECT_EQ(soft::clip({at(0, 0, -2, 1), at(1, 0, -2, 1), at(0, 1, -3, 1)}, viewport).count, 0);
}

}  // namespace
}  // namespace lodestone
