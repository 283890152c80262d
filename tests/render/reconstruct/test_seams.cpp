// Seams closed: zipping, filling, splitting, each against a closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "core/mesh/raw_mesh.h"
#include "render/reconstruct/finish/label_parts.h"
#include "tests/render/reconstruct/edit_meshes.h"

namespace lodestone::test {
namespace {

Vec3f area_vector(const SeamMesh& seam, const Triangle& t) {
  return lodestone::area_vector(seam, VertexId(t.v[0]), VertexId(t.v[1]), VertexId(t.v[2]));
}

// A seam mesh of triangles that are all there is.
SeamMesh seam_of(const std::vector<Vec3f>& positions, const std::vector<Vec3f>& normals,
                 const std::vector<Triangle>& triangles, std::span<const std::uint32_t> piece, std::size_t pieces) {
  SeamMesh seam;
  seam.position = positions, seam.normal = normals;
  seam.frozen.resize(positions.size()), seam.rim.resize(positions.size()), seam.part.resize(positions.size());
  seam.mesh = EditMesh(positions.size(), triangles);
  seam.borders = borders_of(seam.mesh, piece, pieces);
  seam.patch_seed.assign(pieces, EditMesh::none);
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

// The border of the model runs around the ring, and around its hole where that is one of the model.
TEST(FillHoles, LeavesGapsOfTheModelOpen) {
  const auto serial = make_serial_scheduler();
  constexpr std::uint32_t n = 17;
  const Vec3f middle{7, 3, 0};
  for (const bool is_gap : {true, false}) {
    SeamMesh seam = ring(n);
    for (Vec3f& p : seam.position) p = p + middle;
    std::vector<BorderPoint> points;
    for (std::uint32_t v = is_gap ? 0 : n; v < 2 * n; ++v)
      points.push_back({seam.position[v], (v < n ? -1.0f : 1 / 1.1f) * (seam.position[v] - middle)});
    const ModelBorder border(points, 0.45f);
    mark_rims(border, seam, *serial);
    const FillResult result = fill_holes(seam, {.spacing = 1});
    EXPECT_EQ(result.filled, is_gap ? 0u : 1u);
    EXPECT_EQ(result.open, is_gap ? 2u : 1u);
  }
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

// A disc of needles, each a spacing wide, within a ring of well-shaped triangles: no edge is short, and flipping one
// leaves a triangle without area.
TEST(TidySeams, CollapsesNeedles) {
  constexpr std::uint32_t n = 188;
  std::vector<Vec3f> positions{{0, 0, 0}};
  std::vector<Triangle> triangles;
  for (const float radius : {30.0f, 31.0f})
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      positions.push_back(radius * Vec3f{static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 1 + i, b = 1 + (i + 1) % n;
    triangles.insert(triangles.end(), {{{0, a, b}}, {{a, a + n, b + n}}, {{a, b + n, b}}});
  }
  SeamMesh seam = seam_of(positions, std::vector<Vec3f>(positions.size(), Vec3f{0, 0, 1}), triangles, {}, 1);
  const auto worst = [&] {
    float aspect = 0;
    for (const Triangle& t : triangles_of(seam.mesh))
      aspect = std::max(aspect, aspect_of(seam.position[t.v[0]], seam.position[t.v[1]], seam.position[t.v[2]]));
    return aspect;
  };
  EXPECT_GT(worst(), 25);
  const auto scheduler = make_tbb_scheduler(2);
  const TidyResult result = tidy_seams(seam, {.spacing = 1}, *scheduler);
  EXPECT_GT(result.collapsed, n / 4);
  EXPECT_LE(worst(), 20);
}

}  // namespace
}  // namespace lodestone::test
