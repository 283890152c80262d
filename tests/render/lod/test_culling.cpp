// Culling changes no picture: flights drawn with and without it, bit for bit on the soft backend.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "render/culling/back_faces.h"
#include "render/culling/runs.h"
#include "tests/render/conformance.h"

namespace lodestone {
namespace {

struct Flight {
  std::string name;
  std::shared_ptr<const Hierarchy> hierarchy;
  std::vector<Camera> cameras;
  ImageSize size{320, 200};
  int samples = 1;
  std::optional<float> kappa0;
};

std::vector<Flight> flights() {
  static const auto torus = test::detail::shared(test::torus_mesh(96, 48), 3);
  static const auto ball = test::detail::shared(test::sphere_mesh(5), 4);
  static const auto scan = test::detail::built(Shape::sphere, 60'000);
  static const auto land = test::detail::built(Shape::terrain, 60'000);
  static const auto inward = [] {
    IndexedMesh mesh = test::torus_mesh(96, 48);
    for (Triangle& t : mesh.triangles) std::swap(t.v[0], t.v[1]);
    return test::detail::shared(std::move(mesh), 3);
  }();
  std::vector<Flight> all;
  for (const auto& [name, model] :
       {std::pair{"torus", torus}, {"ball", ball}, {"scan", scan}, {"land", land}, {"inward", inward}}) {
    all.push_back({std::string(name) + " orbit", model, orbit_path(*model, 8), {320, 200}, 1, {}});
    all.push_back({std::string(name) + " fly-in", model, fly_in_path(*model, 16), {320, 200}, 1, {}});
    all.push_back({std::string(name) + " least", model, fly_in_path(*model, 12), {161, 133}, 1, 0.3f});
    // Back and forth: hidden cells come into sight at once.
    Flight jumps{std::string(name) + " jumps", model, {}, {320, 200}, 4, 1.0f};
    const std::vector<Camera> orbit = orbit_path(*model, 6), down = fly_in_path(*model, 6);
    for (std::size_t k = 0; k < 6; ++k) jumps.cameras.push_back(k % 2 ? orbit[5 - k] : down[k]);
    all.push_back(jumps);
  }
  return all;
}

struct Drawn {
  std::vector<Image> images;
  std::vector<FrameStats> stats;
};

enum class Hidden { drawn, cells_left_out, runs_left_out };  // those of the cells that are seen, too

Drawn fly(const Flight& flight, Renderer& renderer, Hidden hidden, const BackFaces* back_faces,
          CullingRuns* runs = nullptr) {
  Drawn drawn;
  const Hierarchy& h = *flight.hierarchy;
  renderer.upload(h);
  for (const Camera& camera : flight.cameras) {
    RadiiConfig config;
    config.image_height = flight.size.height;
    config.kappa0 = flight.kappa0;
    const Radii radii = make_radii(h, config);
    Frame frame;
    frame.size = flight.size;
    frame.samples = flight.samples;
    frame.cull_occluded = hidden != Hidden::drawn;
    ModelFrame& model = frame.only();
    model.morph = {&h, &radii, Blend::smoothstep, viewpoint(camera, h.transform)};
    model.view_projection = view_projection(camera, h, flight.size);
    const Frustum frustum = frustum_of(model.view_projection);
    Selection selection;
    select_cells(h, radii, model.morph.viewpoint,
                 {&frustum, false, {}, back_faces ? back_faces->cones_from(model.morph.viewpoint, {}) : nullptr},
                 selection);
    std::vector<TriangleRange> ranges;
    if (runs) runs->cull(h, model.view_projection, frame.size, selection, ranges);
    model.selection = &selection;
    if (hidden == Hidden::runs_left_out) model.runs = runs;
    drawn.stats.push_back(renderer.draw(frame));
    drawn.images.push_back(renderer.read_back());
  }
  return drawn;
}

std::uint64_t triangles(const Drawn& drawn) {
  std::uint64_t sum = 0;
  for (const FrameStats& stats : drawn.stats) sum += stats.triangles;
  return sum;
}

void expect_same(const Drawn& a, const Drawn& b, const std::string& name) {
  for (std::size_t k = 0; k < a.images.size(); ++k) {
    EXPECT_TRUE(a.images[k].rgba == b.images[k].rgba) << name << ", frame " << k;
    EXPECT_TRUE(a.images[k].depth == b.images[k].depth) << name << ", frame " << k;
  }
}

// OpenGL keeps the first of equally near samples, and cells of the second part are drawn later. With
// four samples a pixel that has been met, on silhouettes.
void expect_same_but_for_ties(const Drawn& a, const Drawn& b, const std::string& name) {
  for (std::size_t k = 0; k < a.images.size(); ++k) {
    const ImageDifference d = image_difference(a.images[k], b.images[k], 0);
    EXPECT_LE(d.differing, 10u) << name << ", frame " << k;
    EXPECT_LE(d.max, 8) << name << ", frame " << k;
    EXPECT_TRUE(a.images[k].depth == b.images[k].depth) << name << ", frame " << k;
  }
}

TEST(Culling, OfRunsChangesNoPicture) {
  const auto scheduler = make_tbb_scheduler(2);
  for (const Flight& flight : flights()) {
    const auto renderer = make_renderer("soft", *scheduler);
    CullingRuns runs;
    const Drawn all = fly(flight, *renderer, Hidden::drawn, nullptr),
                culled = fly(flight, *renderer, Hidden::drawn, nullptr, &runs);
    expect_same(all, culled, flight.name);
    const Drawn occluded = fly(flight, *renderer, Hidden::runs_left_out, nullptr, &runs);
    expect_same(all, occluded, flight.name + ", occlusion");
    EXPECT_LE(triangles(culled), triangles(all)) << flight.name;
    if (flight.name == "scan fly-in" || flight.name == "land fly-in") {
      EXPECT_LT(triangles(culled), 0.95 * static_cast<double>(triangles(all))) << flight.name;
    }
    // The null backend counts what the others draw.
    EXPECT_EQ(triangles(fly(flight, *make_renderer("null", *scheduler), Hidden::drawn, nullptr, &runs)),
              triangles(culled));
  }
}

TEST(Culling, OfHiddenRunsLeavesOutMoreThanThatOfCells) {
  const auto scheduler = make_tbb_scheduler(2);
  const auto model = test::detail::built(Shape::sphere, 60'000);
  const Flight flight{"steps of four degrees", model, orbit_path(*model, 90), {320, 200}, 1, 1.0f};
  CullingRuns runs;
  const Drawn cells = fly(flight, *make_renderer("soft", *scheduler), Hidden::cells_left_out, nullptr, &runs),
              both = fly(flight, *make_renderer("soft", *scheduler), Hidden::runs_left_out, nullptr, &runs);
  expect_same(cells, both, flight.name);
  EXPECT_LT(triangles(both), triangles(cells));
}

TEST(Culling, OfRunsChangesNoPictureOnGl) {
  const auto scheduler = make_tbb_scheduler(2);
  std::string why;
  const auto renderer = test::renderer_if_possible("gl", *scheduler, why);
  if (!renderer) GTEST_SKIP() << why;
  for (const Flight& flight : flights()) {
    if (flight.name.find("fly-in") == std::string::npos) continue;
    CullingRuns runs;
    const Drawn all = fly(flight, *renderer, Hidden::drawn, nullptr),
                culled = fly(flight, *renderer, Hidden::drawn, nullptr, &runs);
    expect_same(all, culled, flight.name);
    EXPECT_EQ(triangles(culled),
              triangles(fly(flight, *make_renderer("null", *scheduler), Hidden::drawn, nullptr, &runs)));
    const Drawn occluded = fly(flight, *renderer, Hidden::runs_left_out, nullptr, &runs);
    expect_same(all, occluded, flight.name + ", occlusion");
    EXPECT_LE(triangles(occluded), triangles(culled));
    for (std::size_t k = 0; k < all.stats.size(); ++k) EXPECT_LE(occluded.stats[k].cells, all.stats[k].cells);
  }
}

TEST(Culling, BoxesOfRunsHoldBothEndsOfTheMorph) {
  Hierarchy h = *test::detail::built(Shape::terrain, 60'000);
  CullingRuns runs;
  for (CellId c{1}; c < h.cells.size(); ++c) {
    const Cell& cell = h.cells[c];
    const std::vector<Vec3f> coarser(h.cells[cell.parent].positions.begin(), h.cells[cell.parent].positions.end());
    std::vector<Box3f> expected((cell.triangles.size() + CullingRuns::length - 1) / CullingRuns::length);
    for (std::size_t t = 0; t < cell.triangles.size(); ++t)
      for (const std::uint32_t v : cell.triangles[t].v) {
        expected[t / CullingRuns::length].extend(cell.positions[v]);
        expected[t / CullingRuns::length].extend(coarser[cell.parents[v]]);
      }
    // Rounded outwards, and by hardly anything.
    const auto grown = [](float lo, float hi) { return 0x1p-21f * std::max(std::abs(lo), std::abs(hi)); };
    for (Box3f& box : expected) {
      const Vec3f by{grown(box.lo.x, box.hi.x), grown(box.lo.y, box.hi.y), grown(box.lo.z, box.hi.z)};
      box = {box.lo - by, box.hi + by};
    }
    EXPECT_TRUE(std::ranges::equal(runs.boxes(h, c), expected)) << c;
  }
  // Other cells may come in the place of those that go.
  const CellId child = h.cells[CellId(0)].first_child;
  const std::vector<Vec3f> moved(h.cells[child].positions.size(), Vec3f{});
  h.cells[child].positions = moved;
  const std::vector<Box3f> before(runs.boxes(h, child).begin(), runs.boxes(h, child).end());
  runs.forget(h, CellId(0));
  EXPECT_FALSE(std::ranges::equal(runs.boxes(h, child), before));
}

TEST(Culling, BoxesOfRunsHoldWhateverIsDrawnOfThem) {
  const auto model = test::detail::built(Shape::sphere, 60'000);
  const Hierarchy& h = *model;
  CullingRuns runs;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> number(-0.2f, 1.2f);
  for (CellId c{1}; c < h.cells.size(); ++c) {
    const Cell& cell = h.cells[c];
    const std::span<const Vec3f> coarser = h.cells[cell.parent].positions;
    const std::span<const Box3f> boxes = runs.boxes(h, c);
    for (std::size_t t = 0; t < cell.triangles.size(); ++t)
      for (const std::uint32_t v : cell.triangles[t].v) {
        const float lambda = std::clamp(number(random), 0.0f, 1.0f);
        const Vec3f p = blend_positions(lambda, cell.positions[v], coarser[cell.parents[v]]);
        const Box3f& box = boxes[t / CullingRuns::length];
        ASSERT_TRUE(p.x >= box.lo.x && p.y >= box.lo.y && p.z >= box.lo.z && p.x <= box.hi.x && p.y <= box.hi.y &&
                    p.z <= box.hi.z)
            << c << ", triangle " << t;
      }
  }
}

TEST(Culling, OfOccludedCellsChangesNoPicture) {
  const auto scheduler = make_tbb_scheduler(2);
  for (const Flight& flight : flights()) {
    const auto renderer = make_renderer("soft", *scheduler);
    const Drawn all = fly(flight, *renderer, Hidden::drawn, nullptr),
                culled = fly(flight, *renderer, Hidden::cells_left_out, nullptr);
    expect_same(all, culled, flight.name);
    EXPECT_LE(triangles(culled), triangles(all));
    std::uint64_t hidden = 0;
    for (const FrameStats& stats : culled.stats)
      if (stats.work.contains("hidden cells")) hidden += stats.work.at("hidden cells");
    EXPECT_EQ(hidden > 0, triangles(culled) < triangles(all));
    if (flight.name == "ball fly-in") {
      EXPECT_LT(triangles(culled), 0.8 * static_cast<double>(triangles(all)));
    }
  }
}

TEST(Culling, OfOccludedCellsChangesNoPictureOfGl) {
  const auto scheduler = make_tbb_scheduler(2);
  std::string why;
  const auto renderer = test::renderer_if_possible("gl", *scheduler, why);
  if (!renderer) GTEST_SKIP() << why;
  std::uint64_t saved = 0;
  for (const Flight& flight : flights()) {
    const Drawn all = fly(flight, *renderer, Hidden::drawn, nullptr),
                culled = fly(flight, *renderer, Hidden::cells_left_out, nullptr);
    if (flight.samples == 1) {
      expect_same(all, culled, flight.name);
    } else {
      expect_same_but_for_ties(all, culled, flight.name);
    }
    saved += triangles(all) - triangles(culled);
  }
  EXPECT_GT(saved, 100'000u);
}

TEST(Culling, OfOccludedCellsIsTheSameForAnyNumberOfThreads) {
  const Flight flight = flights()[1];
  const auto serial = make_serial_scheduler();
  CullingRuns runs;
  const Drawn expected = fly(flight, *make_renderer("soft", *serial), Hidden::runs_left_out, nullptr, &runs);
  for (const int threads : {1, 3}) {
    const auto scheduler = make_tbb_scheduler(threads);
    const Drawn drawn = fly(flight, *make_renderer("soft", *scheduler), Hidden::runs_left_out, nullptr, &runs);
    expect_same(expected, drawn, flight.name);
    EXPECT_EQ(triangles(drawn), triangles(expected));
  }
}

TEST(Culling, OfBackFacesChangesNoPicture) {
  const auto scheduler = make_tbb_scheduler(2);
  std::map<Facing, std::uint64_t> saved;
  for (const Flight& flight : flights()) {
    const BackFaces back_faces(*flight.hierarchy, *scheduler);
    const auto renderer = make_renderer("soft", *scheduler);
    const Drawn all = fly(flight, *renderer, Hidden::drawn, nullptr),
                culled = fly(flight, *renderer, Hidden::drawn, &back_faces);
    expect_same(all, culled, flight.name);
    expect_same(all, fly(flight, *renderer, Hidden::cells_left_out, &back_faces), flight.name + ", both");
    saved[back_faces.facing()] += triangles(all) - triangles(culled);
  }
  EXPECT_EQ(saved[Facing::open], 0u);
  EXPECT_GT(saved[Facing::outward], 10'000u);
  EXPECT_GT(saved[Facing::inward], 1'000u);
}

// Effects that show what is behind something see all of it.
TEST(Culling, IsIgnoredWhereHiddenThingsShow) {
  Frame frame;
  EXPECT_FALSE(frame.culls_occluded());
  frame.cull_occluded = true;
  EXPECT_TRUE(frame.culls_occluded());
  frame.effects.insert(Effect::overdraw);
  EXPECT_FALSE(frame.culls_occluded());
  frame.effects = {Effect::shadow};
  EXPECT_TRUE(frame.culls_occluded());
  frame.effects.insert(Effect::transparency);
  EXPECT_FALSE(frame.culls_occluded());
}

}  // namespace
}  // namespace lodestone
