// The cause that `build` names when a model keeps more triangles than others.
#include <gtest/gtest.h>

#include "experiments/commands/build_notes.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

BuildConfig config(float sigma0 = 0.2f, std::uint32_t cell_triangles = 2000) {
  BuildConfig result;
  result.sigma0 = sigma0;
  result.cell_triangles = cell_triangles;
  result.finest_level = 2;
  return result;
}

IndexedMesh prepared(RawMesh raw) {
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, *scheduler);
}

std::string note(IndexedMesh mesh, const BuildConfig& config) {
  const auto scheduler = make_serial_scheduler();
  const Hierarchy h = build_hierarchy(std::move(mesh), config, *scheduler);
  return describe(find_kept(h), 2, h);
}

void expect_note(const std::string& said, const std::string& part, const std::string& remedy) {
  EXPECT_NE(said.find(part), std::string::npos) << said;
  EXPECT_NE(said.find(remedy), std::string::npos) << said;
}

// A grid of n x n squares.
RawMesh grid(std::uint32_t n) { return test::raw_of(test::terrain_mesh(n)); }

TEST(BuildNotes, ASurfaceThatSimplifiesHasNone) {
  BuildConfig large = config();
  large.finest_level = 1;
  EXPECT_EQ(note(test::sphere_mesh(6), large), "");
  EXPECT_EQ(note(prepared(grid(100)), large), "");
}

TEST(BuildNotes, LoosePartsHaveBorders) {
  RawMesh raw = grid(60), loose;
  for (const Triangle& t : raw.triangles) {  // each a little smaller than its neighbours leave room for
    const Vec3d middle = (1.0 / 3) * (raw.positions[t.v[0]] + raw.positions[t.v[1]] + raw.positions[t.v[2]]);
    const auto first = static_cast<std::uint32_t>(loose.positions.size());
    for (const std::uint32_t v : t.v) loose.positions.push_back(middle + 0.9 * (raw.positions[v] - middle));
    loose.triangles.push_back({{first, first + 1, first + 2}});
  }
  expect_note(note(prepared(loose), config()), "borders of the surface", "join parts");
}

TEST(BuildNotes, CubesThatMeetAtEdges) {
  constexpr std::uint32_t n = 12;
  RawMesh raw;
  for (std::uint32_t cube = 0; cube < n * n * n; ++cube) {  // as on a chess board
    const Vec3d at{double(cube % n), double(cube / n % n), double(cube / n / n)};
    if ((cube % n + cube / n % n + cube / n / n) % 2 == 0)
      test::add_cube(
          1, [&](Vec3d p) { return at + p; }, raw.positions, raw.triangles);
  }
  expect_note(note(prepared(raw), config()), "more than two triangles", "info counts");
}

TEST(BuildNotes, SeamsEverywhere) {
  RawMesh raw = grid(60);
  std::vector<Vec3d> positions;
  for (Triangle& t : raw.triangles)
    for (std::uint32_t& v : t.v) {
      positions.push_back(raw.positions[v]);
      raw.wedges.uv.push_back({static_cast<float>(positions.size()), 0});  // of its own for every corner
      v = static_cast<std::uint32_t>(positions.size() - 1);
    }
  raw.positions = std::move(positions);
  expect_note(note(prepared(raw), config()), "on seams", "--no-attributes");
}

TEST(BuildNotes, ABoundThatIsTooSmall) {
  expect_note(note(test::sphere_mesh(5), config(0.02f)), "bound of how far vertices may move", "--sigma0 than 0.02");
}

TEST(BuildNotes, CellsThatAreTooSmall) {
  BuildConfig small = config(0.5f, 10);
  small.finest_level = -1;
  expect_note(note(test::sphere_mesh(5), small), "blocks lock them", "more --cell-triangles");
}

}  // namespace
}  // namespace lodestone
