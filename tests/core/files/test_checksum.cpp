// Check values of the published algorithms.
#include "core/files/checksum.h"

#include <gtest/gtest.h>

#include <string_view>

namespace lodestone {
namespace {

TEST(Checksum, HasThePublishedCheckValues) {
  const std::string_view digits = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(digits))), 0xcbf43926u);
  EXPECT_EQ(crc32({}), 0u);
  EXPECT_EQ(checksum({}), 0x2d06800538d394c2u);
}

}  // namespace
}  // namespace lodestone
