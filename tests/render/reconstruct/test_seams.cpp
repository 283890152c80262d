// The parts of merging: borders, zipping, filling, each against a slow twin or a closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "core/mesh/raw_mesh.h"
#include "render/reconstruct/finish/label_parts.h"
#include "render/reconstruct/seams/seam_mesh.h"
#include "tests/test_meshes.h"

namespace lodestone::test {
namespace {

constexpr TriangleId none = EditMesh::none;

IndexedMesh mesh_of(std::vector<Triangle> triangles, std::size_t vertices) {
  IndexedMesh mesh;
  mesh.positions.resize(vertices);
  mesh.triangles = std::move(triangles);
  return mesh;
}

std::vector<Triangle> triangles_of(const EditMesh& mesh) {
  std::vector<Triangle> triangles;
  for (TriangleId t{0}; t < mesh.triangle_count(); ++t)
    if (mesh.alive(t)) triangles.push_back(mesh.triangle(t));
  return triangles;
}

Vec3f area_vector(const SeamMesh& seam, const Triangle& t) {
  return lodestone::area_vector(seam, VertexId(t.v[0]), VertexId(t.v[1]), VertexId(t.v[2]));
}

TEST(CountHandles, OfKnownSurfaces) {
  EXPECT_EQ(count_handles(sphere_mesh(2)), 0u);
  EXPECT_EQ(count_handles(terrain_mesh(5)), 0u);
  IndexedMesh torus = torus_mesh(12, 8);
  EXPECT_EQ(count_handles(torus), 1u);
  torus.triangles.pop_back();  // a hole is not a handle
  EXPECT_EQ(count_handles(torus), 1u);
  IndexedMesh two = torus_mesh(12, 8);  // that touch in a vertex
  const auto count = static_cast<std::uint32_t>(two.positions.size());
  for (Triangle t : std::vector<Triangle>(two.triangles)) {
    for (std::uint32_t& v : t.v) v = v == 0 ? 0 : v + count;
    two.triangles.push_back(t);
  }
  two.positions.resize(2 * count);
  EXPECT_EQ(count_handles(two), 2u);
  EXPECT_EQ(count_handles(mesh_of({}, 0)), 0u);
  EXPECT_EQ(count_handles(mesh_of({{{0, 1, 2}}, {{0, 1, 3}}}, 4)), std::nullopt);               // facing both ways
  EXPECT_EQ(count_handles(mesh_of({{{0, 1, 2}}, {{1, 0, 3}}, {{1, 0, 4}}}, 5)), std::nullopt);  // three at an edge
}

TEST(EditMesh, FindsWhatASetOfTrianglesHolds) {
  std::mt19937 random(3);
  EditMesh mesh(9, {{{0, 1, 2}}, {{2, 1, 3}}});
  std::map<TriangleId, Triangle> twin{{TriangleId(0), {{0, 1, 2}}}, {TriangleId(1), {{2, 1, 3}}}};
  const auto at = [&](VertexId a, VertexId b) {
    for (const auto& [t, triangle] : twin)
      for (std::size_t k = 0; k < 3; ++k)
        if (triangle.v[k] == a && triangle.v[(k + 1) % 3] == b) return t;
    return none;
  };
  const auto any = [&] { return VertexId(random() % mesh.vertex_count()); };
  for (int step = 0; step < 4000; ++step) {
    const VertexId a = any(), b = any(), c = any();
    if (step % 3 == 0) {
      const TriangleId t = mesh.at(a, b);
      ASSERT_EQ(t, at(a, b));
      if (t == none) continue;
      mesh.remove(t);
      twin.erase(t);
    } else if (step % 50 == 1 && mesh.vertex_count() < 30) {
      const VertexId own = mesh.add_vertex();
      if (mesh.around(a).empty()) continue;
      const TriangleId t = mesh.around(a).front();
      mesh.move_corner(t, a, own);
      for (std::uint32_t& v : twin[t].v)
        if (v == a) v = own;
    } else {
      const bool fits = a != b && b != c && c != a && at(a, b) == none && at(b, c) == none && at(c, a) == none;
      const TriangleId t = mesh.add(a, b, c);
      ASSERT_EQ(t != none, fits);
      if (fits) twin[t] = {{a, b, c}};
    }
    for (VertexId v{0}; v < mesh.vertex_count(); ++v) {
      std::set<TriangleId> expected;
      for (const auto& [t, triangle] : twin)
        if (std::find(triangle.v.begin(), triangle.v.end(), v) != triangle.v.end()) expected.insert(t);
      const auto around = mesh.around(v);
      ASSERT_EQ(std::set<TriangleId>(around.begin(), around.end()), expected);
    }
  }
}

// Border edges as the mesh has them.
BorderLoops borders_of(const EditMesh& mesh, std::span<const std::uint32_t> piece_of_triangle, std::size_t pieces) {
  BorderLoops borders(mesh.vertex_count());
  std::vector<std::uint32_t> piece;
  std::vector<std::pair<VertexId, VertexId>> edges;
  for (TriangleId t{0}; t < mesh.triangle_count(); ++t)
    for (std::size_t k = 0; mesh.alive(t) && k < 3; ++k) {
      const VertexId a = mesh.corners(t)[k], b = mesh.corners(t)[(k + 1) % 3];
      if (!mesh.is_border(a, b)) continue;
      borders.add_edge(a, b);
      piece.push_back(piece_of_triangle.empty() ? 0 : piece_of_triangle[t]);
      edges.emplace_back(a, b);
    }
  for (BorderEdgeId e{0}; e < edges.size(); ++e)
    borders.link(e, borders.find(edges[e].second, mesh.next_on_border(edges[e].first, edges[e].second)));
  borders.label(piece, pieces);
  return borders;
}

void expect_borders_of(const BorderLoops& borders, const EditMesh& mesh) {
  std::map<std::uint32_t, BorderEdgeId> seed_of_loop;
  for (BorderEdgeId e{0}; e < borders.edge_count(); ++e) {
    if (!borders.alive(e)) continue;
    const BorderLoops::Edge& edge = borders.edge(e);
    ASSERT_TRUE(mesh.is_border(edge.from, edge.to));
    ASSERT_EQ(borders.edge(edge.next).from, edge.to);
    ASSERT_EQ(borders.edge(edge.next).to, mesh.next_on_border(edge.from, edge.to));
    ASSERT_EQ(borders.edge(edge.next).previous, e);
    ASSERT_EQ(borders.edge(edge.next).loop, edge.loop);
    seed_of_loop.try_emplace(edge.loop, e);
  }
  // Two loops are two cycles: all edges of a label are met from one of them.
  std::map<std::uint32_t, std::size_t> size, met;
  for (BorderEdgeId e{0}; e < borders.edge_count(); ++e)
    if (borders.alive(e)) ++size[borders.edge(e).loop];
  for (const auto& [loop, seed] : seed_of_loop) {
    BorderEdgeId e = seed;
    do ++met[loop], e = borders.edge(e).next;
    while (e != seed);
  }
  ASSERT_EQ(size, met);
  // The vertices in which several fans meet are known, closed or not.
  const std::vector<VertexId> pinched = borders.pinched();
  for (VertexId v{0}; v < mesh.vertex_count(); ++v) {
    if (mesh.around(v).empty()) continue;
    std::set<TriangleId> fan{mesh.around(v).front()};
    for (std::size_t before = 0; before < fan.size();) {
      before = fan.size();
      for (const TriangleId t : std::set<TriangleId>(fan))
        for (const VertexId w : mesh.corners(t)) {
          if (w == v) continue;
          if (const TriangleId u = mesh.at(v, w); u != none) fan.insert(u);
          if (const TriangleId u = mesh.at(w, v); u != none) fan.insert(u);
        }
    }
    ASSERT_TRUE(fan.size() == mesh.around(v).size() || std::binary_search(pinched.begin(), pinched.end(), v));
  }
  std::size_t border = 0;
  for (const Triangle& t : triangles_of(mesh))
    for (std::size_t k = 0; k < 3; ++k) border += mesh.is_border(VertexId(t.v[k]), VertexId(t.v[(k + 1) % 3]));
  std::size_t held = 0;
  for (const auto& [loop, edges] : size) held += edges;
  ASSERT_EQ(border, held);
}

TEST(BorderLoops, CountTheHandlesThatEulersFormulaGives) {
  std::mt19937 random(11);
  for (int round = 0; round < 40; ++round) {
    const std::uint32_t pieces = 2 + static_cast<std::uint32_t>(round) % 6;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> piece;
    for (std::uint32_t k = 0; k < pieces; ++k) triangles.push_back({{3 * k, 3 * k + 1, 3 * k + 2}}), piece.push_back(k);
    EditMesh mesh(3 * pieces, triangles);
    BorderLoops borders = borders_of(mesh, piece, pieces);
    std::size_t predicted = 0;
    for (int step = 0; step < 400; ++step) {
      const BorderEdgeId e(random() % borders.edge_count());
      const VertexId c(random() % mesh.vertex_count());
      if (!borders.alive(e) || borders.first(c) == BorderLoops::none) continue;
      const auto [a, b] = std::pair(borders.edge(e).from, borders.edge(e).to);
      if (c == a || c == b || mesh.at(a, c) != none || mesh.at(c, b) != none) continue;
      const bool handle = borders.makes_handle(e, c);
      if (round % 2 == 0 && handle) continue;
      predicted += handle;
      ASSERT_NE(mesh.add(b, a, c), none);
      borders.add_triangle(e, c);
      expect_borders_of(borders, mesh);
      ASSERT_EQ(borders.handles(), count_handles(mesh_of(triangles_of(mesh), mesh.vertex_count())));
      ASSERT_LE(borders.handles(), predicted);
    }
    if (round % 2 == 0) {
      EXPECT_EQ(borders.handles(), 0u);
    }
  }
}

// A seam mesh of triangles that are all there is.
SeamMesh seam_of(const std::vector<Vec3f>& positions, const std::vector<Vec3f>& normals,
                 const std::vector<Triangle>& triangles, std::span<const std::uint32_t> piece, std::size_t pieces) {
  SeamMesh seam;
  seam.position = positions, seam.normal = normals;
  seam.frozen.resize(positions.size()), seam.rim.resize(positions.size()), seam.part.resize(positions.size());
  seam.mesh = EditMesh(positions.size(), triangles);
  seam.borders = borders_of(seam.mesh, piece, pieces);
  seam.patch_seed.assign(pieces, none);
  for (TriangleId t{0}; t < triangles.size(); ++t) seam.patch_seed[piece.empty() ? 0 : piece[t]] = t;
  return seam;
}

// Two ribbons of n squares beside each other, a spacing of 1 apart; within a straight outline places a little at
// random.
SeamMesh two_ribbons(std::uint32_t n) {
  std::mt19937 random(17);
  std::uniform_real_distribution<float> jitter(-0.15f, 0.15f);
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> piece;
  for (std::uint32_t row = 0; row < 4; ++row)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const bool outline = row == 0 || row == 3 || i == 0 || i == n;
      const Vec3f aside = outline ? Vec3f{} : Vec3f{jitter(random), jitter(random), 0};
      positions.push_back(Vec3f{static_cast<float>(i), static_cast<float>(row), 0} + aside);
    }
  for (const std::uint32_t row : {0u, 2u})
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = row * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      triangles.insert(triangles.end(), {{{a, b, d}}, {{a, d, c}}});
      piece.insert(piece.end(), 2, row / 2);
    }
  return seam_of(positions, std::vector<Vec3f>(positions.size(), Vec3f{0, 0, 1}), triangles, piece, 2);
}

TEST(ZipSeams, ClosesAGapWhateverTheTilesAndThreads) {
  constexpr std::uint32_t n = 300;
  for (const float tile : {10.5f, 48.0f, 1000.0f}) {
    std::vector<Triangle> first;
    for (const int threads : {1, 2, 3, 7}) {
      const auto scheduler = threads == 1 ? make_serial_scheduler() : make_tbb_scheduler(threads);
      SeamMesh seam = two_ribbons(n);
      EXPECT_EQ(zip_seams(seam, {.spacing = 1, .rims = true, .tile = tile, .most_handles = 0}, *scheduler), 2 * n);
      const std::vector<Triangle> triangles = triangles_of(seam.mesh);
      if (threads == 1) first = triangles;
      EXPECT_EQ(triangles, first);
      expect_borders_of(seam.borders, seam.mesh);
      for (const Triangle& t : triangles) EXPECT_GT(area_vector(seam, t).z, 0);
    }
  }
}

std::vector<BorderPoint> border_along_row(std::uint32_t row, Vec3f outward) {
  std::vector<BorderPoint> border;
  for (std::uint32_t i = 0; i <= 20; ++i)
    border.push_back({{static_cast<float>(i), static_cast<float>(row), 0}, outward});
  return border;
}

// All vertices are within reach of a border. Where the gap is the model's, nothing spans it; where the surface ends
// beside the ribbons and not between them, it is closed.
TEST(ZipSeams, SpansNoGapOfTheModel) {
  const auto serial = make_serial_scheduler();
  std::vector<BorderPoint> beside;
  for (const BorderPoint& p : border_along_row(0, {0, -1, 0})) beside.push_back(p);
  for (const BorderPoint& p : border_along_row(3, {0, 1, 0})) beside.push_back(p);
  std::vector<BorderPoint> around_both = beside;
  for (const BorderPoint& p : border_along_row(1, {0, 1, 0})) around_both.push_back(p);
  for (const BorderPoint& p : border_along_row(2, {0, -1, 0})) around_both.push_back(p);
  for (const bool is_gap : {true, false}) {
    const ModelBorder border(is_gap ? around_both : beside, 1.6f);
    SeamMesh seam = two_ribbons(20);
    mark_rims(border, seam, *serial);
    EXPECT_EQ(std::count(seam.rim.begin(), seam.rim.end(), 1), 84);
    EXPECT_EQ(zip_seams(seam, {.spacing = 1}, *serial), is_gap ? 0u : 40u);
    EXPECT_EQ(fill_holes(seam, {.spacing = 1, .longest = 1000}).filled, 0u);  // outlines
  }
}

// A comb of needles side by side, far closer than the spacing: what is kept follows the area that they are in, and
// every place of the border has a point near it that faces as it does.
TEST(BorderPoints, FollowTheSpaceOfCrowdedEdges) {
  constexpr std::uint32_t needles = 2000;
  constexpr double spacing = 0.05;
  IndexedMesh mesh;
  for (std::uint32_t k = 0; k < needles; ++k) {
    const float x = static_cast<float>(k) / needles;
    for (const Vec3f& p : {Vec3f{x, 0, 0}, Vec3f{x + 0.5f / needles, 0, 0}, Vec3f{x, 1, 0}})
      mesh.positions.push_back(p);
    mesh.triangles.push_back({{3 * k, 3 * k + 1, 3 * k + 2}});
  }
  const std::vector<LoneEdge> border = border_edges(mesh);
  ASSERT_EQ(border.size(), 3 * needles);
  const std::vector<BorderPoint> points = border_points(mesh, border, spacing);
  EXPECT_LT(points.size(), 16 / (spacing * spacing));
  for (const LoneEdge& edge : border) {
    const auto& v = mesh.triangles[edge.triangle].v;
    const Vec3f a = mesh.positions[v[edge.corner]], b = mesh.positions[v[(edge.corner + 1) % 3]],
                c = mesh.positions[v[(edge.corner + 2) % 3]];
    const Vec3f outward = unit_normal(to_double(cross(b - a, cross(b - a, c - a)))), middle = 0.5f * (a + b);
    EXPECT_TRUE(std::ranges::any_of(points, [&](const BorderPoint& p) {
      return length(p.position - middle) <= 1.0001 * spacing && dot(p.outward, outward) >= 0.9f;
    })) << edge.triangle;
  }
}

TEST(DropCrumbs, KeepsWhatIsAllOfItsPart) {
  for (const bool rest : {false, true}) {
    SeamMesh seam = two_ribbons(20);
    for (VertexId v{42}; v < 84; ++v) seam.part[v] = rest ? 0 : 1;
    const std::vector<std::uint32_t> sizes{40, 10};  // of the ribbons
    EXPECT_EQ(drop_crumbs(seam, sizes, {.least = 3, .least_beside = 20, .rest = rest}), 0u);
    for (VertexId v{0}; v < 84; ++v) seam.part[v] = 1;
    EXPECT_EQ(drop_crumbs(seam, sizes, {.least = 3, .least_beside = 20, .rest = rest}), 40u);
  }
}

// In a fan of so many triangles no step may look at all of them for each one.
TEST(CountHandles, TakesAFanOfAnySize) {
  constexpr std::uint32_t n = 100'000;
  std::vector<Triangle> wheel;
  for (std::uint32_t k = 0; k < n; ++k) wheel.push_back({{0, 1 + k, 1 + (k + 1) % n}});
  EXPECT_EQ(count_handles(mesh_of(wheel, n + 1)), 0u);
  EditMesh mesh(n + 1, wheel);
  EXPECT_EQ(mesh.fan(VertexId(0), TriangleId(7)).size(), n);
  for (std::uint32_t t = n - 1; t > 0; --t) mesh.remove(TriangleId(t));
  EXPECT_EQ(mesh.around(VertexId(0)).size(), 1u);
}

TEST(ZipSeams, LeavesRimsAlone) {
  const auto serial = make_serial_scheduler();
  SeamMesh seam = two_ribbons(20);
  std::fill(seam.rim.begin(), seam.rim.end(), std::uint8_t{1});
  EXPECT_EQ(zip_seams(seam, {.spacing = 1}, *serial), 0u);
}

// A plate of 14 x 14 squares and less than a spacing thick, its two sides joined at the outline, with a hole of 3 x 3
// squares in the middle of each.
SeamMesh plate_with_holes() {
  constexpr std::uint32_t n = 14;
  std::vector<Vec3f> positions, normals;
  std::vector<Triangle> triangles;
  const auto vertex = [&](std::uint32_t x, std::uint32_t y, std::uint32_t side) {
    return (side * (n + 1) + y) * (n + 1) + x;
  };
  for (std::uint32_t side = 0; side < 2; ++side)
    for (std::uint32_t y = 0; y <= n; ++y)
      for (std::uint32_t x = 0; x <= n; ++x) {
        positions.push_back({static_cast<float>(x), static_cast<float>(y), side == 0 ? 0 : -0.7f});
        normals.push_back({0, 0, side == 0 ? 1.0f : -1.0f});
      }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangles.insert(triangles.end(), {{{a, b, c}}, {{a, c, d}}});
  };
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      if (x >= 6 && x < 9 && y >= 6 && y < 9) continue;
      quad(vertex(x, y, 0), vertex(x + 1, y, 0), vertex(x + 1, y + 1, 0), vertex(x, y + 1, 0));
      quad(vertex(x, y, 1), vertex(x, y + 1, 1), vertex(x + 1, y + 1, 1), vertex(x + 1, y, 1));
    }
  for (std::uint32_t k = 0; k < n; ++k) {
    quad(vertex(k + 1, 0, 0), vertex(k, 0, 0), vertex(k, 0, 1), vertex(k + 1, 0, 1));
    quad(vertex(k, n, 0), vertex(k + 1, n, 0), vertex(k + 1, n, 1), vertex(k, n, 1));
    quad(vertex(0, k, 0), vertex(0, k + 1, 0), vertex(0, k + 1, 1), vertex(0, k, 1));
    quad(vertex(n, k + 1, 0), vertex(n, k, 0), vertex(n, k, 1), vertex(n, k + 1, 1));
  }
  return seam_of(positions, normals, triangles, {}, 1);
}

TEST(ZipSeams, MakesNoMoreHandlesThanItMay) {
  const auto serial = make_serial_scheduler();
  for (const std::size_t most : {std::size_t{0}, std::size_t{1}, any_number}) {
    SeamMesh seam = plate_with_holes();
    const std::size_t added =
        zip_seams(seam, {.spacing = 1, .least_cosine = -0.5f, .rims = true, .most_handles = most}, *serial);
    EXPECT_EQ(added, most == 0 ? 0u : 24u);  // a wall of 12 squares
    EXPECT_EQ(seam.borders.handles(), most == 0 ? 0u : 1u);
    EXPECT_EQ(split_vertices(seam), 0u);
    const FillResult filled = fill_holes(seam, {.spacing = 1, .rims = true});
    EXPECT_EQ(filled.filled, most == 0 ? 2u : 0u);
    EXPECT_EQ(filled.open, 0u);
    const std::vector<Triangle> triangles = triangles_of(seam.mesh);
    EXPECT_EQ(count_handles(mesh_of(triangles, seam.position.size())), most == 0 ? 0u : 1u);
    for (const Triangle& t : triangles) EXPECT_FALSE(seam.mesh.is_border(VertexId(t.v[0]), VertexId(t.v[1])));
  }
}

// A fan of n triangles round its hole: a ring of n squares, cut in two.
SeamMesh ring(std::uint32_t n) {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  for (const float radius : {1.0f, 1.1f})
    for (std::uint32_t k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n;
      positions.push_back(to_float(radius * Vec3d{std::cos(angle), std::sin(angle), 0}));
    }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    triangles.insert(triangles.end(), {{{k, n + k, n + next}}, {{k, n + next, next}}});
  }
  return seam_of(positions, std::vector<Vec3f>(positions.size(), Vec3f{0, 0, 1}), triangles, {}, 1);
}

TEST(FillHoles, CutsEarsOffAConvexHole) {
  for (const std::uint32_t n : {3u, 4u, 17u, 1500u}) {
    SeamMesh seam = ring(n);
    for (std::uint32_t v = n; v < 2 * n; ++v) seam.rim[v] = 1;  // the outside is an outline
    const FillResult result = fill_holes(seam, {.spacing = 1});
    EXPECT_EQ(result.filled, 1u);
    EXPECT_EQ(result.triangles, n - 2);
    EXPECT_EQ(result.open, 1u);
    EXPECT_NEAR(result.longest, 2 * n * std::sin(std::numbers::pi / n), 1e-4);
    EXPECT_NEAR(result.open_length, 1.1 * 2 * n * std::sin(std::numbers::pi / n), 1e-4);
    double area = 0;
    for (const Triangle& t : triangles_of(seam.mesh)) area += 0.5 * length(area_vector(seam, t));
    EXPECT_NEAR(area, 0.5 * n * 1.21 * std::sin(2 * std::numbers::pi / n), 1e-3);
  }
  SeamMesh seam = ring(17);
  const FillResult none_filled = fill_holes(seam, {.spacing = 1, .longest = 5, .rims = true});
  EXPECT_EQ(none_filled.filled, 0u);
  EXPECT_EQ(none_filled.open, 2u);
}

TEST(SplitVertices, PartsFansAndTheirBorders) {
  // Two triangles that meet in vertex 0.
  const std::vector<Vec3f> positions{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  SeamMesh seam = seam_of(positions, std::vector<Vec3f>(5, Vec3f{0, 0, 1}), {{{0, 1, 2}}, {{0, 3, 4}}},
                          std::vector<std::uint32_t>{0, 1}, 2);
  EXPECT_EQ(split_vertices(seam), 1u);
  EXPECT_EQ(seam.position.size(), 6u);
  EXPECT_EQ(seam.position[5], seam.position[0]);
  expect_borders_of(seam.borders, seam.mesh);
  EXPECT_EQ(seam.mesh.around(VertexId(0)).size(), 1u);
  EXPECT_EQ(split_vertices(seam), 0u);
  EXPECT_EQ(drop_crumbs(seam, std::vector<std::uint32_t>{1, 1}, {.least = 1}), 0u);
  EXPECT_EQ(drop_crumbs(seam, std::vector<std::uint32_t>{1, 20}, {.least = 3}), 1u);
  EXPECT_EQ(triangles_of(seam.mesh).size(), 1u);
  expect_borders_of(seam.borders, seam.mesh);
}

}  // namespace
}  // namespace lodestone::test
