#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "core/io/atomic_file.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
 protected:
  AtomicFileTest()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("atomic_") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~AtomicFileTest() override { fs::remove_all(folder_); }

  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }
  fs::path folder_;
};

std::span<const std::byte> bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(AtomicFileTest, AppearsOnCommitOnly) {
  const fs::path target = folder_ / "a";
  AtomicFile file(target);
  file.write(bytes("hello"));
  file.flush();
  EXPECT_FALSE(fs::exists(target));
  file.commit();
  EXPECT_EQ(content(target), "hello");
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFileTest, LeavesNothingWhenAbandoned) {
  const fs::path target = folder_ / "a";
  std::ofstream(target) << "old";
  {
    AtomicFile file(target);
    file.write(bytes("new"));
  }
  EXPECT_EQ(content(target), "old");
  EXPECT_EQ(files(), 1u);
}

// What the handler of a signal does before it ends the process. Finished files stay.
TEST_F(AtomicFileTest, TemporariesGoWhenTheProcessIsAboutToEnd) {
  AtomicFile finished(folder_ / "finished");
  finished.commit();
  AtomicFile a(folder_ / "a"), b(folder_ / "b");
  a.write(bytes("half of it"));
  a.flush();
  { AtomicFile abandoned(folder_ / "c"); }
  EXPECT_EQ(files(), 3u);
  remove_temporaries();
  EXPECT_EQ(files(), 1u);
  EXPECT_TRUE(fs::exists(folder_ / "finished"));
}

TEST_F(AtomicFileTest, SmallAndLargePiecesKeepTheirOrder) {
  std::string expected;
  AtomicFile file(folder_ / "a");
  for (std::size_t size : {1ul, 700'000ul, 700'000ul, 3'000'000ul, 5ul, 1ul << 20, 1ul}) {
    const std::string piece(size, static_cast<char>('a' + expected.size() % 26));
    file.write(bytes(piece));
    expected += piece;
    EXPECT_EQ(file.position(), expected.size());
  }
  file.commit();
  EXPECT_EQ(content(folder_ / "a"), expected);
}

TEST_F(AtomicFileTest, ThreadsWriteDisjointRanges) {
  AtomicFile file(folder_ / "a");
  file.write(bytes("head"));
  std::vector<std::thread> threads;
  for (int k = 3; k >= 0; --k)
    threads.emplace_back([&file, k] {
      file.write_at(4u + 2u * static_cast<unsigned>(k), bytes(std::string(2, static_cast<char>('0' + k))));
    });
  for (std::thread& thread : threads) thread.join();
  file.commit();
  EXPECT_EQ(content(folder_ / "a"), "head00112233");
}

TEST_F(AtomicFileTest, FollowsSymbolicLinks) {
  fs::create_directory(folder_ / "real");
  std::ofstream(folder_ / "real" / "a") << "old";
  fs::create_symlink(folder_ / "real" / "a", folder_ / "link");
  AtomicFile file(folder_ / "link");
  file.write(bytes("new"));
  file.commit();
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(content(folder_ / "real" / "a"), "new");
}

TEST_F(AtomicFileTest, DevicesAreWrittenToNotReplaced) {
  AtomicFile file("/dev/null");
  file.write(bytes("x"));
  file.commit();
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(AtomicFileTest, FullDiskIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  AtomicFile file("/dev/full");
  file.write(bytes("x"));
  EXPECT_THROW(file.commit(), FileError);
}

TEST_F(AtomicFileTest, UnwritableTargetsNameTheFile) {
  for (const fs::path& target : {folder_ / "missing" / "a", folder_}) {
    try {
      AtomicFile file(target);
      ADD_FAILURE() << target;
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(target.string()), std::string::npos);
    }
  }
  EXPECT_EQ(files(), 0u);
}

}  // namespace
}  // namespace lodestone
