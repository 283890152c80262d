// Which view owns a point: scores at borders of view meshes, and between samples.
#include <gtest/gtest.h>

#include "render/reconstruct/merge/ownership.h"
#include "tests/render/reconstruct/obvious_map.h"

namespace lodestone::test {
namespace {

constexpr std::size_t width = 40;
const MapView from_above{
    Projection::orthographic, {0.5, 0.5, 2}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 1.0 / 32, width, 40};

PositionMap plane_from(const MapView& view) {
  IndexedMesh mesh = terrain_mesh(5, 0);
  mesh.transform = {};
  return rasterize_map(mesh, view, {}, *make_serial_scheduler());
}

MergeView view_of(const PositionMap& map) {
  MergeView view;
  view.map = &map;
  view.mesh = connect(map, {});
  view.score.assign(map.view.pixels(), 0.5f);
  return view;
}

constexpr OwnershipConfig config{.reference_spacing = 1.0 / 32};

float score_of(const MergeView& view, std::size_t pixel) {
  PixelArray<float> score;
  score.assign(view.map->view.pixels(), -2);
  score_rows(view, config, 0, view.map->view.height, score);
  return score[pixel];
}

TEST(Ownership, APixelIsWholeIfTrianglesSurroundIt) {
  const PositionMap map = plane_from(from_above);
  const std::size_t pixel = 20 * width + 20;
  const MergeView whole = view_of(map);
  EXPECT_NEAR(score_of(whole, pixel), 1, 1e-5);
  for (const std::size_t cell : {pixel, pixel - 1, pixel - width, pixel - width - 1}) {
    MergeView torn = view_of(map);
    torn.mesh.cells[cell] = cell_psq;  // one triangle is left
    EXPECT_NEAR(score_of(torn, pixel), 0.02, 1e-6) << pixel - cell;
  }
  for (const std::size_t cell : {pixel + 1, pixel + width, pixel - width + 1, pixel + width - 1, pixel - 2}) {
    MergeView torn = view_of(map);
    torn.mesh.cells[cell] = 0;
    EXPECT_NEAR(score_of(torn, pixel), 1, 1e-5) << cell;
  }
}

// The point lies in the middle between four samples of the other view.
TEST(Ownership, APointIsNotOwnedWhereACornerMayNotBe) {
  MapView beside = from_above;
  beside.eye.x += 0.4 / 32, beside.eye.y += 0.3 / 32;
  const PositionMap map = plane_from(from_above), other = plane_from(beside);
  const std::size_t pixel = 20 * width + 20;
  const MergeView view = view_of(other);
  const float score = score_at(view, map, pixel, config);
  EXPECT_NEAR(score, 0.5, 1e-5);
  EXPECT_LT(score_at(view, map, pixel, config, score), 0);  // not above what there is
  std::size_t corners = 0;
  for (const std::size_t near : {pixel - width - 1, pixel - width, pixel - width + 1, pixel - 1, pixel, pixel + 1,
                                 pixel + width - 1, pixel + width, pixel + width + 1}) {
    MergeView dropped = view_of(other);
    dropped.score[near] = -1e-3f;
    const float there = score_at(dropped, map, pixel, config);
    EXPECT_TRUE(there == -1 || there == score) << there;
    corners += there == -1;
  }
  EXPECT_EQ(corners, 3u);
}

}  // namespace
}  // namespace lodestone::test
