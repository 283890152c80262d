// Sizes as people write them.
#include <gtest/gtest.h>

#include "core/base/byte_size.h"

namespace lodestone {
namespace {

TEST(ByteSize, KnowsDecimalAndBinaryUnitsInAnyCase) {
  EXPECT_EQ(parse_byte_size("1048576"), 1048576u);
  EXPECT_EQ(parse_byte_size("12B"), 12u);
  EXPECT_EQ(parse_byte_size("2GiB"), std::uint64_t{2} << 30);
  EXPECT_EQ(parse_byte_size("4G"), std::uint64_t{4} << 30);
  EXPECT_EQ(parse_byte_size("1.5k"), 1536u);
  EXPECT_EQ(parse_byte_size("1500MB"), 1'500'000'000u);
  EXPECT_EQ(parse_byte_size("3kb"), 3000u);
  EXPECT_EQ(parse_byte_size("1tib"), std::uint64_t{1} << 40);
  EXPECT_EQ(parse_byte_size("1TB"), 1'000'000'000'000u);
}

TEST(ByteSize, RefusesEverythingElse) {
  for (const char* text : {"", "plenty", "GiB", "0", "-1", "nan", "inf", "1 GiB", "1GiBs", "1iB", "1PiB", "1Kib/s",
                           "9e18B1", "9223372036854775808", "8388608TiB"})
    EXPECT_EQ(parse_byte_size(text), std::nullopt) << text;
}

TEST(ByteSize, ANeedIsNeverPrintedAsWhatThereIs) {
  constexpr std::uint64_t mebibyte = 1u << 20;
  EXPECT_EQ(needed_mebibytes(97 * mebibyte), "97 MiB");
  EXPECT_EQ(needed_mebibytes(97 * mebibyte + 1), "98 MiB");
  EXPECT_EQ(available_mebibytes(97 * mebibyte), "97 MiB");
  EXPECT_EQ(available_mebibytes(98 * mebibyte - 1), "97.99 MiB");
  for (const std::uint64_t available : {1000u, 5'000'000u, 101'711'871u, 101'711'872u})
    EXPECT_NE(needed_mebibytes(available + 1), available_mebibytes(available));
}

}  // namespace
}  // namespace lodestone
