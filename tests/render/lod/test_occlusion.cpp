// Occlusion culling: what is called hidden cannot be seen, by brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "render/backends/make_renderer.h"
#include "render/backends/soft/viewport.h"
#include "render/camera/camera.h"
#include "render/culling/occlusion.h"
#include "render/culling/runs.h"
#include "tests/naive_hierarchy.h"
#include "tests/render/conformance.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

using test::NaiveHierarchy;

const Hierarchy& torus() {
  static const NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(96, 48), 3, 0.5f);
  return small.hierarchy;
}

Camera random_camera(std::mt19937& random, const Hierarchy& h, double lo, double hi) {
  const auto number = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto point = [&](double a, double b) { return Vec3d{number(a, b), number(a, b), number(a, b)}; };
  const auto to_model = [&](Vec3d p) { return h.transform.origin + h.transform.scale * p; };
  return {to_model(point(lo, hi)), to_model(point(0.2, 0.8)), {0, 0, 1}, number(0.05, 1.8)};
}

TEST(DepthPyramid, ScreenBoxesHoldWhateverIsDrawnOfTheBox) {
  std::mt19937 random(1);
  const auto number = [&](float a, float b) { return std::uniform_real_distribution<float>(a, b)(random); };
  const ImageSize size{317, 203};
  std::size_t boxes = 0, inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const ViewProjection vp = view_projection(random_camera(random, torus(), -0.4, 1.4), torus(), size);
    Box3f box;
    const float side = number(0, 1) < 0.5f ? 0.3f : 1e-3f;
    box.lo = {number(0, 1), number(0, 1), number(0, 1)};
    box.hi = {box.lo.x + number(0, side), box.lo.y + number(0, side), box.lo.z + number(0, side)};
    const auto on_screen = screen_box(vp, box, size);
    if (!on_screen) continue;
    ++boxes;
    const soft::Viewport viewport(size);
    for (int k = 0; k < 40; ++k) {
      const auto along = [&](float lo, float hi) { return k < 8 ? (number(0, 1) < 0.5f ? lo : hi) : number(lo, hi); };
      const soft::ClipVertex clip =
          soft::to_clip(vp, {along(box.lo.x, box.hi.x), along(box.lo.y, box.hi.y), along(box.lo.z, box.hi.z)});
      ASSERT_GT(clip.w, 0);
      if (viewport.needs_clipping(clip)) continue;
      const soft::WindowVertex v = viewport.snap(clip);
      EXPECT_GE(v.z, on_screen->nearest);
      const int x = v.x >> soft::subpixel_bits, y = v.y >> soft::subpixel_bits;
      if (x < 0 || y < 0 || x >= size.width || y >= size.height) continue;
      ++inside;
      EXPECT_TRUE(x >= on_screen->x0 && x <= on_screen->x1 && y >= on_screen->y0 && y <= on_screen->y1)
          << x << ' ' << y;
    }
  }
  EXPECT_GT(boxes, 1000u);
  EXPECT_GT(inside, 10'000u);
}

TEST(DepthPyramid, ABoxThatReachesBehindTheNearPlaneHasNoPlace) {
  const Hierarchy& h = torus();
  const Camera camera{h.transform.to_model({0.5f, 0.5f, 0.5f}), h.transform.to_model({0.9f, 0.5f, 0.5f})};
  const ViewProjection vp = view_projection(camera, h, {64, 64});
  EXPECT_FALSE(screen_box(vp, {{0.4f, 0.4f, 0.4f}, {0.8f, 0.6f, 0.6f}}, {64, 64}));
  EXPECT_FALSE(screen_box(vp, {{0.1f, 0.4f, 0.4f}, {0.2f, 0.6f, 0.6f}}, {64, 64}));
  EXPECT_TRUE(screen_box(vp, {{0.7f, 0.4f, 0.4f}, {0.8f, 0.6f, 0.6f}}, {64, 64}));
}

TEST(DepthPyramid, HidesWhatEveryBlockHides) {
  std::mt19937 random(2);
  const auto whole = [&](int a, int b) { return std::uniform_int_distribution<int>(a, b)(random); };
  DepthPyramid pyramid;
  std::size_t hidden = 0, seen = 0;
  for (int i = 0; i < 400; ++i) {
    const ImageSize size{whole(1, 300), whole(1, 200)};
    pyramid.reset(size);
    ASSERT_EQ(pyramid.columns(), (size.width + 7) / 8);
    ASSERT_EQ(pyramid.rows(), (size.height + 7) / 8);
    for (float& far : pyramid.blocks()) far = whole(0, 20) ? 0.1f * static_cast<float>(whole(1, 5)) : 1.0f;
    pyramid.build();
    for (int k = 0; k < 50; ++k) {
      ScreenBox box;
      box.x0 = whole(0, size.width - 1), box.x1 = std::min(box.x0 + whole(-1, 60), size.width - 1);
      box.y0 = whole(0, size.height - 1), box.y1 = std::min(box.y0 + whole(-1, 60), size.height - 1);
      box.nearest = 0.1f * static_cast<float>(whole(1, 6));
      bool expected = true;
      for (int y = box.y0; y <= box.y1; ++y)
        for (int x = box.x0; x <= box.x1; ++x)
          expected =
              expected && pyramid.blocks()[static_cast<std::size_t>(y / 8 * pyramid.columns() + x / 8)] < box.nearest;
      EXPECT_EQ(pyramid.hides(box), expected);
      ++(expected ? hidden : seen);
    }
  }
  EXPECT_GT(hidden, 1000u);
  EXPECT_GT(seen, 1000u);
}

TEST(DepthPyramid, AnEmptyPictureHidesNothingInIt) {
  DepthPyramid pyramid;
  pyramid.reset({100, 50});
  EXPECT_FALSE(pyramid.hides({0, 0, 99, 49, 1}));
  EXPECT_FALSE(pyramid.hides({50, 20, 50, 20, 0.999f}));
  EXPECT_TRUE(pyramid.hides({50, 20, 49, 20, 0.5f})) << "nothing of it is in the picture";
}

// Each block is as far as the farthest of its pixels, also where the picture ends within it.
TEST(DepthPyramid, BlocksOfAPicture) {
  const ImageSize size{19, 9};
  std::vector<float> depth(static_cast<std::size_t>(size.width * size.height), 0.25f);
  depth[18] = 0.5f;
  depth[static_cast<std::size_t>(8 * size.width)] = 0.75f;
  DepthPyramid pyramid;
  pyramid.reset(size);
  fill_blocks(depth, size, pyramid);
  pyramid.build();
  EXPECT_TRUE(pyramid.hides({0, 0, 15, 7, 0.3f}));
  EXPECT_FALSE(pyramid.hides({0, 0, 16, 7, 0.3f}));
  EXPECT_FALSE(pyramid.hides({0, 0, 15, 8, 0.6f}));
  EXPECT_TRUE(pyramid.hides({0, 0, 18, 8, 0.8f}));
}

// Without the cells that the finished picture hides it is drawn the same, bit for bit.
TEST(Occlusion, WithoutHiddenCellsThePictureIsTheSame) {
  const auto scheduler = make_tbb_scheduler(2);
  std::mt19937 random(3);
  const Hierarchy& h = torus();
  const auto renderer = make_renderer("soft", *scheduler);
  renderer->upload(h);
  std::size_t hidden = 0;
  for (int i = 0; i < 240; ++i) {
    const Camera camera = random_camera(random, h, -0.3, 1.3);
    RadiiConfig config;
    config.kappa0 = std::uniform_real_distribution<float>(0.3f, 4)(random);
    const Radii radii = make_radii(h, config);
    const ImageSize size{160, 120};
    const ViewProjection vp = view_projection(camera, h, size);
    const Frustum frustum = frustum_of(vp);
    Selection selection;
    select_cells(h, radii, viewpoint(camera, h.transform), {&frustum, false}, selection);
    const auto draw = [&] {
      Frame frame;
      frame.only().morph = {&h, &radii, Blend::smoothstep, viewpoint(camera, h.transform)};
      frame.only().view_projection = vp;
      frame.size = size;
      frame.only().selection = &selection;
      renderer->draw(frame);
      return renderer->read_back();
    };
    const Image all = draw();
    DepthPyramid pyramid;
    pyramid.reset(size);
    fill_blocks(all.depth, size, pyramid);
    pyramid.build();
    const std::size_t before = selection.cells.size();
    std::erase_if(selection.cells,
                  [&](const SelectedCell& c) { return is_hidden(pyramid, h, c.cell, c.level, vp, size); });
    hidden += before - selection.cells.size();
    const Image rest = draw();
    EXPECT_TRUE(rest.rgba == all.rgba) << "view " << i;
    EXPECT_TRUE(rest.depth == all.depth) << "view " << i;
  }
  EXPECT_GT(hidden, 500u);
}

// The same of runs of the cells that are seen.
TEST(Occlusion, WithoutHiddenRunsThePictureIsTheSame) {
  const auto scheduler = make_tbb_scheduler(2);
  std::mt19937 random(4);
  const std::shared_ptr<const Hierarchy> model = test::detail::built(Shape::sphere, 60'000);
  const Hierarchy& h = *model;
  const auto renderer = make_renderer("soft", *scheduler);
  renderer->upload(h);
  CullingRuns runs;
  std::size_t hidden = 0, of_seen_cells = 0;
  for (int i = 0; i < 60; ++i) {
    const Camera camera = random_camera(random, h, -0.3, 1.3);
    RadiiConfig config;
    config.kappa0 = std::uniform_real_distribution<float>(0.3f, 2)(random);
    const Radii radii = make_radii(h, config);
    const ImageSize size{160, 120};
    Frame frame;
    ModelFrame& drawn = frame.only();
    drawn.morph = {&h, &radii, Blend::smoothstep, viewpoint(camera, h.transform)};
    drawn.view_projection = view_projection(camera, h, size);
    frame.size = size;
    const Frustum frustum = frustum_of(drawn.view_projection);
    Selection selection;
    select_cells(h, radii, drawn.morph.viewpoint, {&frustum, false}, selection);
    drawn.selection = &selection;
    renderer->draw(frame);
    const Image all = renderer->read_back();
    DepthPyramid pyramid;
    pyramid.reset(size);
    fill_blocks(all.depth, size, pyramid);
    pyramid.build();
    std::vector<std::vector<TriangleRange>> kept(selection.cells.size());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      SelectedCell& cell = selection.cells[k];
      const auto end = static_cast<std::uint32_t>(h.cells[cell.cell].triangles.size());
      const bool seen = !is_hidden(pyramid, h, cell.cell, cell.level, drawn.view_projection, size);
      std::uint32_t begin = 0;
      for (const Box3f& box : runs.boxes(h, cell.cell)) {
        const auto place = screen_box(drawn.view_projection, box, size);
        const std::uint32_t run_end = std::min(begin + CullingRuns::length, end);
        if (place && pyramid.hides(*place)) {
          ++hidden;
          of_seen_cells += seen ? 1 : 0;
        } else {
          kept[k].push_back({begin, run_end});
        }
        begin = run_end;
      }
      if (kept[k].empty()) kept[k].push_back({});
      cell.ranges = kept[k];
    }
    renderer->draw(frame);
    const Image rest = renderer->read_back();
    EXPECT_TRUE(rest.rgba == all.rgba) << "view " << i;
    EXPECT_TRUE(rest.depth == all.depth) << "view " << i;
  }
  EXPECT_GT(hidden, 1000u);
  EXPECT_GT(of_seen_cells, 300u);
}

// A frame as backends hand it to OcclusionCulling.
struct ViewOfParts {
  Radii radii;
  Selection selection;
  std::vector<TriangleRange> ranges;
  Frame frame;
  std::vector<VisiblePart> parts;

  ViewOfParts(const Hierarchy& h, const Camera& camera, CullingRuns& runs) {
    RadiiConfig config;
    config.kappa0 = 0.5f;
    radii = make_radii(h, config);
    frame.size = {160, 120};
    ModelFrame& model = frame.only();
    model.morph = {&h, &radii, Blend::smoothstep, viewpoint(camera, h.transform)};
    model.view_projection = view_projection(camera, h, frame.size);
    model.runs = &runs;
    const Frustum frustum = frustum_of(model.view_projection);
    select_cells(h, radii, model.morph.viewpoint, {&frustum, false}, selection);
    runs.cull(h, model.view_projection, frame.size, selection, ranges);
    for (std::uint32_t k = 0; k < selection.cells.size(); ++k) {
      const SelectedCell& cell = selection.cells[k];
      parts.push_back({0, k, cell.cell, cell.level, cell.ranges});
    }
  }
  ViewOfParts(const ViewOfParts&) = delete;
  ViewOfParts& operator=(const ViewOfParts&) = delete;
};

// Any depth will do: blocks in columns that hide everything, and others that hide nothing.
void fill_columns(DepthPyramid& pyramid, std::size_t first) {
  const std::span<float> blocks = pyramid.blocks();
  for (std::size_t k = 0; k < blocks.size(); ++k) blocks[k] = k / 5 % 2 == first ? 0.0f : 1.0f;
}

// Every triangle of the visible cells is drawn in one of the passes or hidden, and in no more than one.
TEST(Occlusion, DividesTheVisibleTriangles) {
  const std::shared_ptr<const Hierarchy> model = test::detail::built(Shape::sphere, 60'000);
  const Hierarchy& h = *model;
  CullingRuns runs;
  OcclusionCulling culling;
  std::size_t divided = 0;
  for (const Camera& camera : fly_in_path(h, 60)) {
    const ViewOfParts visible(h, camera, runs);
    std::vector<std::vector<int>> times(visible.parts.size());
    const auto add = [&](std::span<const VisiblePart> parts, int n) {
      std::size_t sum = 0;
      for (const VisiblePart& part : parts)
        for_each_range(h.cells[part.cell], part.ranges, [&](TriangleRange range) {
          sum += range.end - range.begin;
          times[part.number].resize(h.cells[part.cell].triangles.size());
          for (std::uint32_t t = range.begin; t < range.end; ++t) times[part.number][t] += n;
        });
      return sum;
    };
    const std::size_t in_first = add(culling.first(visible.frame, visible.parts), 1);
    fill_columns(culling.pyramid(), 0);
    const std::size_t in_second = add(culling.second(), 1);
    fill_columns(culling.pyramid(), 0);
    culling.finish();
    divided += culling.divided_cells();
    EXPECT_EQ(in_first + in_second + culling.hidden_triangles(), add(visible.parts, -1));
    for (const std::vector<int>& of_cell : times)
      for (const int n : of_cell) ASSERT_TRUE(n == 0 || n == -1) << "drawn twice, or out of the picture";
  }
  EXPECT_GT(divided, 0u);
}

TEST(Occlusion, RunsWaitAsLongAsFewComeIntoSight) {
  const std::shared_ptr<const Hierarchy> model = test::detail::built(Shape::sphere, 60'000);
  CullingRuns runs;
  OcclusionCulling culling;
  const ViewOfParts visible(*model, fly_in_path(*model, 12)[6], runs);
  // Draws a frame; how many of the cells drawn first lack triangles that wait.
  const auto incomplete = [&](std::size_t first_column) {
    std::size_t count = 0;
    for (const VisiblePart& part : culling.first(visible.frame, visible.parts)) {
      const Cell& cell = model->cells[part.cell];
      if (drawn_triangles(cell, part.ranges) < drawn_triangles(cell, visible.parts[part.number].ranges)) ++count;
    }
    fill_columns(culling.pyramid(), first_column);
    (void)culling.second();
    fill_columns(culling.pyramid(), first_column);
    culling.finish();
    return count;
  };
  EXPECT_EQ(incomplete(0), 0u) << "nothing is known yet";
  EXPECT_GT(incomplete(1), 0u);
  EXPECT_EQ(incomplete(1), 0u) << "all that waited has come into sight";
  EXPECT_GT(incomplete(1), 0u) << "none has since";
}

TEST(HiddenCells, KnowTheirRuns) {
  HiddenCells hidden;
  hidden.reset(2);
  hidden.next_frame();
  EXPECT_FALSE(hidden.was_run_hidden(CellId(1), 3)) << "before the first frame";
  hidden.note_run(CellId(1), 3);
  EXPECT_FALSE(hidden.was_run_hidden(CellId(1), 3)) << "of this frame";
  hidden.next_frame();
  EXPECT_TRUE(hidden.was_run_hidden(CellId(1), 3));
  EXPECT_FALSE(hidden.was_run_hidden(CellId(1), 2));
  EXPECT_FALSE(hidden.was_run_hidden(CellId(1), 4));
  EXPECT_FALSE(hidden.was_run_hidden(CellId(0), 3));
  hidden.next_frame();
  EXPECT_FALSE(hidden.was_run_hidden(CellId(1), 3)) << "a frame later";
}

TEST(HiddenCells, FollowTheLevels) {
  const Hierarchy& h = torus();
  HiddenCells hidden;
  hidden.reset(h.cells.size());
  const Cell& root = h.cells[0];
  ASSERT_GT(root.child_count, 1u);
  hidden.next_frame();
  for (CellId c{0}; c < h.cells.size(); ++c) EXPECT_FALSE(hidden.were_there(h, c)) << "before the first frame";
  hidden.note(root.first_child);
  hidden.next_frame();
  EXPECT_TRUE(hidden.were_there(h, root.first_child));
  EXPECT_FALSE(hidden.were_there(h, CellId(root.first_child + 1)));
  const Cell& below = h.cells[root.first_child];
  for (CellId k = below.first_child; k < below.end_child(); ++k)
    EXPECT_TRUE(hidden.were_there(h, k)) << "refined in its place";
  EXPECT_FALSE(hidden.were_there(h, CellId(0))) << "only one of those below it was hidden";
  for (CellId k = root.first_child; k < root.end_child(); ++k) hidden.note(k);
  hidden.next_frame();
  EXPECT_TRUE(hidden.were_there(h, CellId(0)));
  hidden.next_frame();
  for (CellId c{0}; c < h.cells.size(); ++c) EXPECT_FALSE(hidden.were_there(h, c)) << "a frame later";
}

}  // namespace
}  // namespace lodestone
