// Temporary files: what is written is read, what has no name leaves nothing, and what the file system refuses is said.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "core/files/scratch_file.h"
#include "tests/expect_error.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class ScratchFileTest : public FolderTest {};

std::vector<std::byte> numbers(std::size_t count, unsigned first) {
  std::vector<std::byte> bytes(count);
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::byte>(first + i);
  return bytes;
}

TEST_F(ScratchFileTest, GivesBackWhatWasWrittenAndHasNoName) {
  const auto file = ScratchFile::nameless(folder_);
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(file->claim(100), 0u);
  EXPECT_EQ(file->claim(50), 100u);
  file->write_at(100, numbers(50, 7));
  file->write_at(0, numbers(100, 1));
  EXPECT_EQ(file->size(), 150u);
  std::vector<std::byte> bytes(50);
  file->read_at(100, bytes);
  EXPECT_EQ(bytes, numbers(50, 7));
  file->read_at(10, bytes);
  EXPECT_EQ(bytes, numbers(50, 11));
}

TEST_F(ScratchFileTest, StaysUnderItsName) {
  {
    const auto file = ScratchFile::named(folder_ / "a");
    file->write_at(file->claim(20), numbers(20, 0));
  }
  const auto file = ScratchFile::named(folder_ / "a");
  EXPECT_EQ(file->size(), 20u);
  EXPECT_EQ(file->claim(1), 20u);
  file->truncate(5);
  EXPECT_EQ(fs::file_size(folder_ / "a"), 5u);
  EXPECT_EQ(file->claim(1), 5u);
}

TEST_F(ScratchFileTest, OneHolderAtATime) {
  const auto first = ScratchFile::named(folder_ / "a");
  EXPECT_TRUE(first->lock());
  EXPECT_FALSE(ScratchFile::named(folder_ / "a")->lock());
}

TEST_F(ScratchFileTest, ErrorsNameTheFileAndARemedy) {
  expect_error_of<FileError>([&] { return ScratchFile::nameless(folder_ / "nowhere"); }, {"nowhere: "});
  expect_error_of<FileError>([&] { return ScratchFile::named(folder_ / "nowhere" / "a"); }, {"create the folder"});
  expect_error_of<FileError>([&] { return free_bytes(folder_ / "nowhere"); }, {"nowhere: "});
  const auto file = ScratchFile::nameless(folder_);
  std::vector<std::byte> bytes(10);
  expect_error_of<FileError>([&] { file->read_at(0, bytes); }, {"temporary data is missing"});
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  expect_error_of<FileError>([&] { ScratchFile::named("/dev/full")->write_at(0, bytes); }, {"free some space"});
}

TEST_F(ScratchFileTest, KnowsTheRoomLeft) { EXPECT_GT(free_bytes(folder_), 0u); }

TEST(Checksum, TellsBytesApart) {
  std::vector<std::byte> bytes = numbers(1000, 0);
  const std::uint64_t sum = checksum(bytes);
  EXPECT_EQ(sum, checksum(numbers(1000, 0)));
  EXPECT_NE(sum, checksum(std::span(bytes).first(999)));
  bytes[500] ^= std::byte{1};
  EXPECT_NE(sum, checksum(bytes));
}

}  // namespace
}  // namespace lodestone
