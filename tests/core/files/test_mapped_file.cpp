// The names of mapped files by address, for the handler of SIGBUS (experiments/commands/command.cpp); texts as wholes.
#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "core/base/error.h"
#include "core/files/input_file.h"
#include "core/files/text_file.h"
#include "tests/expect_error.h"
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

TEST(ReadText, IsAllOrAnError) {
  const TestFolder folder;
  for (const std::size_t size : {0u, 1u, 4095u, 4096u, 4097u, 1'000'000u}) {
    const std::string text(size, 'x');
    EXPECT_EQ(read_text(folder.write("a", text)), text);
  }
  expect_error_of<FileError>([&] { (void)read_text(folder / "none"); }, {"none", "cannot be opened for reading"});
  expect_error_of<FileError>([&] { (void)read_text(folder.path()); }, {folder.path().string(), "cannot be read"});
}

}  // namespace
}  // namespace lodestone
