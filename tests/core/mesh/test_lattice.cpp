// The global lattice: nearest points, bounds, the ends of the cube.
#include <gtest/gtest.h>

#include <random>

#include "core/math/lattice.h"

namespace lodestone {
namespace {

TEST(Lattice, NearestPointIsExactInsideTheCubeAndWithinTheBound) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int bits = 1; bits <= Lattice::most_bits; ++bits) {
    const Lattice lattice{bits};
    EXPECT_EQ(lattice.step(), std::ldexp(1.0f, -bits));
    for (int i = 0; i < 1000; ++i) {
      const Vec3d p{unit(random), unit(random), unit(random)};
      const Vec3f q = lattice.nearest(p);
      EXPECT_TRUE(lattice.holds(q));
      EXPECT_EQ(q, lattice.nearest(to_double(q)));
      EXPECT_EQ(q.x * static_cast<float>(lattice.last()), std::round(p.x * lattice.last()));
      EXPECT_LE(length(p - to_double(q)), double{lattice.error()});
    }
    const double half = 0.5 * lattice.step();  // the farthest that a point can be
    EXPECT_LE(length(Vec3d{half, half, half}), double{lattice.error()});
    EXPECT_LE(lattice.error(), std::sqrt(0.75) * lattice.step() * (1 + 1e-6));
  }
}

TEST(Lattice, EndsAtTheCube) {
  const Lattice lattice{10};
  EXPECT_EQ(lattice.nearest(Vec3d{1, 0, -0.0}), (Vec3f{1, 0, 0}));
  EXPECT_FALSE(std::signbit(lattice.nearest(Vec3d{1, 0, -0.0}).z));
  EXPECT_EQ(lattice.nearest(Vec3d{1.5, -7, 1e300}), (Vec3f{1, 0, 1}));
  EXPECT_EQ(lattice.nearest(Vec3d{NAN, -INFINITY, INFINITY}), (Vec3f{0, 0, 1}));
  EXPECT_FALSE(lattice.holds({1.5f, 0, 0}));
  EXPECT_FALSE(lattice.holds({0.3f, 0, 0}));
}

TEST(Lattice, NoneHoldsEverything) {
  EXPECT_FALSE(Lattice{});
  EXPECT_TRUE(Lattice{}.holds({0.3f, 7, 0}));
  EXPECT_EQ(Lattice{}.error(), 0);
}

}  // namespace
}  // namespace lodestone
