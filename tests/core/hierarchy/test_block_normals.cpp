// Normals of a block's survivors against a plain twin: sums by wedge, and by vertex and normal, in maps, each turned by
// itself.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <tuple>
#include <vector>

#include "core/hierarchy/construct/block_normals.h"

namespace lodestone {
namespace {

struct CoarseCell {
  std::vector<PackedNormal> normals;
  std::vector<Float4> sums;               // z, x, y
  std::vector<std::uint32_t> id, vertex;  // of the block
  std::vector<std::uint32_t> shared;

  void push_back(std::uint32_t wedge, std::uint32_t at, PackedNormal normal, Vec3f sum) {
    id.push_back(wedge), vertex.push_back(at), normals.push_back(normal);
    sums.push_back(Float4{sum.z, sum.x, sum.y, 0});
  }
};

struct Case {
  std::vector<std::uint8_t> locked;
  std::vector<std::uint32_t> vertex;  // of each id
  std::array<CoarseCell, 3> cells;
};

// Vertices of up to three wedges, which have one normal or two, and may face elsewhere; some belong to several cells,
// or are locked. Own ones come first.
Case random_case(std::mt19937& random, bool wedges) {
  std::normal_distribution<float> gauss;
  const auto direction = [&] { return Vec3f{gauss(random), gauss(random), gauss(random)}; };
  Case c;
  for (const bool shared : {false, true}) {
    for (std::uint32_t k = 0; k < 151; ++k) {
      const std::uint32_t v = shared ? 151 + k : k, uses = shared ? 2 + random() % 2 : 1;
      const Vec3f facing = direction();
      const float bend = 0.2f * static_cast<float>(random() % 5);
      const std::array normals{pack_normal(facing + bend * direction()), pack_normal(direction())};
      const bool locked = shared && random() % 3 == 0, nothing = random() % 20 == 0;
      for (std::size_t count = wedges ? 1 + random() % 3 : 1; count > 0; --count) {
        const auto id = static_cast<std::uint32_t>(c.vertex.size());
        c.vertex.push_back(v), c.locked.push_back(locked);
        const PackedNormal normal = normals[random() % 2];
        const Vec3f wedge_facing = random() % 4 == 0 ? direction() : facing;
        for (std::uint32_t cell = v; cell < v + uses; ++cell) {
          c.cells[cell % 3].push_back(id, v, normal, nothing ? Vec3f{} : 1e-4f * (wedge_facing + 0.1f * direction()));
          if (shared) c.cells[cell % 3].shared.push_back(id);
        }
      }
    }
  }
  return c;
}

double angle(Vec3f a, Vec3f b) {
  return 57.29578 * std::atan2(length(cross(to_double(a), to_double(b))), dot(to_double(a), to_double(b)));
}

// Sums of all triangles at the wedges of a vertex that have a normal, wherever these are.
struct Sums {
  std::map<std::tuple<std::uint32_t, std::int16_t, std::int16_t>, std::map<std::uint32_t, Vec3f>> wedges;

  void add(std::uint32_t id, std::uint32_t vertex, PackedNormal normal, Float4 s) {
    Vec3f& sum = wedges[{vertex, normal.u, normal.v}][id];
    sum = sum + Vec3f{s[1], s[2], s[0]};
  }
  // Empty where an angle is too near to that of a fold to be told apart.
  [[nodiscard]] std::optional<Vec3f> towards(std::uint32_t id, std::uint32_t vertex, PackedNormal normal) const {
    const std::map<std::uint32_t, Vec3f>& together = wedges.at({vertex, normal.u, normal.v});
    Vec3f all{}, joined{};
    for (const auto& [wedge, sum] : together) all = all + sum;
    const auto apart = [&](Vec3f sum) { return length(sum) > 0 ? angle(sum, all) : 0; };
    for (const auto& [wedge, sum] : together) {
      if (std::abs(apart(sum) - 30) < 0.01) return std::nullopt;
      if (apart(sum) < 30) joined = joined + sum;
    }
    return apart(together.at(id)) < 30 ? joined : together.at(id);
  }
};
Sums sums_of(const Case& c) {
  Sums sums;
  for (const CoarseCell& cell : c.cells)
    for (std::size_t i = 0; i < cell.id.size(); ++i)
      sums.add(cell.id[i], cell.vertex[i], cell.normals[i], cell.sums[i]);
  return sums;
}

// Turned by hand: in the plane of both, to 20 degrees, from 60 on all the way.
void expect_turned(PackedNormal before, PackedNormal after, Vec3f sum) {
  const Vec3f was = unpack_normal(before), is = unpack_normal(after);
  const double off = angle(was, sum), radians = 57.29578;
  if (!(length(sum) > 0) || off < 19.99) {
    EXPECT_EQ(before, after);
  } else if (off > 20.01) {
    const double share = std::max(std::cos(off / radians) - 0.5, 0.0) / (std::cos(20 / radians) - 0.5);
    const double kept = radians * std::atan(share * std::tan(20 / radians));
    EXPECT_NEAR(angle(is, sum), kept, 0.02);
    if (off < 179) {
      EXPECT_NEAR(angle(was, is), off - kept, 0.05);
    }
  }
}

// Returns the number of normals that were turned.
std::size_t test_case(BlockNormals& normals, Case c, bool wedges) {
  const Case before = c;
  const Sums sums = sums_of(c);
  BlockNormals::Block block{c.locked, {}, 0};
  if (wedges) block.vertex = c.vertex, block.vertices = 302;
  normals.begin(block);
  for (CoarseCell& cell : c.cells)
    normals.add({cell.normals,
                 cell.sums,
                 {},
                 {},
                 wedges ? std::span<const std::uint32_t>(cell.vertex) : std::span<const std::uint32_t>(),
                 cell.shared});
  normals.finish();
  std::size_t turned = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < c.cells[k].id.size(); ++i) {
      const PackedNormal was = before.cells[k].normals[i], is = c.cells[k].normals[i];
      turned += was != is;
      if (c.locked[c.cells[k].id[i]])
        EXPECT_EQ(was, is);
      else if (const auto towards = sums.towards(c.cells[k].id[i], c.cells[k].vertex[i], was))
        expect_turned(was, is, *towards);
    }
  }
  return turned;
}

TEST(BlockNormals, AreTurnedAsByHand) {
  std::mt19937 random(7);
  for (const bool wedges : {false, true}) {
    BlockNormals normals;  // keeps its memory from case to case
    for (int k = 0; k < 20; ++k) EXPECT_GT(test_case(normals, random_case(random, wedges), wedges), 100u);
  }
}

TEST(BlockNormals, AreNoneInAnEmptyCell) {
  BlockNormals normals;
  normals.begin({});
  normals.add({});
  normals.finish();
}

}  // namespace
}  // namespace lodestone
