// The LOD systems that are compared: what each draws, and that the metrics tell them apart.
#include <gtest/gtest.h>

#include <map>

#include "core/base/error.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/studies/frame_measures.h"
#include "experiments/systems/lod_system.h"
#include "experiments/systems/system_flight.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "tests/expect_error.h"
#include "tests/experiments/lod_frames.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using namespace testing;

const Hierarchy& torus() {
  static const test::NaiveHierarchy made = test::naive_hierarchy(test::torus_mesh(120, 60), 4);
  return made.hierarchy;
}

Scene scene_of_torus(float kappa0 = 1.5f) {
  Scene scene = scene_of("torus.lode");
  scene.radii.kappa0 = kappa0;
  return scene;
}

constexpr ImageSize size{160, 120};

std::vector<Camera> approach(int frames) {
  std::vector<Camera> path;
  for (int i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / frames;
    path.push_back({{0.5 + 0.3 * t, -3 + 2.4 * t, 1.4 - 0.6 * t}, {0.5, 0.5, 0.15}});
  }
  return path;
}

TEST(LodSystem, Names) {
  for (const std::string& system : lod_system_names()) EXPECT_FALSE(lod_system(system).description.empty());
  expect_error_of<InputError>([] { (void)lod_system("lod"); },
                              {"unknown LOD system 'lod'; known are morph, adaptive, step"});
}

TEST(LodSystem, WithoutMorphEveryVertexStaysAtItsLevel) {
  const Radii radii = per_level_radii(torus(), DistanceMetric::euclidean, 1.5f), still = without_morph(radii);
  for (const Vec3f view : random_viewpoints(torus(), 20, 1)) {
    const testing::Frame morphed = make_frame(torus(), radii, Blend::linear, view);
    const testing::Frame bare = make_frame(torus(), still, Blend::linear, view);
    ASSERT_EQ(morphed.selection.cells.size(), bare.selection.cells.size());
    for (std::size_t i = 0; i < bare.selection.cells.size(); ++i) {
      EXPECT_EQ(morphed.selection.cells[i].cell, bare.selection.cells[i].cell);
      EXPECT_FALSE(bare.selection.cells[i].morphing);
      const Cell& cell = torus().cells[bare.selection.cells[i].cell];
      std::vector<Vec3f> drawn(cell.positions.size());
      morph_cell(bare.context, bare.selection.cells[i].cell, drawn);
      EXPECT_TRUE(std::equal(drawn.begin(), drawn.end(), cell.positions.begin()));
    }
  }
}

TEST(LodSystem, AWholeLevelIsAllOfItsCells) {
  const Radii radii = per_level_radii(torus(), DistanceMetric::euclidean);
  for (int level = 0; level <= torus().finest(); ++level) {
    const testing::Frame frame = make_frame(torus(), whole_level(radii, level), Blend::linear, {0.5f, 0.5f, 0.1f});
    EXPECT_EQ(frame.selection.cells.size(), torus().cells_of(level).size());
    for (const SelectedCell& cell : frame.selection.cells) EXPECT_EQ(cell.level, level);
  }
}

// Continuous in the distance, from the finest level to the root, and never a level that is not good enough.
TEST(LodSystem, ACrossFadeIsContinuous) {
  for (const float kappa0 : {0.3f, 1.5f}) {
    const Radii radii = per_level_radii(torus(), DistanceMetric::euclidean, kappa0);
    for (const double width : {0.05, 0.25, 5.0}) {
      std::map<int, double> before;
      const auto shares = [](const CrossFade& fade) {
        std::map<int, double> s;
        s[fade.fine] += 1 - fade.share;
        s[fade.coarse] += fade.share;
        return s;
      };
      std::set<int> levels;
      double largest = 0;
      for (int i = 0; i <= 200'000; ++i) {
        const float distance = 1e-3f * std::pow(3e4f, static_cast<float>(i) / 200'000);
        const CrossFade fade = cross_fade(torus(), radii, {-distance, 0.5f, 0.1f}, width);
        EXPECT_TRUE(fade.coarse == fade.fine || fade.coarse + 1 == fade.fine);
        EXPECT_TRUE(fade.share >= 0 && fade.share < 1);
        if (fade.coarse < torus().finest()) {
          EXPECT_GE(distance, radii.select[static_cast<std::size_t>(fade.coarse)]);
        }
        const std::map<int, double> now = shares(fade);
        levels.insert(fade.coarse);
        for (int l = 0; i > 0 && l <= torus().finest(); ++l) {
          const auto at = [l](const std::map<int, double>& s) { return s.contains(l) ? s.at(l) : 0.0; };
          largest = std::max(largest, std::abs(at(now) - at(before)));
        }
        before = now;
      }
      EXPECT_LT(largest, 0.05) << width;
      EXPECT_EQ(levels.size(), static_cast<std::size_t>(torus().finest()) + 1);
    }
  }
  EXPECT_EQ(cross_fade(torus(), per_level_radii(torus(), DistanceMetric::euclidean), {0.5f, 0.5f, 0.1f}, 0.25),
            (CrossFade{4, 4, 0}));
}

TEST(SystemPictures, TheFullModelIsWhatSmallTolerancesDraw) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView near(scene_of_torus(1e4f), {{&torus()}});
  const ViewConfig config = view_config(near.scene(), size);
  SystemPictures pictures(near, *renderer, *scheduler);
  const Camera camera = approach(3)[1];
  const SystemPicture full = pictures.draw("full", camera, config);
  EXPECT_EQ(full.image.depth.size(), full.image.rgba.size() / 4);
  for (const std::string system : {"morph", "step", "discrete", "cross-fade"}) {
    const SystemPicture drawn = pictures.draw(system, camera, config);
    EXPECT_EQ(drawn.image.rgba, full.image.rgba) << system;
    EXPECT_EQ(drawn.stats.triangles, full.stats.triangles);
    EXPECT_EQ(drawn.pictures, 1);
  }
}

TEST(SystemPictures, TheMorphIsTheUsualPicture) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView view(scene_of_torus(), {{&torus()}});
  view.upload(*renderer);
  const ViewConfig config = view_config(view.scene(), size);
  const Camera camera = approach(3)[1];
  (void)view.update(camera, config);
  (void)view.draw(*renderer);
  const Image usual = renderer->read_back();
  SystemPictures pictures(view, *renderer, *scheduler);
  EXPECT_EQ(pictures.draw("morph", camera, config).image.rgba, usual.rgba);
  EXPECT_NE(pictures.draw("discrete", camera, config).image.rgba, usual.rgba);
}

TEST(SystemPictures, AddedSystemsAreDrawnAndChecked) {
  const auto halves = [](const SystemQuery& q) {
    return std::vector<SystemPart>{{whole_level(q.radii, q.hierarchy.finest()), q.blend, 0.5},
                                   {whole_level(q.radii, 0), q.blend, 0.5}};
  };
  add_lod_system("two-levels", {.description = "root and finest level, half each", .parts = halves, .blends = true});
  add_lod_system("unsaid", {.description = "the same, unannounced", .parts = halves});
  add_lod_system("nothing", {.parts = [](const SystemQuery&) { return std::vector<SystemPart>(); }});
  expect_error_of<InputError>([] { add_lod_system("empty", {}); }, {"'empty'", "parts, or patches"});
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView view(scene_of_torus(), {{&torus()}});
  view.upload(*renderer);
  const ViewConfig config = view_config(view.scene(), size);
  SystemPictures pictures(view, *renderer, *scheduler);
  const Camera camera = approach(3)[1];
  const SystemPicture half = pictures.draw("two-levels", camera, config), full = pictures.draw("full", camera, config);
  EXPECT_EQ(half.pictures, 2);
  EXPECT_GT(half.stats.triangles, full.stats.triangles);
  EXPECT_LE(half.stats.triangles, full.stats.triangles + torus().levels.front().triangles);
  for (const std::string name : {"nothing", "unsaid"})
    expect_error_of<InputError>([&] { (void)pictures.draw(name, camera, config); }, {name, "at most 1 are drawn"});
}

TEST(SystemPictures, BlendBytesAndTakeTheNearerDepth) {
  const Image a{{1, 1}, {0, 100, 200, 255}, {0.25f}}, b{{1, 1}, {255, 110, 0, 255}, {0.75f}};
  EXPECT_EQ(blended(a, b, 0).rgba, a.rgba);
  EXPECT_EQ(blended(a, b, 1).rgba, b.rgba);
  EXPECT_EQ(blended(a, b, 0.25).rgba, (std::vector<std::uint8_t>{64, 103, 150, 255}));
  EXPECT_EQ(blended(a, b, 0.9).depth, a.depth);
}

// The point of it all: on one path, the morph neither cracks nor pops, the others do what they are known for.
TEST(SystemFlight, TellsTheSystemsApart) {
  const auto scheduler = make_tbb_scheduler(2);
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView view(scene_of_torus(), {{&torus()}});
  SystemFlightConfig config;
  config.cameras = approach(40);
  config.view = view_config(view.scene(), size);
  config.quality.with_flip = false;
  std::size_t called = 0;
  const std::vector<SystemRow> rows = fly_systems(view, *renderer, config, *scheduler,
                                                  [&](const SystemRow& row, const SystemPicture&, const Image& full) {
                                                    EXPECT_EQ(row.frame, called++ / config.systems.size());
                                                    EXPECT_EQ(full.size, size);
                                                  });
  ASSERT_EQ(rows.size(), config.cameras.size() * config.systems.size());
  EXPECT_EQ(called, rows.size());

  struct Worst {
    SurfaceSample surface;
    double jump_over_bound = 0, jump_pixels = 0, changed = 0;
    int pictures = 0;
  };
  std::map<std::string, Worst> worst;
  for (const SystemRow& row : rows) {
    Worst& w = worst[row.system];
    const SurfaceSample& surface = row.surface.value();
    EXPECT_TRUE(surface.torn_pixels.has_value()) << "the torus is closed";
    EXPECT_GT(row.triangles, 0u);
    EXPECT_LE(surface.gap_mean, surface.gap);
    if (surface.jump) {
      EXPECT_LE(surface.jump->p99.value(), surface.jump->largest);
      w.jump_over_bound = std::max(w.jump_over_bound, surface.jump->over_bound.value());
      w.jump_pixels = std::max(w.jump_pixels, surface.jump->pixels);
    }
    add(w.surface, surface);
    w.pictures = std::max(w.pictures, row.pictures);
    if (row.pops) w.changed = std::max(w.changed, row.pops->absolute.changed_share);
  }
  const Worst &morph = worst["morph"], &step = worst["step"], &discrete = worst["discrete"],
              &fade = worst["cross-fade"];
  for (const Worst* whole : {&morph, &step, &fade}) {
    EXPECT_EQ(whole->surface.open_edges, 0);
    EXPECT_EQ(whole->surface.gap, 0);
    EXPECT_EQ(whole->surface.torn_pixels, 0);
    EXPECT_EQ(whole->surface.t_junctions, 0);
  }
  EXPECT_GT(discrete.surface.open_edges, 0);
  EXPECT_GT(discrete.surface.gap, 0);
  EXPECT_GT(discrete.surface.gap_pixels, 0.5);
  EXPECT_GT(discrete.surface.torn_pixels.value(), 0);
  EXPECT_LE(morph.jump_over_bound, 1);
  EXPECT_GT(step.jump_over_bound, 1);
  EXPECT_GT(discrete.jump_over_bound, 1);
  EXPECT_GT(discrete.jump_pixels, morph.jump_pixels);
  EXPECT_GT(discrete.changed, morph.changed);
  EXPECT_EQ(fade.pictures, 2);
  EXPECT_FALSE(fade.surface.jump);
}

// The largest ratio on one path by the systems that let vertices jump.
std::map<std::string, std::optional<double>> jumps_over_bound(Scene scene, Blend blend) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView view(scene, {{&torus()}});
  SystemFlightConfig config;
  config.cameras = approach(8);
  config.view = view_config(view.scene(), {32, 24});
  config.view.blend = blend;
  config.systems = {"step", "discrete"};
  config.quality = {.with_flip = false, .with_ssim = false};
  config.leaks = false;
  std::map<std::string, SurfaceSample> all;
  for (const SystemRow& row : fly_systems(view, *renderer, config, *scheduler)) add(all[row.system], *row.surface);
  return {{"step", all["step"].jump.value().over_bound}, {"discrete", all["discrete"].jump.value().over_bound}};
}

// Neither of the two morphs, so that the view's blend changes what they are measured by and nothing else.
TEST(SystemFlight, JumpsAreMeasuredByTheBoundOfTheViewsBlend) {
  auto linear = jumps_over_bound(scene_of_torus(), Blend::linear),
       smooth = jumps_over_bound(scene_of_torus(), Blend::smoothstep);
  for (const std::string system : {"step", "discrete"}) {
    EXPECT_GT(smooth[system].value(), 0) << system;
    EXPECT_DOUBLE_EQ(linear[system].value(), 1.5 * smooth[system].value()) << system;
  }
}

// The experiments `flight` and `systems` measure a surface alike: what discrete levels draw, by either.
TEST(SystemFlight, MeasuresASurfaceAsAFlightDoes) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView view(scene_of_torus(), {{&torus()}});
  SystemFlightConfig config;
  config.cameras = approach(6);
  config.view = view_config(view.scene(), size);
  config.systems = {"discrete"};
  config.quality = {.with_flip = false, .with_ssim = false};
  SurfaceMeasures measures(torus(), size, *scheduler);
  double junctions = 0;
  (void)fly_systems(view, *renderer, config, *scheduler,
                    [&](const SystemRow& row, const SystemPicture& drawn, const Image&) {
                      const SystemModel& model = drawn.models.front();
                      ModelFrame frame;
                      frame.morph = model.context();
                      frame.view_projection = model.view_projection;
                      const SurfaceSample sample = measures.measure(frame, {config.cameras[row.frame], row.frame > 0});
                      const SurfaceSample& surface = row.surface.value();
                      EXPECT_EQ(sample.open_edges, surface.open_edges);
                      EXPECT_EQ(sample.t_junctions, surface.t_junctions);
                      EXPECT_EQ(sample.torn_pixels, surface.torn_pixels);
                      EXPECT_EQ(sample.gap_pixels, surface.gap_pixels);
                      EXPECT_NEAR(sample.gap_mean_pixels, surface.gap_mean_pixels, 1e-9);
                      ASSERT_EQ(sample.jump.has_value(), row.frame > 0);
                      ASSERT_EQ(surface.jump.has_value(), row.frame > 0);
                      if (sample.jump) {
                        EXPECT_EQ(sample.jump->largest, surface.jump->largest);
                        EXPECT_EQ(sample.jump->per_step, surface.jump->per_step);
                      }
                      EXPECT_EQ(sample.gap, surface.gap);
                      EXPECT_NEAR(sample.gap_mean, surface.gap_mean, 1e-9);
                      junctions += static_cast<double>(surface.t_junctions.value());
                    });
  EXPECT_GT(junctions, 0);
}

TEST(SystemFlight, JumpsHaveNoBoundWhereTheMorphHasNone) {
  Scene scene = scene_of_torus(0.3f);
  scene.radii.rule = RadiiRule::uniform;
  for (const auto& [system, ratio] : jumps_over_bound(scene, Blend::linear)) EXPECT_FALSE(ratio) << system;
}

TEST(SystemFlight, RefusesWhatItCannotCompare) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler), null = make_renderer("null", *scheduler);
  SceneView view(scene_of_torus(), {{&torus()}});
  SystemFlightConfig good;
  good.cameras = approach(2);
  good.view = view_config(view.scene(), {32, 24});
  good.geometry = false;
  const auto refused = [&](const SystemFlightConfig& config, Renderer& with) {
    EXPECT_THROW((void)fly_systems(view, with, config, *scheduler), InputError);
  };
  SystemFlightConfig no_cameras = good, no_systems = good, full = good;
  no_cameras.cameras.clear();
  no_systems.systems.clear();
  full.systems.push_back("full");
  refused(no_cameras, *renderer);
  refused(no_systems, *renderer);
  refused(full, *renderer);
  refused(good, *null);
  CancelFlag cancel = true;
  SystemFlightConfig cancelled = good;
  cancelled.cancel = &cancel;
  EXPECT_THROW((void)fly_systems(view, *renderer, cancelled, *scheduler), Cancelled);

  Scene two = scene_of_torus();
  two.models.push_back(two.models.front());
  two.models.back().name = "other";
  SceneView both(two, {{&torus()}, {&torus()}});
  SystemPictures pictures(both, *renderer, *scheduler);
  EXPECT_THROW((void)pictures.draw("cross-fade", good.cameras[0], good.view), InputError);
  EXPECT_EQ(pictures.draw("discrete", good.cameras[0], good.view).models.size(), 2u);
}

}  // namespace
}  // namespace lodestone
