// Selection on the device: the same list as the CPU's, cell by cell, over many views, metrics, radii and limits; and
// the buffer that carries what changes with every frame.
#include <algorithm>
#include <random>

#include "render/backends/gl/device/context.h"
#include "render/backends/gl/device/stream.h"
#include "render/camera/camera.h"
#include "render/lod/thresholds.h"
#include "tests/render/backends/gl_fixture.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

TEST(Thresholds, TakeThePlaceOfRoots) {
  std::mt19937 random(1);
  const auto number = [&](float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random); };
  for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev})
    for (int i = 0; i < 3000; ++i) {
      const float radius = i % 2 ? number(0, 4) : std::exp(number(-20, 20)), limit = number(0, 3);
      const float least = reaching(metric, radius), fallen = falling_below(metric, limit, radius);
      for (int k = 0; k < 40; ++k) {
        // A few floats around the threshold.
        float s = std::max(k % 2 ? least : fallen, 0.0f);
        for (int steps = 0; steps < k / 4; ++steps) s = std::nextafter(s, k % 4 < 2 ? 0.0f : 1e30f);
        EXPECT_EQ(s >= least, root_of(metric, s) >= radius);
        EXPECT_EQ(!(s >= fallen), limit - root_of(metric, s) >= radius);
      }
    }
  EXPECT_EQ(reaching(DistanceMetric::euclidean, 0), 0);
  EXPECT_EQ(reaching(DistanceMetric::euclidean, std::numeric_limits<float>::infinity()),
            std::numeric_limits<float>::infinity());
}

class GlSelect : public GlTest {};

void expect_same(const Selection& device, const Selection& cpu, int view) {
  ASSERT_EQ(device.cells.size(), cpu.cells.size()) << "view " << view;
  for (std::size_t k = 0; k < cpu.cells.size(); ++k) {
    EXPECT_EQ(device.cells[k].cell, cpu.cells[k].cell) << "view " << view;
    EXPECT_EQ(device.cells[k].level, cpu.cells[k].level);
    EXPECT_EQ(device.cells[k].visible, cpu.cells[k].visible);
    EXPECT_EQ(device.cells[k].morphing, cpu.cells[k].morphing);
  }
}

TEST_F(GlSelect, IsTheCpusSelection) {
  const NaiveHierarchy torus = naive_hierarchy(torus_mesh(128, 64), 4), land = naive_hierarchy(terrain_mesh(64), 3);
  const std::vector<const Hierarchy*> models{&torus.hierarchy, &land.hierarchy};
  renderer_->upload(models);
  std::mt19937 random(2);
  const auto number = [&](float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random); };
  const auto point = [&](double lo, double hi) {
    const auto n = [&] { return std::uniform_real_distribution<double>(lo, hi)(random); };
    return Vec3d{n(), n(), n()};
  };
  std::size_t cells = 0, morphing = 0, limited = 0;
  for (int view = 0; view < 400; ++view) {
    const auto model = static_cast<std::uint32_t>(view % 2);
    const Hierarchy& h = *models[model];
    RadiiConfig config;
    config.kappa0 = number(0.2f, 6);
    config.metric = view % 3 ? DistanceMetric::euclidean : DistanceMetric::chebyshev;
    config.rule = view % 5 ? RadiiRule::per_level : RadiiRule::uniform;
    config.delta = view % 7 ? 0 : 0.1f;
    const Radii radii = make_radii(h, config);
    const auto to_model = [&](Vec3d p) { return h.transform.origin + h.transform.scale * p; };
    // Now and then on a vertex, or on a corner of a cell.
    Vec3d at = point(-0.4, 1.4);
    if (view % 4 == 0) at = to_double(h.cells[random() % h.cells.size()].bounds.lo);
    const Camera camera{to_model(at), to_model(point(0, 1)), {0, 0, 1}, number(0.1f, 2)};
    std::vector<DetailLimit> limits;
    if (view % 3 == 1)
      for (int k = 0; k < 12; ++k) {
        const CellId c(random() % h.cells.size());
        limits.push_back(
            {h.cells[c].bounds, radii.select[static_cast<std::size_t>(h.level_of(c))] * number(0.5f, 1.1f)});
      }
    Frame frame;
    frame.size = {320, 200};
    ModelFrame& drawn = frame.only();
    drawn.model = model;
    drawn.morph = {&h, &radii, Blend::smoothstep, viewpoint(camera, h.transform), limits};
    drawn.view_projection = view_projection(camera, h, frame.size);
    const Frustum frustum = frustum_of(drawn.view_projection);
    Selection expected, unlimited;
    select_cells(h, radii, drawn.morph.viewpoint, {&frustum, false, limits}, expected);
    select_cells(h, radii, drawn.morph.viewpoint, {&frustum, false}, unlimited);
    const std::vector<Selection> selected = renderer_->select(frame);
    ASSERT_EQ(selected.size(), 1u);
    expect_same(selected[0], expected, view);
    cells += expected.cells.size();
    morphing += static_cast<std::size_t>(std::ranges::count_if(expected.cells, &SelectedCell::morphing));
    limited += expected.cells.size() != unlimited.cells.size();
  }
  EXPECT_GT(cells, 10'000u);
  EXPECT_GT(morphing, 1000u);
  EXPECT_GT(cells - morphing, 1000u);
  EXPECT_GT(limited, 20u) << "limits hardly changed anything: the test says nothing";
}

TEST_F(GlSelect, DrawsTheSamePicture) {
  const NaiveHierarchy torus = naive_hierarchy(torus_mesh(96, 48), 3);
  renderer_->upload(torus.hierarchy);
  for (const float kappa0 : {0.4f, 2.0f, 5.0f}) {
    WholeFrame whole(torus.hierarchy, with_kappa0(kappa0), {{0.4, -0.55, 0.6}, {0.5, 0.5, 0.1}});
    const Frustum frustum = frustum_of(whole.frame.only().view_projection);
    select_cells(torus.hierarchy, whole.radii, whole.frame.only().morph.viewpoint, {&frustum, false}, whole.selection);
    const FrameStats by_cpu = renderer_->draw(whole.frame);
    const Image expected = renderer_->read_back();
    EXPECT_FALSE(by_cpu.milliseconds.contains("device select"));
    whole.frame.only().selection = nullptr;
    whole.frame.select_on_device = true;
    const FrameStats by_device = renderer_->draw(whole.frame);
    EXPECT_TRUE(renderer_->read_back().rgba == expected.rgba);
    EXPECT_EQ(by_device.triangles, by_cpu.triangles);
    EXPECT_TRUE(by_device.milliseconds.contains("device select"));
  }
}

TEST(GlStream, KeepsWhatFramesUnderWayRead) {
  std::unique_ptr<GlContext> context;
  try {
    context = make_headless_context();
  } catch (const UnsupportedError& error) {
    GTEST_SKIP() << error.what();
  }
  const CurrentContext current(*context);
  GlStream stream;
  struct Written {
    GlRange range;
    std::vector<std::uint32_t> values;
    int frame;
  };
  std::vector<Written> written;
  std::mt19937 random(5);
  std::size_t grown = 0;
  for (int frame = 0; frame < 60; ++frame) {
    stream.next_frame();
    const std::size_t before = stream.bytes();
    for (int k = 0; k < 5; ++k) {
      std::vector<std::uint32_t> values(random() % (frame < 30 ? 2000 : 60'000));
      for (std::uint32_t& v : values) v = static_cast<std::uint32_t>(random());
      const GlRange range = stream.write(std::span<const std::uint32_t>(values));
      EXPECT_EQ(range.offset % 16, 0);
      EXPECT_EQ(range.bytes, static_cast<GLsizeiptr>(std::max<std::size_t>(4 * values.size(), 4)));
      written.push_back({range, values, frame});
    }
    grown += stream.bytes() != before;
    for (const Written& w : written) {
      if (w.frame < frame || w.values.empty()) continue;  // this frame's, whatever came after them
      std::vector<std::uint32_t> there(w.values.size());
      glGetNamedBufferSubData(w.range.buffer, w.range.offset, w.range.bytes, there.data());
      EXPECT_TRUE(there == w.values);
    }
  }
  EXPECT_GE(grown, 2u);
  EXPECT_LE(grown, 6u) << "a buffer that is large enough stays";
}

}  // namespace
}  // namespace lodestone
