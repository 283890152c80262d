// The digits that a few vertices far away take from all others.
#include <gtest/gtest.h>

#include "core/mesh/clean.h"
#include "core/mesh/precision.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

// A sphere of radius 1 at `middle`, and a triangle with one corner at `far`.
IndexedMesh sphere_and(Vec3d middle, Vec3d far, Lattice lattice = {}) {
  RawMesh raw;
  test::octahedral_sphere(raw.positions, raw.triangles, 4);
  for (Vec3d& p : raw.positions) p = p + middle;
  const auto first = static_cast<std::uint32_t>(raw.positions.size());
  for (const Vec3d p : {Vec3d{0, 0, 0}, Vec3d{1, 0, 0}}) raw.positions.push_back(p + middle);
  raw.positions.push_back(far);
  raw.triangles.push_back({{first, first + 1, first + 2}});
  Repairs repairs;
  return clean_mesh(raw, repairs, "m", lattice);
}

TEST(Precision, OneVertexFarAwayTakesDigits) {
  // The sphere is at the far end of the range of numbers: 2e-6 of it, in steps of 2^-24.
  const IndexedMesh mesh = sphere_and({0, 0, 0}, {-1e6, 0, 0});
  const auto crowded = find_crowded(mesh.positions, mesh.transform);
  ASSERT_TRUE(crowded);
  EXPECT_NEAR(crowded->share, 2e-6, 2e-7);
  EXPECT_NEAR(crowded->step, 1e6 * 0x1p-24, 1e-3);
  EXPECT_NEAR(crowded->steps, 2 / 0.0596, 4);
  EXPECT_NEAR(crowded->farthest.x, -1e6, 1);
  const std::string note = describe(*crowded);
  for (const char* part : {"99 %", "2e-06", "1.5 decimal digits", "(-1000000, ", "remove vertices"})
    EXPECT_NE(note.find(part), std::string::npos) << note;
}

TEST(Precision, OrdinaryModelsAndDigitsThatAreKeptAreNoNote) {
  const IndexedMesh usual = sphere_and({1e7, 1e7, 1e7}, {1e7 + 3, 1e7, 1e7});
  EXPECT_FALSE(find_crowded(usual.positions, usual.transform)) << "all of it is far from the origin";
  // Near zero floats are as fine as ever on that axis, but the others are in the middle of the box.
  const IndexedMesh near = sphere_and({1, 1, 1}, {1e6, 1, 1});
  EXPECT_FALSE(find_crowded(near.positions, near.transform));
  EXPECT_FALSE(find_crowded({}, {}));
}

TEST(Precision, ALatticeIsAsFineEverywhere) {
  const IndexedMesh mesh = sphere_and({1, 1, 1}, {1e4, 1, 1}, {20});
  const auto crowded = find_crowded(mesh.positions, mesh.transform);
  ASSERT_TRUE(crowded);
  EXPECT_NEAR(crowded->step, 1e4 * 0x1p-20, 1e-5);
}

}  // namespace
}  // namespace lodestone
