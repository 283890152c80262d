// The range coder and the order of splits that .lpm files are written with.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/progressive/lpm/range_coder.h"
#include "core/progressive/lpm/split_order.h"

namespace lodestone {
namespace {

TEST(RangeCoder, GivesBackWhatWasWritten) {
  std::mt19937 random(3);
  std::vector<std::uint32_t> values;
  for (int k = 0; k < 20000; ++k) values.push_back(static_cast<std::uint32_t>(random() >> (random() % 32) >> 1));
  progressive::RangeEncoder encoder;
  progressive::BitModel bit;
  progressive::NumberModel number;
  progressive::SignedModel sign;
  for (const std::uint32_t v : values) {
    encoder.bit(bit, v % 7 == 0 ? 1 : 0);
    number.code(encoder, v);
    encoder.direct(11, v & 0x7ff);
    sign.code(encoder, static_cast<std::int32_t>(v % 1000) - 500);
  }
  const std::vector<std::byte> bytes = encoder.finish();
  progressive::RangeDecoder decoder(bytes);
  bit = {}, number = {}, sign = {};
  for (const std::uint32_t v : values) {
    ASSERT_EQ(decoder.bit(bit), v % 7 == 0 ? 1u : 0u);
    ASSERT_EQ(number.code(decoder, 0), v);
    ASSERT_EQ(decoder.direct(11), v & 0x7ff);
    ASSERT_EQ(sign.code(decoder, 0), static_cast<std::int32_t>(v % 1000) - 500);
  }
}

TEST(RangeCoder, SpendsNearlyNothingOnWhatNeverChanges) {
  progressive::RangeEncoder encoder;
  progressive::BitModel bit;
  for (int k = 0; k < 80000; ++k) encoder.bit(bit, 0);
  EXPECT_LT(encoder.finish().size(), 300u);
}

TEST(SplitOrder, KeepsWhatDependsInOrder) {
  std::mt19937 random(5);
  progressive::SplitSequence splits{.base = 4, .parents = {}, .star_ends = {}, .stars = {}};
  for (std::uint32_t v = 4; v < 2000; ++v) {
    splits.parents.push_back(static_cast<std::uint32_t>(random()) % v);
    splits.stars.push_back(splits.parents.back());
    for (int k = 0; k < 4; ++k) splits.stars.push_back(static_cast<std::uint32_t>(random()) % v);
    splits.star_ends.push_back(static_cast<std::uint32_t>(splits.stars.size()));
  }
  const std::vector<std::uint32_t> number = progressive::order_in_batches(splits, 8);
  std::vector<std::uint32_t> sorted = number, parents(2000);
  std::ranges::sort(sorted);
  std::size_t falls = 0;
  for (std::uint32_t v = 0; v < 2000; ++v) {
    EXPECT_EQ(sorted[v], v);
    if (v < 4) continue;
    for (const std::uint32_t x : splits.star(v - 4)) EXPECT_LT(number[x], number[v]);
    parents[number[v]] = number[splits.parents[v - 4]];
  }
  for (std::uint32_t v = 5; v < 2000; ++v) falls += parents[v] < parents[v - 1];
  EXPECT_LT(falls, 200u);  // of 998 in a random order
  EXPECT_EQ(progressive::order_in_batches(splits, 0)[1999], 1999u);
}

}  // namespace
}  // namespace lodestone
