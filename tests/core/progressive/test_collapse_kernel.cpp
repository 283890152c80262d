// The collapse kernel's parts against what they stand for, one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>

#include "core/base/error.h"
#include "core/progressive/collapse/collapse_kernel.h"
#include "core/progressive/collapse/rank_heap.h"
#include "core/progressive/collapse/star_quadrics.h"
#include "tests/test_meshes.h"

namespace lodestone::progressive {
namespace {

std::vector<const CollapseKernel*> kernels() {
  std::vector<const CollapseKernel*> out{&collapse_kernel(InstructionSet::plain)};
  if (is_available(InstructionSet::avx2)) out.push_back(&collapse_kernel(InstructionSet::avx2));
  return out;
}

// Rough, so that some triangles turn.
IndexedMesh rough_sphere(int detail) {
  IndexedMesh mesh = test::sphere_mesh(detail);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> shift(-0.006f, 0.006f);
  for (Vec3f& p : mesh.positions) p = p + Vec3f{shift(random), shift(random), shift(random)};
  return mesh;
}

TEST(RankHeap, GivesTheLowestFirstAndTiesByNumber) {
  std::mt19937 random(2);
  RankHeap heap;
  std::vector<std::pair<float, Id>> left;
  const auto any = [&] { return std::pair(static_cast<float>(random() % 50) / 7, static_cast<Id>(random() % 1000)); };
  for (int k = 0; k < 300; ++k) {
    left.push_back(any());
    heap.add(left.back().first, left.back().second);
  }
  heap.order_all();
  for (int k = 0; !left.empty(); ++k) {
    if (k < 200 && k % 2 == 0) {
      left.push_back(any());
      heap.push(left.back().first, left.back().second);
    }
    const auto least = std::min_element(left.begin(), left.end());
    ASSERT_EQ(heap.lowest(), least->first);
    ASSERT_EQ(heap.pop(), least->second);
    left.erase(least);
  }
  EXPECT_TRUE(heap.empty());
  EXPECT_EQ(heap.lowest(), std::numeric_limits<float>::infinity());
}

TEST(CollapseKernel, ChainsFansAsOneByOne) {
  std::mt19937 random(4);
  int sound = 0, several = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const auto n = static_cast<std::uint32_t>(1 + random() % 8);
    const bool open = n < 3 || random() % 2 == 0;
    std::vector<std::uint32_t> place(n);
    std::iota(place.begin(), place.end(), 0u);
    std::shuffle(place.begin(), place.end(), random);
    Id start[16]{}, end[16]{};
    for (std::uint32_t k = 0; k < n; ++k) {
      start[place[k]] = 100 + k;
      end[place[k]] = open || k + 1 < n ? 101 + k : 100;
    }
    if (random() % 3 == 0) (random() % 2 == 0 ? start : end)[random() % n] = 100 + static_cast<Id>(random() % (n + 2));
    std::uint8_t expected[32], order[32];
    const Shape shape = chain_fan(start, end, n, expected);
    for (const CollapseKernel* kernel : kernels()) {
      ASSERT_EQ(kernel->chain(start, end, n, order), shape);
      if (shape != Shape::several) {
        ASSERT_TRUE(std::equal(order, order + n, expected));
      }
    }
    ++(shape == Shape::several ? several : sound);
    if (shape == Shape::several) continue;
    // Its claims hold.
    for (std::uint32_t k = 0; k + 1 < n; ++k) ASSERT_EQ(end[expected[k]], start[expected[k + 1]]);
    ASSERT_EQ(end[expected[n - 1]] == start[expected[0]], shape == Shape::closed);
  }
  EXPECT_GT(sound, 10000);
  EXPECT_GT(several, 1000);
}

TEST(CollapseKernel, FirstQuadricsAreSumsOfPlanes) {
  for (const IndexedMesh& mesh : {rough_sphere(4), test::terrain_mesh(20)}) {
    RingMesh rings(mesh);
    RingArena arena;
    rings.list_corners();
    rings.make_rings(0, mesh.positions.size(), arena);
    rings.cut_open();
    std::vector<CentredQuadric> first;
    for (const CollapseKernel* kernel : kernels()) {
      std::vector<CentredQuadric> quadrics(rings.vertex_count());
      kernel->star_quadrics(rings, 0, quadrics.size(), quadrics.data());
      for (Id v = 0; v < quadrics.size(); ++v) {
        const CentredQuadric expected = star_quadric(rings, v);
        const float size = expected.weight;
        ASSERT_NEAR(quadrics[v].weight, expected.weight, 1e-5f * size);
        for (const Vec3f d : {Vec3f{1, 0, 0}, Vec3f{0, 1, 1}, Vec3f{1, -1, 2}})
          ASSERT_NEAR(quadrics[v].at(d), expected.at(d), 1e-4f * size);
        if (!first.empty()) {
          ASSERT_EQ(quadrics[v].xy, first[v].xy);
        }
      }
      first = quadrics;
    }
  }
}

// True if a triangle around v turns by 60 degrees or more; empty if one is close to it.
std::optional<bool> obviously_turns(const RingMesh& rings, Id v, Id u) {
  const Ring& ring = rings.ring(v);
  bool turned = false;
  for (std::uint32_t k = 0; k < ring.sectors(); ++k) {
    const Id a = ring.ids[k], b = ring.ids[ring.next(k)];
    if (a == u || b == u) continue;
    const auto normal = [&](Id x) {
      const Vec3d at = to_double(rings.position(x));
      return cross(to_double(rings.position(a)) - at, to_double(rings.position(b)) - at);
    };
    const Vec3d before = normal(v), after = normal(u);
    const double cosine = dot(before, after) / (length(before) * length(after));
    if (!(std::abs(cosine - 0.5) > 1e-3)) return std::nullopt;
    turned = turned || cosine < 0.5;
  }
  return turned;
}

TEST(CollapseKernel, LanesDecideAsOneByOne) {
  for (const IndexedMesh& mesh : {rough_sphere(4), test::terrain_mesh(20)}) {
    RingMesh rings(mesh);
    RingArena arena;
    rings.list_corners();
    rings.make_rings(0, mesh.positions.size(), arena);
    rings.cut_open();
    int turns = 0, joins_not = 0, done = 0;
    std::mt19937 random(3);
    for (int step = 0; step < 40000; ++step) {
      const auto v = static_cast<Id>(random() % mesh.positions.size());
      const Ring& ring = rings.ring(v);
      if (ring.size < 2 || ring.size > 8) continue;
      const auto at =
          static_cast<std::uint32_t>(ring.open != 0 ? (random() % 2) * (ring.size - 1) : random() % ring.size);
      Collapse c{.vertex = v, .target = ring.ids[at]};
      const bool allowed = rings.allows(c);
      ASSERT_EQ(joins<1>(rings, ring, at), allowed);
      ASSERT_EQ(joins<2>(rings, ring, at), allowed);
      joins_not += allowed ? 0 : 1;
      const Star<1> star = load_star<1>(rings.points(), ring, v);
      const CentredQuadric q = star_quadric(rings, v);
      Float8 ranks[1];
      star_ranks<1>(q, star, ranks);
      const Vec3f shift = rings.position(c.target) - rings.position(v);
      const float rank = std::max(q.at(shift) + stiffness * q.weight * dot(shift, shift), 0.0f) * rank_scale(q.weight);
      ASSERT_EQ(pick(ranks[0], at), rank);
      const auto turned = obviously_turns(rings, v, c.target);
      if (turned) {
        ASSERT_EQ(star_turns<1>(star, ring, at), *turned);
        turns += *turned ? 1 : 0;
      }
      if (!allowed || turned != false || step % 8 != 0) continue;
      (void)rings.apply(c, arena);
      ++done;
    }
    EXPECT_GT(turns, 100);
    EXPECT_GT(joins_not, 10);
    EXPECT_GT(done, 100);
  }
}

// A vertex that nothing allowed to collapse must not collapse, untested, when its region runs again.
TEST(CollapseKernel, CollapsesNothingTwiceRefused) {
  for (const CollapseKernel* kernel : kernels())
    for (const IndexedMesh& mesh : {test::torus_mesh(40, 20), test::torus_mesh(12, 5)}) {
      RingMesh rings(mesh);
      RingArena arena;
      rings.list_corners();
      rings.make_rings(0, mesh.positions.size(), arena);
      rings.cut_open();
      const auto metric = make_quadric_metric(rings, *kernel);
      metric->start(0, rings.vertex_count());
      Collapser collapser(rings, *metric, *kernel);
      collapser.start(0, rings.vertex_count());
      std::vector<Id> all(rings.vertex_count());
      std::iota(all.begin(), all.end(), 0u);
      EXPECT_GT(collapser.run({.vertices = all}, arena).size(), all.size() / 4);
      EXPECT_TRUE(collapser.run({.vertices = all}, arena).empty());
    }
}

TEST(CollapseKernel, RefusesWhatTheProcessorDoesNotHave) {
  if (is_available(InstructionSet::avx2)) GTEST_SKIP() << "AVX2 is here";
  EXPECT_THROW((void)collapse_kernel(InstructionSet::avx2), UnsupportedError);
}

}  // namespace
}  // namespace lodestone::progressive
