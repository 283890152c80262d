// Meshes with attributes through the quadric kernel: charts and seams against the topology of the mesh cut open along
// them.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "core/simplify/quadric/quadric_simplifier.h"
#include "tests/core/simplify/simplify_checks.h"
#include "tests/core/simplify/simplify_meshes.h"

namespace lodestone {
namespace {

using namespace simplify_test;

// A mesh and its wedges: one for each pair of a vertex and a key that one of its corners has.
struct WedgeMesh {
  TestMesh mesh;
  std::vector<Triangle> corners;
  std::vector<std::uint32_t> wedge_vertex;
  std::vector<std::uint64_t> key;  // of each wedge

  [[nodiscard]] SimplifyInput input(float bound, std::size_t target) {
    SimplifyInput in = mesh.input(bound, target);
    in.corners = corners;
    in.wedge_vertex = wedge_vertex;
    return in;
  }
};

template <class Key>
WedgeMesh with_wedges(TestMesh mesh, Key key_of) {
  WedgeMesh m{std::move(mesh), {}, {}, {}};
  std::map<std::pair<std::uint32_t, std::uint64_t>, std::uint32_t> ids;
  for (std::size_t t = 0; t < m.mesh.triangles.size(); ++t) {
    Triangle corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = m.mesh.triangles[t].v[k];
      const std::uint64_t key = key_of(t, k);
      const auto [at, is_new] = ids.try_emplace({v, key}, static_cast<std::uint32_t>(m.wedge_vertex.size()));
      if (is_new) m.wedge_vertex.push_back(v), m.key.push_back(key);
      corners.v[k] = at->second;
    }
    m.corners.push_back(corners);
  }
  return m;
}

// Charts: the triangles nearest to each of some random points.
WedgeMesh with_charts(TestMesh mesh, std::size_t charts, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Vec3f> centre;
  for (std::size_t i = 0; i < charts; ++i) centre.push_back(mesh.positions[random() % mesh.positions.size()]);
  std::vector<std::uint64_t> chart;
  for (const auto& [v] : mesh.triangles) {
    const Vec3f p = mesh.positions[v[0]] + mesh.positions[v[1]] + mesh.positions[v[2]];
    const auto nearest = std::min_element(
        centre.begin(), centre.end(), [&](Vec3f a, Vec3f b) { return length(3.0f * a - p) < length(3.0f * b - p); });
    chart.push_back(static_cast<std::uint64_t>(nearest - centre.begin()));
  }
  return with_wedges(std::move(mesh), [&](std::size_t t, std::size_t) { return chart[t]; });
}

constexpr std::uint32_t around = 64, across = 32;

// The torus unrolled to a rectangle: one chart whose borders lie upon each other. Key: column and row, unrolled.
WedgeMesh unrolled_torus() {
  return with_wedges(torus(around, across), [](std::size_t t, std::size_t k) {
    const std::uint64_t quad = t / 2, i = quad % around, j = quad / around;
    constexpr std::uint64_t right[2][3]{{0, 1, 1}, {0, 1, 0}}, up[2][3]{{0, 0, 1}, {0, 1, 1}};
    return (i + right[t % 2][k]) << 32 | (j + up[t % 2][k]);
  });
}

// A cut of a few edges in the middle of a plane: seams that end inside the surface.
WedgeMesh slit_plane() {
  constexpr std::uint32_t n = 24;
  TestMesh mesh = plane(n);
  const std::vector<Triangle> triangles = mesh.triangles;
  const std::vector<Vec3f> positions = mesh.positions;
  return with_wedges(std::move(mesh), [=](std::size_t t, std::size_t k) -> std::uint64_t {
    const Vec3f p = positions[triangles[t].v[k]];
    const bool on_slit = p.y == 0.5f && p.x > 0.25f && p.x < 0.75f;
    return on_slit && (t / 2) / n >= n / 2 ? 1 : 0;
  });
}

std::vector<Triangle> wedge_images(const SimplifyInput& input, const SimplifyResult& result) {
  std::vector<Triangle> left;
  for (std::size_t t = 0; t < input.triangles.size(); ++t) {
    const auto &v = input.triangles[t].v, &w = input.corners[t].v;
    if (is_degenerate({{result.parent[v[0]], result.parent[v[1]], result.parent[v[2]]}})) continue;
    left.push_back({{result.wedge_parent[w[0]], result.wedge_parent[w[1]], result.wedge_parent[w[2]]}});
  }
  return left;
}

// The properties of P on wedges: empty, or the first thing that does not.
std::string broken_wedges(const SimplifyInput& input, const SimplifyResult& result) {
  if (result.wedge_parent.size() != input.wedge_vertex.size()) return "sizes differ";
  for (std::uint32_t w = 0; w < result.wedge_parent.size(); ++w) {
    const std::uint32_t p = result.wedge_parent[w];
    if (p >= input.wedge_vertex.size()) return "wedge's parent out of range";
    if (result.wedge_parent[p] != p) return "P is not idempotent at wedge " + std::to_string(w);
    if (input.wedge_vertex[p] != result.parent[input.wedge_vertex[w]])
      return "wedge " + std::to_string(w) + " leaves its vertex";
  }
  const std::vector<Triangle> images = wedge_images(input, result);
  for (const Triangle& t : images)
    if (is_degenerate(t)) return "a triangle is degenerate by wedges alone";
  const Topology before = topology_of({input.corners.begin(), input.corners.end()}), after = topology_of(images);
  if (after.crowded_edges + after.misoriented_edges > before.crowded_edges + before.misoriented_edges)
    return "charts overlap";
  if (after.components != before.components)
    return "charts " + std::to_string(before.components) + " -> " + std::to_string(after.components);
  if (after.euler() != before.euler()) return "Euler characteristic of the charts";
  if (before.pinched_vertices == 0 && after.pinched_vertices > 0) return "a chart is pinched";
  if (before.pinched_vertices == 0 && after.border_loops != before.border_loops) return "border loops of the charts";
  return {};
}

std::vector<std::pair<const char*, WedgeMesh>> cases() {
  std::vector<std::pair<const char*, WedgeMesh>> all;
  all.emplace_back("two charts", with_charts(terrain(40), 2, 1));
  all.emplace_back("many charts", with_charts(bumpy_sphere(5), 40, 2));
  all.emplace_back("tiny charts", with_charts(bumpy_sphere(4), 400, 3));
  all.emplace_back("charts at a border", with_charts(terrain(30), 30, 4));
  all.emplace_back("unrolled torus", unrolled_torus());
  all.emplace_back("slit", slit_plane());
  all.emplace_back("box by sides", with_charts(box(12), 6, 5));
  all.emplace_back("book", with_charts(book(5, 12), 4, 6));
  return all;
}

TEST(Wedges, CasesHaveSeams) {
  for (auto& [name, mesh] : cases()) EXPECT_GT(mesh.wedge_vertex.size(), mesh.mesh.positions.size()) << name;
}

TEST(Wedges, ChartsKeepTheirTopology) {
  const auto simplifier = make_quadric_simplifier();
  for (auto& [name, mesh] : cases()) {
    SCOPED_TRACE(name);
    for (const std::size_t share : {4u, 20u, 1000u}) {
      const SimplifyInput input = mesh.input(0.5f, mesh.mesh.triangles.size() / share);
      const SimplifyResult& result = simplifier->simplify(input);
      EXPECT_EQ(broken_contract(input, result), "");
      EXPECT_EQ(broken_topology(input, result), "");
      EXPECT_EQ(broken_wedges(input, result), "") << share;
    }
  }
}

TEST(Wedges, StayInTheirChart) {
  WedgeMesh mesh = with_charts(bumpy_sphere(5), 12, 7);
  const auto simplifier = make_quadric_simplifier();
  const SimplifyInput input = mesh.input(0.5f, mesh.mesh.triangles.size() / 10);
  const SimplifyResult& result = simplifier->simplify(input);
  for (std::uint32_t w = 0; w < mesh.key.size(); ++w) EXPECT_EQ(mesh.key[result.wedge_parent[w]], mesh.key[w]);
  EXPECT_LE(result.triangles, input.target_triangles) << "seams do not stop it";
}

// Ten charts meet at one vertex: more seams than the kernel follows, so it has to stay.
TEST(Wedges, MeetInAnyNumber) {
  TestMesh mesh;
  constexpr std::uint32_t n = 10;
  mesh.positions.push_back({0, 0, 0});
  for (const float radius : {1.0f, 2.0f, 3.0f})
    for (std::uint32_t k = 0; k < n; ++k) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / n;
      mesh.positions.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    }
  std::vector<std::uint64_t> chart;
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t a = 1 + k, b = 1 + (k + 1) % n;
    mesh.triangles.push_back({{0, a, b}});
    for (const std::uint32_t r : {0u, n}) {
      mesh.triangles.push_back({{a + r, a + r + n, b + r + n}});
      mesh.triangles.push_back({{a + r, b + r + n, b + r}});
    }
    chart.insert(chart.end(), 5, k);
  }
  WedgeMesh m = with_wedges(std::move(mesh), [&](std::size_t t, std::size_t) { return chart[t]; });
  const SimplifyInput input = m.input(10, 0);
  const auto simplifier = make_quadric_simplifier();
  const SimplifyResult& result = simplifier->simplify(input);
  EXPECT_EQ(broken_contract(input, result), "");
  EXPECT_EQ(result.parent[0], 0u);
  for (std::uint32_t w = 0; w < m.key.size(); ++w) EXPECT_EQ(m.key[result.wedge_parent[w]], m.key[w]);
  EXPECT_LT(result.triangles, input.triangles.size());
}

// Surfaces that lie upon each other, fins and folds, in charts that meet there.
TEST(Wedges, StayInTheirChartOnWhatIsNoManifold) {
  const auto simplifier = make_quadric_simplifier();
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    TestMesh mesh = seed % 2 == 0 ? bumpy_sphere(3) : terrain(16);
    const std::size_t sound = mesh.triangles.size();
    std::vector<std::uint64_t> chart(sound);
    for (std::size_t t = 0; t < sound; ++t) chart[t] = t * (1 + seed % 5) / sound;
    for (unsigned i = 0; i < 40; ++i) {
      Triangle t = mesh.triangles[random() % sound];
      if (random() % 2 == 0) std::swap(t.v[0], t.v[1]);
      if (random() % 3 == 0) t.v[random() % 3] = static_cast<std::uint32_t>(random() % mesh.positions.size());
      if (is_degenerate(t)) continue;
      mesh.triangles.push_back(t);
      chart.push_back(random() % 7);
    }
    WedgeMesh m = with_wedges(std::move(mesh), [&](std::size_t t, std::size_t) { return chart[t]; });
    const SimplifyInput input = m.input(1, m.mesh.triangles.size() / 8);
    const SimplifyResult& result = simplifier->simplify(input);
    EXPECT_EQ(broken_contract(input, result), "");
    for (std::size_t t = 0; t < input.corners.size(); ++t)
      for (const std::uint32_t w : input.corners[t].v)
        ASSERT_EQ(m.key[result.wedge_parent[w]], m.key[w]) << "seed " << seed << ", triangle " << t;
  }
}

TEST(Wedges, NoTriangleStretchesOverTheChart) {
  WedgeMesh mesh = unrolled_torus();
  const auto simplifier = make_quadric_simplifier();
  const SimplifyInput input = mesh.input(0.5f, mesh.mesh.triangles.size() / 10);
  const SimplifyResult& result = simplifier->simplify(input);
  const auto column = [&](std::uint32_t w) { return static_cast<int>(mesh.key[w] >> 32); };
  const auto row = [&](std::uint32_t w) { return static_cast<int>(mesh.key[w] & 0xffff'ffff); };
  for (const auto& [w] : wedge_images(input, result))
    for (std::size_t k = 1; k < 3; ++k) {
      EXPECT_LT(std::abs(column(w[k]) - column(w[0])), static_cast<int>(around) / 2);
      EXPECT_LT(std::abs(row(w[k]) - row(w[0])), static_cast<int>(across) / 2);
    }
}

TEST(Wedges, WithoutSeamsTheyChangeNothing) {
  WedgeMesh mesh = with_wedges(bumpy_sphere(5), [](std::size_t, std::size_t) { return 0; });
  const auto simplifier = make_quadric_simplifier();
  const SimplifyResult plain = simplifier->simplify(mesh.mesh.input(0.2f, 2000));
  const SimplifyResult& result = simplifier->simplify(mesh.input(0.2f, 2000));
  EXPECT_EQ(result.parent, plain.parent);
  EXPECT_EQ(result.positions, plain.positions);
}

TEST(Wedges, GiveTheSameBytesOnEveryInstructionSet) {
  const auto plain = make_quadric_simplifier(InstructionSet::plain);
  for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
    if (!is_available(set)) GTEST_SKIP() << "this processor does not have all of them";
    const auto lanes = make_quadric_simplifier(set);
    for (auto& [name, mesh] : cases()) {
      SCOPED_TRACE(name);
      const SimplifyInput input = mesh.input(0.5f, mesh.mesh.triangles.size() / 10);
      const SimplifyResult &a = plain->simplify(input), &b = lanes->simplify(input);
      EXPECT_EQ(a.parent, b.parent);
      EXPECT_EQ(a.positions, b.positions);
      EXPECT_EQ(a.wedge_parent, b.wedge_parent);
    }
  }
}

TEST(Wedges, OfVerticesWithoutTrianglesGoNowhere) {
  WedgeMesh mesh = with_charts(terrain(8), 2, 8);
  mesh.mesh.positions.push_back({2, 2, 2});
  mesh.wedge_vertex.push_back(static_cast<std::uint32_t>(mesh.mesh.positions.size() - 1));
  mesh.wedge_vertex.push_back(mesh.wedge_vertex.back());
  const auto simplifier = make_quadric_simplifier();
  const SimplifyInput input = mesh.input(0.5f, 10);
  const SimplifyResult& result = simplifier->simplify(input);
  const auto last = static_cast<std::uint32_t>(mesh.wedge_vertex.size() - 1);
  EXPECT_EQ(result.wedge_parent[last], last);
  EXPECT_EQ(result.wedge_parent[last - 1], last - 1);
}

// A block whose triangles have all degenerated still has vertices.
TEST(Wedges, OfABlockWithoutTrianglesGoNowhere) {
  WedgeMesh mesh;
  mesh.mesh.positions = {{0, 0, 0}, {1, 0, 0}};
  mesh.wedge_vertex = {0, 0, 1};
  const auto simplifier = make_quadric_simplifier();
  WedgeMesh before = with_charts(terrain(8), 2, 8);  // whose P must not be seen again
  (void)simplifier->simplify(before.input(0.5f, 10));
  const SimplifyResult& result = simplifier->simplify(mesh.input(0.5f, 0));
  EXPECT_EQ(result.wedge_parent, (std::vector<std::uint32_t>{0, 1, 2}));
}

}  // namespace
}  // namespace lodestone
