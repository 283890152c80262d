// The stages of the software rasterizer one by one, against their definitions.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "render/backends/soft/kernels.h"
#include "render/camera/camera.h"
#include "render/lod/selection.h"
#include "tests/naive_hierarchy.h"
#include "tests/render/own_blends.h"
#include "tests/test_meshes.h"

namespace lodestone::soft {
namespace {

std::uint32_t bits(float v) { return std::bit_cast<std::uint32_t>(v); }

class SoftKernels : public ::testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    if (!is_available(GetParam())) GTEST_SKIP() << "this processor has no AVX2";
    kernels_ = &find_kernels(GetParam());
  }
  const Kernels* kernels_ = nullptr;
};

// Every vertex of the cell by the functions for one vertex, bit for bit.
void expect_same_vertices(const VertexJob& job, const MorphContext& morph, CellId cell) {
  for (std::size_t i = 0; i < job.positions.size(); ++i) {
    Vec3f p = job.positions[i];
    if (job.coarser) {
      ASSERT_EQ(bits(job.lambdas[i]), bits(vertex_lambda(morph, cell, VertexId(i))));
      p = morph_vertex(morph, cell, VertexId(i)).position;
    }
    const ClipVertex clip = to_clip(*job.view_projection, p);
    const WindowVertex& v = job.out[i];
    if (job.viewport->needs_clipping(clip)) {
      ASSERT_EQ(v.inverse_w, 0);
      ASSERT_EQ(static_cast<std::uint32_t>(v.x), job.viewport->outcode(clip));
    } else {
      const WindowVertex expected = job.viewport->snap(clip);
      ASSERT_EQ(v.x, expected.x);
      ASSERT_EQ(v.y, expected.y);
      ASSERT_EQ(bits(v.z), bits(expected.z));
      ASSERT_EQ(bits(v.inverse_w), bits(expected.inverse_w));
    }
  }
}

TEST_P(SoftKernels, VerticesAreThoseOfTheMorph) {
  const test::NaiveHierarchy small = test::naive_hierarchy(test::torus_mesh(40, 20), 3, 0.6f);
  const Hierarchy& h = small.hierarchy;
  const Camera camera{h.transform.origin + h.transform.scale * Vec3d{0.3, 0.1, 0.4},
                      h.transform.origin + h.transform.scale * Vec3d{0.6, 0.6, 0.1}};
  const ImageSize size{333, 211};
  const ViewProjection vp = view_projection(camera, h, size);
  const Viewport viewport(size);
  const std::vector<DetailLimit> some{{{{0.1f, 0.2f, 0}, {0.3f, 0.5f, 0.2f}}, 0.4f}, {{{0.5f, 0, 0}, {1, 1, 1}}, 0.3f}};
  for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev})
    for (const Blend blend : test::blends_and_own())
      for (const auto& [rule, limits] : {std::pair{RadiiRule::per_level, DetailLimits{}},
                                         {RadiiRule::per_level, DetailLimits(some)},
                                         {RadiiRule::uniform, DetailLimits{}},
                                         {RadiiRule::adaptive, DetailLimits(some)}}) {
        RadiiConfig config;
        config.rule = rule;
        config.metric = metric;
        if (rule != RadiiRule::adaptive) config.kappa0 = 0.9f;  // uniform: inadmissible, bands are steps
        config.pixel_error = 20;
        const Radii radii = make_radii(h, config);
        const MorphContext morph{&h, &radii, blend, viewpoint(camera, h.transform), limits};
        for (const Cell& cell : h.cells) {
          const CellId id(&cell - h.cells.data());
          const int level = h.level_of(id);
          std::vector<WindowVertex> out(cell.positions.size());
          std::vector<float> lambdas(cell.positions.size());
          VertexJob job;
          job.positions = cell.positions;
          if (level > 0) {
            job.coarser = h.cells[cell.parent].positions.data();
            job.parents = cell.parents;
          }
          job.viewpoint = morph.viewpoint;
          job.metric = metric;
          job.blend = blend;
          job.band_begin = radii.band_begin[static_cast<std::size_t>(level)];
          job.band_end = radii.band_end[static_cast<std::size_t>(level)];
          job.limits = limits;
          job.view_projection = &vp;
          job.viewport = &viewport;
          job.out = out.data();
          job.lambdas = lambdas.data();
          job.has_lambdas = level > 0 && rule == RadiiRule::adaptive;
          for (VertexId v{0}; job.has_lambdas && v < cell.positions.size(); ++v)
            lambdas[v] = vertex_lambda(morph, id, v);
          kernels_->transform(job);
          ASSERT_NO_FATAL_FAILURE(expect_same_vertices(job, morph, id));
        }
      }
}

// Large triangles that lie in front of, behind and through each other.
std::vector<TriangleRecord> random_records(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> along(-40 * subpixels, 100 * subpixels);
  std::uniform_real_distribution<float> depth(0, 1);
  std::uniform_int_distribution<int> coarse(0, 3);
  std::vector<TriangleRecord> records;
  while (records.size() < 300) {
    TriangleRecord r;
    for (SnappedPoint& p : r.corners) p = {along(random), along(random)};
    const auto& [a, b, c] = r.corners;
    if (std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x) <= 0) continue;
    r.z = {depth(random), depth(random), depth(random)};
    // A third of them parallel to the picture at one of few depths: ties, where the first number wins.
    if (records.size() % 3 == 0) r.z.fill(0.25f * static_cast<float>(coarse(random)));
    r.triangle = static_cast<TriangleNumber>(records.size());
    records.push_back(r);
  }
  return records;
}

constexpr PixelRect tile_rect{0, 0, tile_size, tile_size};

template <int Samples>
void expect_minimum(const Kernels& kernels) {
  std::vector<TriangleRecord> records = random_records(7);
  // The twin: each triangle in a tile of its own, and the nearest of them all by hand.
  std::vector<float> depth(TileBuffer<Samples>::samples, 1.0f);
  std::vector<TriangleNumber> nearest(depth.size());
  const auto tile = std::make_unique<TileBuffer<Samples>>();
  for (const TriangleRecord& r : records) {
    tile->clear();
    kernels.of<Samples>().draw_triangles(&r, &r + 1, tile_rect, *tile);
    for (std::size_t i = 0; i < depth.size(); ++i)
      if (tile->depth[i] < depth[i]) {
        depth[i] = tile->depth[i];
        nearest[i] = r.triangle;
      }
  }
  // Together, in runs and in any order, with what is hidden left out early.
  std::mt19937 random(8);
  for (int round = 0; round < 4; ++round) {
    tile->clear();
    constexpr std::size_t run = 60;
    static_assert(run <= Bins<TriangleRecord>::run_items);
    for (std::size_t k = 0; k < records.size(); k += run)
      kernels.of<Samples>().draw_triangles(&records[k], &records[k] + run, tile_rect, *tile);
    for (std::size_t i = 0; i < depth.size(); ++i) {
      ASSERT_EQ(bits(tile->depth[i]), bits(depth[i])) << i;
      if (depth[i] < 1) {
        ASSERT_EQ(tile->sources.triangle(tile->reference[i]), nearest[i]) << i;
      }
    }
    std::ranges::shuffle(records, random);
  }
}

TEST_P(SoftKernels, TheNearestTriangleWinsInAnyOrder) {
  expect_minimum<1>(*kernels_);
  expect_minimum<4>(*kernels_);
}

TEST(TileBuffer, OfEquallyNearFragmentsTheFirstTriangleWins) {
  std::vector<Fragment> fragments;
  for (const TriangleNumber number : {7u, 3u, 9u}) fragments.push_back({5, 0.5f, number, {}, 0, 0});
  fragments.push_back({5, 0.75f, 1, {}, 0, 0});
  const auto tile = std::make_unique<TileBuffer<1>>();
  do {
    tile->clear();
    EXPECT_TRUE(tile->empty());
    tile->draw_fragments(fragments.data(), fragments.data() + fragments.size());
    EXPECT_EQ(tile->sources.triangle(tile->reference[5]), 3u);
    EXPECT_EQ(tile->depth[5], 0.5f);
    EXPECT_EQ(tile->depth[4], 1);
  } while (std::ranges::next_permutation(fragments, {}, &Fragment::triangle).found);
}

TEST(Bins, ListsKeepWhatTheyAreGiven) {
  Bins<Fragment> bins;
  for (int round = 0; round < 3; ++round) {
    bins.reset(4);
    for (std::uint32_t i = 0; i < 1000; ++i) bins.push(i % 3, {i, 0, i, {}, 0, 0});
    for (std::size_t list = 0; list < 4; ++list) {
      std::vector<std::uint32_t> found;
      bins.for_each_run(list, [&](const Fragment* first, const Fragment* last) {
        EXPECT_LE(last - first, static_cast<std::ptrdiff_t>(Bins<Fragment>::run_items));
        for (; first != last; ++first) found.push_back(first->sample);
      });
      std::ranges::sort(found);
      ASSERT_EQ(found.size(), list == 3 ? 0u : (1002 - list) / 3);
      for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], 3 * i + list);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, SoftKernels, ::testing::Values(InstructionSet::plain, InstructionSet::avx2),
                         [](const auto& instance) {
                           return std::string(instance.param == InstructionSet::avx2 ? "avx2" : "plain");
                         });

}  // namespace
}  // namespace lodestone::soft
