// Scenes before a camera: placement, sharing, and rest.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/model/signatures.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "render/camera/placement.h"
#include "render/lod/resident_cells.h"
#include "render/scene/scene_view.h"
#include "tests/expect_error.h"
#include "tests/old_lode.h"
#include "tests/render/conformance.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

const Hierarchy& torus() {
  static const test::NaiveHierarchy made = test::naive_hierarchy(test::torus_mesh(96, 48), 3);
  return made.hierarchy;
}

Scene scene_of_one() {
  Scene scene = scene_of("torus.lode");
  scene.radii.kappa0 = 2;
  return scene;
}

const Camera camera{{0.4, -0.9, 0.9}, {0.5, 0.5, 0.1}};
constexpr ImageSize size{160, 120};

Image draw(SceneView& view, const Camera& from, Renderer& renderer) {
  view.upload(renderer);
  EXPECT_TRUE(view.update(from, view_config(view.scene(), size)));
  (void)view.draw(renderer);
  return renderer.read_back();
}

TEST(SceneView, AModelAloneIsDrawnAsItIs) {
  SceneView view(scene_of_one(), {{&torus()}});
  (void)view.update(camera, view_config(view.scene(), size));
  const ModelFrame& model = view.frame().only();
  EXPECT_EQ(model.view_projection.m, view_projection(camera, torus(), size).m);
  EXPECT_EQ(model.morph.viewpoint, viewpoint(camera, torus().transform));
  EXPECT_EQ(view.unit(), torus().transform.scale);
}

// A scene and its camera turned, scaled and moved together: the same picture, but for rounding.
TEST(SceneView, PlacementMovesNothingWithTheCamera) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView plain(scene_of_one(), {{&torus()}});
  const Image expected = draw(plain, camera, *renderer);
  for (const double scale : {1.0, 1e-6, 1e6}) {
    const Similarity moved{rotation_about_axes({10, 20, 30}), scale, scale * Vec3d{5, -6, 1e4}};
    Scene scene = scene_of_one();
    scene.models[0].position = moved.translation;
    scene.models[0].rotation = {10, 20, 30};
    scene.models[0].scale = scale;
    const Camera there{moved(camera.position), moved(camera.target), moved.rotated(camera.up), camera.vertical_fov};
    SceneView view(scene, {{&torus()}});
    test::expect_conformance(draw(view, there, *renderer), expected);
  }
}

TEST(SceneView, AnchorsAndExtents) {
  SceneModel model;
  model.position = {1, 2, 3};
  model.rotation = {90, 0, 0};
  model.extent = 4;
  model.anchor = Anchor::base;
  const auto bounds = [&] {
    const Similarity placed = placement_of(model, torus());
    const Box3f& b = torus().cells[0].bounds;
    const Vec3d p = placed(to_double(b.lo)), q = placed(to_double(b.hi));
    return std::pair{Vec3d{std::min(p.x, q.x), std::min(p.y, q.y), std::min(p.z, q.z)},
                     Vec3d{std::max(p.x, q.x), std::max(p.y, q.y), std::max(p.z, q.z)}};
  };
  auto [lo, hi] = bounds();
  EXPECT_NEAR(std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}), 4, 1e-9);
  EXPECT_NEAR(lo.z, 3, 1e-9);
  EXPECT_NEAR((lo.x + hi.x) / 2, 1, 1e-9);
  model.anchor = Anchor::centre;
  std::tie(lo, hi) = bounds();
  EXPECT_NEAR((lo.z + hi.z) / 2, 3, 1e-9);
  model = {};
  EXPECT_EQ(placement_of(model, torus()), to_similarity(torus().transform));
}

// Far apart in size and place: none is cut, each is seen at its place.
TEST(SceneView, ModelsOfVeryDifferentSizes) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  Scene scene;
  scene.models.resize(2);
  scene.models[0].name = "small", scene.models[1].name = "large";
  for (SceneModel& model : scene.models) model.anchor = Anchor::centre;
  scene.models[0].extent = 0.02;
  scene.models[1].extent = 1000;
  scene.models[1].position = {0, 3000, 0};
  SceneView view(scene, {{&torus()}, {&torus()}});
  const Camera close{{0, -0.05, 0.02}, {0, 0, 0}};
  const Image image = draw(view, close, *renderer);
  view.update(close, view_config(scene, size));
  EXPECT_EQ(view.frame().models[0].model, view.frame().models[1].model);  // uploaded once
  const auto covered = [&](int y0, int y1) {
    int count = 0;
    for (int i = y0 * size.width; i < y1 * size.width; ++i) count += image.depth[static_cast<std::size_t>(i)] < 1;
    return count;
  };
  Scene alone = scene;
  alone.models.pop_back();
  SceneView small(alone, {{&torus()}});
  const Image without = draw(small, close, *renderer);
  const auto seen_alone = std::ranges::count_if(without.depth, [](float z) { return z < 1; });
  EXPECT_GT(seen_alone, 1000);
  EXPECT_GT(covered(0, size.height), seen_alone + 500);  // the large one behind it
}

// Powers of two, so that nothing is rounded otherwise.
TEST(SceneView, UnitsBeyondTheRangeOfFloatMakeTheSamePicture) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView usual(scene_of_one(), {{&torus()}});
  const Image expected = draw(usual, camera, *renderer);
  for (const double scale : {0x1p-600, 0x1p130, 0x1p600}) {
    Hierarchy model = torus();
    model.transform.scale *= scale;
    model.transform.origin = scale * model.transform.origin;
    SceneView view(scene_of_one(), {{&model}});
    Camera from = camera;
    from.position = scale * from.position;
    from.target = scale * from.target;
    EXPECT_EQ(draw(view, from, *renderer).rgba, expected.rgba) << scale;
  }
}

// Runs of triangles that throw no shadow into a picture from near by are left out of the map: no bit changes.
TEST(SceneView, ShadowMapsLeaveRunsOut) {
  const auto scheduler = make_serial_scheduler();
  Scene scene = scene_of_one();
  scene.settings.lighting.directional.shadows = true;
  scene.effects = parse_effects("directional-light,shadow");
  const auto renderer = make_renderer("soft", *scheduler);
  const test::NaiveHierarchy fine = test::naive_hierarchy(test::torus_mesh(384, 192), 3);
  int fewer = 0;
  for (const double height : {0.15, 0.3, 0.6}) {
    SceneView view(scene, {{&fine.hierarchy}});
    const Image image = draw(view, {{0.2, 0.1, height}, {0.3, 0.5, 0.1}}, *renderer);
    const FrameStats stats = renderer->draw(view.frame());
    Frame whole = view.frame();
    ASSERT_TRUE(whole.only().casters);
    Selection casters = *whole.only().casters;
    for (SelectedCell& cell : casters.cells) cell.ranges = {};
    whole.only().casters = &casters;
    const FrameStats of_whole = renderer->draw(whole);
    EXPECT_TRUE(renderer->read_back().rgba == image.rgba);
    EXPECT_LE(stats.work.at("shadow triangles"), of_whole.work.at("shadow triangles"));
    fewer += stats.work.at("shadow triangles") < of_whole.work.at("shadow triangles");
  }
  EXPECT_GT(fewer, 1);
}

TEST(SceneView, ACameraAtRestDoesNothing) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  SceneView view(scene_of_one(), {{&torus()}});
  view.upload(*renderer);
  ViewConfig config = view_config(view.scene(), size);
  EXPECT_TRUE(view.update(camera, config));
  EXPECT_GT(view.draw(*renderer).triangles, 0u);
  const Image before = renderer->read_back();
  EXPECT_FALSE(view.update(camera, config));
  const FrameStats rest = view.draw(*renderer);
  EXPECT_EQ(rest.triangles, 0u);
  EXPECT_TRUE(rest.work.empty());
  EXPECT_TRUE(rest.milliseconds.empty());
  EXPECT_EQ(renderer->read_back().rgba, before.rgba);
  // Anything that may change the picture ends the rest.
  config.settings.fog.density = 0.5f;
  EXPECT_TRUE(view.update(camera, config));
  EXPECT_FALSE(view.update(camera, config));
  EXPECT_GT(view.draw(*renderer).triangles, 0u);  // asked for by the look before
  Camera other = camera;
  other.position.x += 1e-9;
  EXPECT_TRUE(view.update(other, config));
}

TEST(SceneView, RefusesWhatCannotBeSeen) {
  EXPECT_THROW((void)SceneView(scene_of_one(), {{std::make_unique<Hierarchy>().get()}}), InputError);
  SceneView view(scene_of_one(), {{&torus()}});
  const ViewConfig config = view_config(view.scene(), size);
  ASSERT_TRUE(view.update(camera, config));
  const auto matrix = view.frame().only().view_projection.m;
  Camera nowhere = camera;
  nowhere.position.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)view.update(nowhere, config), InputError);
  ViewConfig empty = config;
  empty.size = {0, 120};
  EXPECT_THROW((void)view.update(camera, empty), InputError);
  ViewConfig wrong = config;
  wrong.radii.beta = -1;
  EXPECT_THROW((void)view.update(camera, wrong), InputError);
  EXPECT_TRUE(view.update(camera, config));  // and it goes on
  EXPECT_EQ(view.frame().only().view_projection.m, matrix);
}

TEST(SceneView, StandsByItsFirstModelUnlessItSaysOtherwise) {
  Hierarchy model = torus();
  model.transform.up = {UpAxis::y, false};
  Scene scene = scene_of_one();
  const auto up_of_scene = [&] { return SceneView(scene, {{&model}}).up(); };
  EXPECT_EQ(up_of_scene(), (Vec3d{0, 1, 0}));
  scene.models[0].rotation = {90, 0, 0};
  EXPECT_EQ(up_of_scene(), (Vec3d{0, 0, 1}));
  scene.up = UpAxis::minus_x;
  EXPECT_EQ(up_of_scene(), (Vec3d{-1, 0, 0}));
}

// The frames of a path on which the camera stands are drawn once.
TEST(CameraPathOfAScene, DrawsNothingAgainWhereTheCameraStands) {
  const auto scheduler = make_serial_scheduler();
  const auto renderer = make_renderer("soft", *scheduler);
  Scene scene = scene_of_one();
  const Camera next{{-0.4, -0.9, 0.7}, {0.3, 0.1, 0.7}};
  scene.camera = {"", "", {camera, camera, camera, next}, 10};
  SceneView view(scene, {{&torus()}});
  view.upload(*renderer);
  std::vector<int> drawn;
  for (const Camera& c : camera_path(view, size)) {
    (void)view.update(c, view_config(scene, size));
    drawn.push_back(view.draw(*renderer).triangles > 0 ? 1 : 0);
  }
  EXPECT_EQ(drawn, (std::vector{1, 0, 0, 0, 0, 0, 0, 1, 1, 1}));
}

TEST(CameraPathOfAScene, FollowsWhatTheSceneSays) {
  Scene scene = scene_of_one();
  scene.models[0].position = {100, 0, 0};
  scene.camera = {"orbit", "", {}, 8};
  const auto path_of = [&] { return camera_path(SceneView(scene, {{&torus()}}), size); };
  for (const Camera& c : path_of()) EXPECT_NEAR(c.target.x - 100, bounding_sphere(torus()).centre.x, 1e-6);
  for (const char* path : {"fly-in", "walk", "wander"}) {
    scene.camera.path = path;
    const std::vector<Camera> there = path_of();
    const std::vector<Camera> here = model_path(path, torus(), 8, {{0, 0, 1}, aspect_of(size)});
    ASSERT_EQ(there.size(), here.size());
    for (std::size_t k = 0; k < here.size(); ++k)
      EXPECT_LE(length(there[k].position - here[k].position - Vec3d{100, 0, 0}), 1e-9) << path;
  }
  scene.camera.path = "";
  EXPECT_THROW((void)path_of(), InputError);
  scene.camera.keys = {camera, {{3, 3, 3}, {0, 0, 0}}};
  EXPECT_EQ(path_of().size(), 8u);
  EXPECT_EQ(path_of().front(), camera);
}

// Expects that every family comes before it goes, and goes before it comes again.
class Bookkeeper final : public Renderer {
 public:
  [[nodiscard]] std::string_view name() const override { return "bookkeeper"; }
  using Renderer::upload;
  void upload(std::span<const Hierarchy* const> models) override {
    model_ = models.front();
    families_ = resident();
  }
  void refresh(std::uint32_t /*model*/, std::span<const CellId> went, std::span<const CellId> came) override {
    for (const CellId family : went) EXPECT_EQ(families_.erase(family), 1u);
    for (const CellId family : came) EXPECT_TRUE(families_.insert(family).second);
    changes += went.size() + came.size();
  }
  FrameStats draw(const Frame& frame) override {
    for (const SelectedCell& cell : frame.only().selection->cells)
      EXPECT_TRUE(families_.contains(model_->cells[cell.cell].parent));
    return {};
  }
  [[nodiscard]] Image read_back() override { return {}; }
  std::size_t changes = 0;

 private:
  [[nodiscard]] std::set<CellId> resident() const {
    std::set<CellId> families;
    for (const Cell& cell : model_->cells)
      if (!cell.positions.empty()) families.insert(cell.parent);
    return families;
  }
  const Hierarchy* model_ = nullptr;
  std::set<CellId> families_;
};

// While a model is hidden nothing is loaded for it; what came before must not come again with each picture.
TEST(SceneView, StreamedFamiliesComeAndGoOnce) {
  const TestFolder folder;
  (void)write_lode(torus(), folder.path() / "torus.lode");
  CellStream stream(folder.path() / "torus.lode");
  std::uint64_t all = stream.family_bytes(no_cell);
  for (CellId c{0}; c < stream.tables().cells.size(); ++c) all += stream.family_bytes(c);
  ResidentCells resident(stream, {.budget_bytes = all / 2});
  SceneView view(scene_of_one(), {{&resident.hierarchy(), &resident}});
  Bookkeeper renderer;
  view.upload(renderer);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-2, 3);
  for (int i = 0; i < 300; ++i) {
    ViewConfig config = view_config(view.scene(), size);
    config.hidden = {i % 10 > 5};
    (void)view.update({{place(random), place(random), 0.4}, {0.5, 0.5, 0.1}}, config);
    if (i % 7 != 3) (void)view.draw(renderer);  // a picture may be left out
    if (i % 50 == 49) view.upload(renderer);
    stream.wait();
  }
  EXPECT_GT(renderer.changes, 50u);
}

// Signatures are found once for all placements of a model, radii once for a tolerance.
TEST(SceneView, AdaptiveRadiiAreMadeOncePerTolerance) {
  Scene scene = scene_of_one();
  scene.models.push_back(scene.models.front());
  scene.models.back().name = "other";
  scene.models.back().position = {3, 0, 0};
  SceneView view(scene, {{&torus()}, {&torus()}});
  ViewConfig config = view_config(view.scene(), size);
  config.radii = {};
  config.radii.rule = RadiiRule::adaptive;
  ASSERT_TRUE(view.update(camera, config));
  const Signatures* found = view.radii(0).signatures.get();
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(view.radii(1).signatures.get(), found);
  EXPECT_TRUE(view.admissible());
  const float* radii = view.radii(0).by_cell.data();
  const std::vector<float> before = view.radii(0).by_cell;
  Camera moved = camera;
  moved.position.x += 1;
  ASSERT_TRUE(view.update(moved, config));
  EXPECT_EQ(view.radii(0).by_cell.data(), radii);
  config.radii.pixel_error = 5;
  ASSERT_TRUE(view.update(moved, config));
  EXPECT_NE(view.radii(0).by_cell, before);
  EXPECT_EQ(view.radii(0).signatures.get(), found);
}

// The cells of a streamed model are not all there: its file has their signatures. Without them it is drawn by radii per
// level.
TEST(SceneView, AdaptiveRadiiOfStreamedModelsComeFromTheFile) {
  const TestFolder folder;
  (void)write_lode(torus(), folder.path() / "torus.lode");
  for (const bool has_signatures : {true, false}) {
    if (!has_signatures) test::drop_signatures(folder.path() / "torus.lode");
    CellStream stream(folder.path() / "torus.lode");
    ASSERT_EQ(stream.tables().signatures != nullptr, has_signatures);
    ResidentCells resident(stream, {.budget_bytes = std::uint64_t{1} << 30});
    SceneView view(scene_of_one(), {{&resident.hierarchy(), &resident}});
    ViewConfig config = view_config(view.scene(), size);
    config.radii = {};
    config.radii.rule = RadiiRule::adaptive;
    ASSERT_TRUE(view.update(camera, config));
    EXPECT_EQ(view.radii(0).signatures, stream.tables().signatures);
    const Radii whole = make_radii(torus(), for_picture(config.radii, size, camera.vertical_fov));
    EXPECT_EQ(view.radii(0).by_cell, has_signatures ? whole.by_cell : std::vector<float>{});
    for (int i = 0; i < 400 && !view.complete(); ++i) stream.wait(), (void)view.update(camera, config);
    EXPECT_TRUE(view.complete());
  }
}

}  // namespace
}  // namespace lodestone
