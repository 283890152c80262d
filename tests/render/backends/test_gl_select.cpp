// Selection on the device: the same list as the CPU's, cell by cell, over many views, metrics, radii by level and by
// cell, and limits; the root that it takes; and the buffer that carries what changes with every frame.
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <random>

#include "core/hierarchy/model/find_signatures.h"
#include "render/backends/gl/device/context.h"
#include "render/backends/gl/device/program.h"
#include "render/backends/gl/device/stream.h"
#include "render/backends/gl/shaders/exact_root.h"
#include "render/camera/camera.h"
#include "render/culling/runs.h"
#include "tests/render/backends/gl_fixture.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

// A context that is current, or a skip.
class GlContextTest : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      context_ = make_headless_context();
    } catch (const UnsupportedError& error) {
      GTEST_SKIP() << error.what();
    }
    current_.emplace(*context_);
  }
  std::unique_ptr<GlContext> context_;
  std::optional<CurrentContext> current_;
};

class GlExactRoot : public GlContextTest {};

TEST_F(GlExactRoot, IsTheCpusRoot) {
  std::vector<std::uint32_t> bits{0, 1, 2, 3, 0x7fffff, 0x800000, 0x800001, 0x7f7fffff, 0x7f800000};
  for (std::uint32_t digits = 0; digits < 1u << 23; digits += 37)  // both parities of the exponent
    for (const std::uint32_t exponent : {127u, 128u}) bits.push_back(exponent << 23 | digits);
  const std::size_t regular = bits.size();
  std::mt19937 random(3);
  for (int k = 0; k < 200'000; ++k) bits.push_back(static_cast<std::uint32_t>(random()) % 0x7f800000u);
  for (int k = 0; k < 100'000; ++k) {  // squares and their neighbours, where roots are exact or nearly so
    const auto square =
        std::bit_cast<std::uint32_t>(static_cast<float>(random() % 4096) * static_cast<float>(k % 4096));
    bits.insert(bits.end(), {square, square + 1, square > 0 ? square - 1 : 0});
  }
  ASSERT_GT(regular, 400'000u);

  constexpr const char* source = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) restrict buffer Numbers { uint numbers[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < numbers.length()) numbers[i] = floatBitsToUint(exact_root(uintBitsToFloat(numbers[i])));
}
)";
  std::string text = exact_root_source;
  text += source;
  const GlStage stage{GL_COMPUTE_SHADER, text};
  const GlProgram program = link_program(std::span(&stage, 1));
  const GlBuffer numbers;
  const auto size = static_cast<GLsizeiptr>(bits.size() * 4);
  glNamedBufferStorage(numbers.name(), size, bits.data(), 0);
  glUseProgram(program.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, numbers.name());
  glDispatchCompute(static_cast<GLuint>((bits.size() + 63) / 64), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<std::uint32_t> roots(bits.size());
  glGetNamedBufferSubData(numbers.name(), 0, size, roots.data());
  for (std::size_t k = 0; k < bits.size(); ++k)
    ASSERT_EQ(roots[k], std::bit_cast<std::uint32_t>(std::sqrt(std::bit_cast<float>(bits[k])))) << "of " << bits[k];
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

// A view of every rule, metric and guard in turn.
RadiiConfig config_of(int view, std::mt19937& random) {
  const auto number = [&](float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random); };
  RadiiConfig config;
  config.metric = view % 3 ? DistanceMetric::euclidean : DistanceMetric::chebyshev;
  config.rule = view % 2 ? RadiiRule::adaptive : view % 5 ? RadiiRule::per_level : RadiiRule::uniform;
  if (config.rule == RadiiRule::adaptive)
    config.pixel_error = std::exp(number(0, 5));
  else
    config.kappa0 = number(0.2f, 6);
  config.delta = view % 7 ? 0 : 0.1f;
  return config;
}

std::vector<DetailLimit> limits_on_cells(const Hierarchy& h, const Radii& radii, std::mt19937& random) {
  std::vector<DetailLimit> limits;
  for (int k = 0; k < 12; ++k) {
    const CellId c(random() % h.cells.size());
    const float share = std::uniform_real_distribution<float>(0.5f, 1.1f)(random);
    limits.push_back({h.cells[c].bounds, radii.of(c, static_cast<std::size_t>(h.level_of(c))) * share});
  }
  return limits;
}

TEST_F(GlSelect, IsTheCpusSelection) {
  const NaiveHierarchy torus = naive_hierarchy(torus_mesh(128, 64), 4), land = naive_hierarchy(terrain_mesh(64), 3);
  const std::vector<const Hierarchy*> models{&torus.hierarchy, &land.hierarchy};
  const std::shared_ptr<const Signatures> signatures[]{signatures_of(torus.hierarchy), signatures_of(land.hierarchy)};
  renderer_->upload(models);
  std::mt19937 random(2);
  const auto number = [&](float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(random); };
  const auto point = [&](double lo, double hi) {
    const auto n = [&] { return std::uniform_real_distribution<double>(lo, hi)(random); };
    return Vec3d{n(), n(), n()};
  };
  struct Counts {
    std::size_t cells = 0, morphing = 0, limited = 0;
  } by_level, by_cell;
  for (int view = 0; view < 800; ++view) {
    const auto model = static_cast<std::uint32_t>(view / 2 % 2);
    const Hierarchy& h = *models[model];
    const Radii radii = make_radii(h, config_of(view, random), signatures[model]);
    const auto to_model = [&](Vec3d p) { return h.transform.origin + h.transform.scale * p; };
    // Now and then on a corner of a cell, or where its distance is its radius but for roundings.
    Vec3d at = point(-0.4, 1.4);
    if (const auto place = random() % 4; place < 2) {
      const CellId near(random() % h.cells.size());
      at = to_double(h.cells[near].bounds.lo);
      const double radius = radii.of(near, static_cast<std::size_t>(h.level_of(near)));
      const Vec3d away = point(-1, -0.1);
      if (place == 1 && std::isfinite(radius)) at = at + (radius / length(away)) * away;
    }
    const Camera camera{to_model(at), to_model(point(0, 1)), {0, 0, 1}, number(0.1f, 2)};
    std::vector<DetailLimit> limits;
    if (view % 3 == 1) limits = limits_on_cells(h, radii, random);
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
    auto& [cells, morphing, limited] = radii.by_cell.empty() ? by_level : by_cell;
    cells += expected.cells.size();
    morphing += static_cast<std::size_t>(std::ranges::count_if(expected.cells, &SelectedCell::morphing));
    limited += expected.cells.size() != unlimited.cells.size();
  }
  for (const auto& [cells, morphing, limited] : {by_level, by_cell}) {
    EXPECT_GT(cells, 10'000u);
    EXPECT_GT(morphing, 1000u);
    EXPECT_GT(cells - morphing, 1000u);
    EXPECT_GT(limited, 20u) << "limits hardly changed anything: the test says nothing";
  }
}

TEST_F(GlSelect, DrawsTheSamePicture) {
  const NaiveHierarchy torus = naive_hierarchy(torus_mesh(192, 96), 2);
  renderer_->upload(torus.hierarchy);
  std::vector<RadiiConfig> configs;
  for (const float kappa0 : {0.4f, 2.0f, 5.0f}) configs.push_back(with_kappa0(kappa0));
  for (const float pixel_error : {4.0f, 16.0f, 64.0f})
    configs.push_back({.rule = RadiiRule::adaptive, .pixel_error = pixel_error});
  int fewer = 0;
  for (const RadiiConfig& config : configs) {
    WholeFrame whole(torus.hierarchy, config, {{0.3, 0.1, 0.2}, {0.5, 0.5, 0.1}});
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

    CullingRuns runs;
    whole.frame.only().runs = &runs;
    const FrameStats in_runs = renderer_->draw(whole.frame);
    EXPECT_TRUE(renderer_->read_back().rgba == expected.rgba);
    std::vector<TriangleRange> ranges;
    runs.cull(torus.hierarchy, whole.frame.only().view_projection, whole.frame.size, whole.selection, ranges);
    whole.frame.only().selection = &whole.selection;
    whole.frame.select_on_device = false;
    EXPECT_EQ(in_runs.triangles, renderer_->draw(whole.frame).triangles);
    EXPECT_LE(in_runs.triangles, by_cpu.triangles);
    fewer += in_runs.triangles < by_cpu.triangles;
  }
  EXPECT_GT(fewer, 2);
}

class GlStreamTest : public GlContextTest {};

TEST_F(GlStreamTest, KeepsWhatFramesUnderWayRead) {
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
