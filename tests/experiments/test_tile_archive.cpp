// The limits of tile archives; their bytes are checked in tests/web/test_archive.mjs.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/base/error.h"
#include "experiments/subjects/tile_archive.h"
#include "tests/expect_error.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

struct TileArchive : FolderTest {
  CancelFlag cancel{false};
  // Without its bytes on the disk.
  fs::path add_file(const std::string& name, std::uint64_t size) {
    fs::create_directories(folder_ / "in");
    std::ofstream(folder_ / "in" / name).put('x');
    fs::resize_file(folder_ / "in" / name, size);
    return folder_ / "in";
  }
};

TEST_F(TileArchive, RefusesFilesThatTheFormatCannotHold) {
  const fs::path in = add_file("large.glb", 0xffff'ffffull);
  expect_error_of<ResourceError>([&] { write_tile_archive(in, folder_ / "out.3tz", cancel); }, {"large.glb", "4 GiB"});
  EXPECT_FALSE(fs::exists(folder_ / "out.3tz"));
}

TEST_F(TileArchive, LeavesNothingWhenCancelled) {
  const fs::path in = add_file("small.glb", 10);
  cancel = true;
  EXPECT_THROW(write_tile_archive(in, folder_ / "out.3tz", cancel), Cancelled);
  EXPECT_FALSE(fs::exists(folder_ / "out.3tz"));
}

}  // namespace
}  // namespace lodestone
