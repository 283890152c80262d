// Maps of which much is empty: memory follows from what is seen, and results are those of maps with memory for all.
#include <gtest/gtest.h>

#include <random>

#include "render/reconstruct/from_maps.h"
#include "tests/render/reconstruct/obvious_map.h"

namespace lodestone::test {
namespace {

// As of a channel that a file does not have; a sanitizer tells when this reaches for the first place.
TEST(PixelArray, OfNoValuesIsEmpty) {
  EXPECT_TRUE(PixelArray(std::vector<std::uint32_t>()).empty());
  EXPECT_EQ(PixelArray(std::vector<std::uint32_t>{4, 5}).to_vector(), (std::vector<std::uint32_t>{4, 5}));
}

TEST(PixelArray, ReadsWhatWasWrittenAndIsEmptyElsewhere) {
  std::mt19937 random(7);
  for (const auto& [width, height] : {std::pair{1, 1}, {16, 3}, {37, 29}, {130, 5}}) {
    std::vector<std::uint32_t> plain(static_cast<std::size_t>(width * height), 9);
    PixelMarks marks(width, height);
    std::vector<std::size_t> seen;
    for (int k = 0; k < 5; ++k) {
      const int x = static_cast<int>(random() % static_cast<unsigned>(width)),
                y = static_cast<int>(random() % static_cast<unsigned>(height));
      marks.add_row(0, width, y, [&](int column) { return column == x; });
      for (int dy = std::max(y - 1, 0); dy <= std::min(y + 1, height - 1); ++dy)
        for (int dx = std::max(x - 1, 0); dx <= std::min(x + 1, width - 1); ++dx)
          seen.push_back(static_cast<std::size_t>(dy * width + dx));
    }
    PixelArray<std::uint32_t> sparse(marks.groups(), 9);
    for (const std::size_t i : seen) {
      ASSERT_TRUE(sparse.groups().has(i));
      sparse[i] = plain[i] = static_cast<std::uint32_t>(random());
    }
    EXPECT_EQ(sparse.to_vector(), plain);
    EXPECT_EQ(sparse, PixelArray(plain));
    EXPECT_EQ(PixelArray(plain).in(sparse, 9u), sparse);
    std::vector<std::size_t> listed;
    sparse.groups().for_pixels(5, plain.size(), [&](std::size_t i) { listed.push_back(i); });
    std::vector<std::size_t> expected;
    for (std::size_t i = 5; i < plain.size(); ++i)
      if (sparse.groups().has(i)) expected.push_back(i);
    EXPECT_EQ(listed, expected);
  }
}

// Two fine balls in opposite corners, a strip between them, and a speck aside.
IndexedMesh far_apart() {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  const auto add_ball = [&](Vec3d at, double size) {
    const IndexedMesh ball = sphere_mesh(3);
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const Vec3f& p : ball.positions) positions.push_back(at + size * to_double(p));
    for (const Triangle& t : ball.triangles) triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
  };
  add_ball({0, 0, 0}, 0.1), add_ball({0.9, 0.9, 0.9}, 0.1), add_ball({0.7, 0.1, 0.4}, 0.03);
  add_box({0.4, 0.02, 0.02}, {0.43, 0.9, 0.05}, 9, positions, triangles);
  return clean(positions, triangles);
}

TEST(SparseMaps, TakeMemoryForWhatIsSeen) {
  const IndexedMesh mesh = far_apart();
  const auto serial = make_serial_scheduler();
  const auto along = [&](double pixel) { return orthographic_view(box_of(mesh), {-0.3, 0.8, -0.5}, pixel); };
  EXPECT_EQ(rasterize_map(mesh, along(1.0 / 40), {}, *serial), obvious_map(mesh, along(1.0 / 40)));
  const MapView view = along(1.0 / 500);
  const PositionMap map = rasterize_map(mesh, view, {}, *serial);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < view.pixels(); ++i) seen += map.sees(i);
  EXPECT_LT(seen, view.pixels() / 20);
  EXPECT_LT(map.groups().stored(), 2 * seen);
}

PositionMap with_memory_for_all(const PositionMap& map) {
  PositionMap all = map;
  all.triangle = PixelArray(map.triangle.to_vector());
  all.position = map.position.in(all.triangle), all.depth = map.depth.in(all.triangle);
  all.normal = map.normal.in(all.triangle);
  return all;
}

TEST(SparseMaps, AreMergedAsThoseWithMemoryForAll) {
  const auto serial = make_serial_scheduler(), three = make_tbb_scheduler(3);
  for (const MergeKind merge : {MergeKind::stitch, MergeKind::concatenate, MergeKind::shell})
    for (const bool extend : {false, true}) {
      ReconstructConfig config;
      config.resolution = 60, config.merge = merge, config.extend = extend, config.condense = false;
      LastChoice last;
      ReconstructReport report;
      DrawnMaps sparse = draw_maps(far_apart(), config, last, report, *serial), all = sparse;
      for (PositionMap& map : all.maps) {
        map = with_memory_for_all(map);
        EXPECT_EQ(map.groups().stored(), PixelGroups::length + (map.view.pixels() + 15) / 16 * 16);
      }
      EXPECT_EQ(sparse.maps, all.maps);
      ReconstructReport own = report, other = report;
      const RawMesh a = mesh_from_maps(sparse, nullptr, config, own, *three),
                    b = mesh_from_maps(all, nullptr, config, other, *serial);
      EXPECT_EQ(a.positions, b.positions);
      EXPECT_EQ(a.triangles, b.triangles);
      EXPECT_GT(a.triangles.size(), 100u);
      EXPECT_EQ(own.seen, other.seen);
    }
}

}  // namespace
}  // namespace lodestone::test
