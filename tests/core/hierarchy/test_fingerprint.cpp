// The hash that tells whether all of the input arrived.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/hierarchy/model/fingerprint.h"

namespace lodestone {
namespace {

// Equal distances, and for a power of two coordinates whose mantissas end in zeros: hard for a hash by multiplication.
std::vector<Vec3f> lattice(unsigned side) {
  std::vector<Vec3f> points;
  const auto at = [&](unsigned i) { return static_cast<float>(i) / static_cast<float>(side); };
  for (unsigned x = 0; x < side; ++x)
    for (unsigned y = 0; y < side; ++y)
      for (unsigned z = 0; z < side; ++z) points.push_back({at(x), at(y), at(z)});
  return points;
}

// Hash of all triangles of the points, in both orientations.
std::vector<std::uint64_t> all_fingerprints(const std::vector<Vec3f>& p) {
  std::vector<std::uint64_t> found;
  for (std::size_t a = 0; a < p.size(); ++a)
    for (std::size_t b = a + 1; b < p.size(); ++b)
      for (std::size_t c = a + 1; c < p.size(); ++c)
        if (b != c) found.push_back(triangle_fingerprint(p[a], p[b], p[c]));
  return found;
}

TEST(Fingerprint, IsTheSameForRotationsAndNotForReflections) {
  const std::vector<Vec3f> p = lattice(4);
  for (std::size_t i = 0; i + 21 < p.size(); ++i) {
    const Vec3f a = p[i], b = p[i + 1], c = p[i + 21];
    EXPECT_EQ(triangle_fingerprint(a, b, c), triangle_fingerprint(b, c, a));
    EXPECT_EQ(triangle_fingerprint(a, b, c), triangle_fingerprint(c, a, b));
    EXPECT_NE(triangle_fingerprint(a, b, c), triangle_fingerprint(a, c, b));
  }
}

TEST(Fingerprint, TakesBothZerosForOne) {
  EXPECT_EQ(triangle_fingerprint({-0.0f, 0, 1}, {0, -0.0f, 0.5f}, {1, 1, -0.0f}),
            triangle_fingerprint({0, 0, 1}, {0, 0, 0.5f}, {1, 1, 0}));
}

TEST(Fingerprint, DiffersForAllTrianglesOfALattice) {
  for (const unsigned side : {4u, 5u, 6u}) {
    std::vector<std::uint64_t> found = all_fingerprints(lattice(side));
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << side;
  }
}

TEST(Fingerprint, EveryBitIsSetInHalfOfThem) {
  const std::vector<std::uint64_t> found = all_fingerprints(lattice(4));
  std::array<double, 64> set{};
  for (const std::uint64_t f : found)
    for (unsigned bit = 0; bit < 64; ++bit) set[bit] += static_cast<double>(f >> bit & 1);
  for (const double count : set) EXPECT_NEAR(count / static_cast<double>(found.size()), 0.5, 0.01);
}

// Sums must tell apart what has the same corners and the same edges but other triangles.
TEST(Fingerprint, SumsTellApartTrianglesOfTheSameEdges) {
  const std::vector<Vec3f> p = lattice(4);
  const Vec3f a = p[0], b = p[13], c = p[27], d = p[62];
  const std::uint64_t one = triangle_fingerprint(a, b, c) + triangle_fingerprint(a, c, d);
  EXPECT_NE(one, triangle_fingerprint(a, b, d) + triangle_fingerprint(b, c, d));  // the other diagonal
  // A tetrahedron and the same turned inside out have the same directed edges.
  EXPECT_NE(one + triangle_fingerprint(a, d, b) + triangle_fingerprint(b, d, c),
            triangle_fingerprint(a, c, b) + triangle_fingerprint(a, d, c) + triangle_fingerprint(a, b, d) +
                triangle_fingerprint(b, c, d));
}

// Moving equal amounts in opposite directions is what a sum is blind to, if anything.
TEST(Fingerprint, SumsTellApartExchangedCorners) {
  const std::vector<Vec3f> p = lattice(4);
  for (std::size_t i = 0; i + 24 < p.size(); ++i)
    EXPECT_NE(triangle_fingerprint(p[i], p[i + 1], p[i + 4]) + triangle_fingerprint(p[i + 16], p[i + 17], p[i + 20]),
              triangle_fingerprint(p[i], p[i + 1], p[i + 20]) + triangle_fingerprint(p[i + 16], p[i + 17], p[i + 4]));
}

}  // namespace
}  // namespace lodestone
