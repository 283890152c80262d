// The names of mapped files by address, for the handler of SIGBUS (experiments/commands/command.cpp).
#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "core/files/input_file.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

TEST(MappedFile, IsFoundByItsAddresses) {
  const TestFolder folder;
  for (const char* name : {"a", "b"}) std::ofstream(folder / name) << "some bytes of " << name;
  std::optional<MappedFile> a(std::in_place, folder / "a");
  const MappedFile b(folder / "b");
  const std::byte *first = a->bytes().data(), *end = first + a->bytes().size();
  EXPECT_EQ(mapped_file_at(first), (folder / "a").string());
  EXPECT_EQ(mapped_file_at(end - 1), (folder / "a").string());
  EXPECT_EQ(mapped_file_at(b.bytes().data()), (folder / "b").string());
  EXPECT_EQ(mapped_file_at(end), nullptr);
  EXPECT_EQ(mapped_file_at(&folder), nullptr);
  a.reset();
  EXPECT_EQ(mapped_file_at(first), nullptr);
}

}  // namespace
}  // namespace lodestone
