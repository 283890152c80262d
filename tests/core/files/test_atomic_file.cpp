#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/atomic_folder.h"
#include "tests/expect_error.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public FolderTest {};

std::span<const std::byte> bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

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

TEST_F(AtomicFileTest, SeveralProcessesWriteIt) {
  const fs::path target = folder_ / "a";
  AtomicFile file(target);
  file.reserve(6);
  {
    AtomicFile part(target, file.written_path());
    part.write_at(3, bytes("def"));
    part.commit();
  }
  { const AtomicFile abandoned(target, file.written_path()); }
  EXPECT_FALSE(fs::exists(target));
  file.write_at(0, bytes("abc"));
  file.commit();
  EXPECT_EQ(content(target), "abcdef");
  EXPECT_EQ(files(), 1u);
  expect_error_of<FileError>([&] { AtomicFile(target, folder_ / "gone"); }, {"a: cannot open", "gone"});
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

TEST_F(AtomicFileTest, ReservedRoomIsWhatIsWritten) {
  const fs::path target = folder_ / "a";
  AtomicFile file(target);
  file.reserve(10);
  file.write_at(5, bytes("world"));
  file.write_at(0, bytes("hello"));
  file.commit();
  EXPECT_EQ(content(target), "helloworld");
}

TEST_F(AtomicFileTest, MoreRoomThanThereIsIsAnErrorBeforeAnyWork) {
  const fs::path target = folder_ / "a";
  {
    AtomicFile file(target);
    expect_error_of<FileError>([&] { file.reserve(std::uint64_t{1} << 62); }, {target.string()});
  }
  EXPECT_EQ(files(), 0u);
}

TEST_F(AtomicFileTest, UnwritableTargetsNameTheFile) {
  for (const fs::path& target : {folder_ / "missing" / "a", folder_})
    expect_error_of<FileError>([&] { AtomicFile file(target); }, {target.string()});
  EXPECT_EQ(files(), 0u);
}

// ---- a process that a signal ends ----

void end_process(int signal) {
  remove_temporaries();
  std::_Exit(signal);
}

// Finished files stay, however many others there are.
TEST_F(AtomicFileTest, TemporariesGoWhenTheProcessIsAboutToEnd) {
  EXPECT_EXIT(
      {
        AtomicFile finished(folder_ / "finished");
        finished.commit();
        std::vector<std::unique_ptr<AtomicFile>> open;
        for (int i = 0; i < 100; ++i) open.push_back(std::make_unique<AtomicFile>(folder_ / std::to_string(i)));
        open[7]->write(bytes("half of it"));
        open[7]->flush();
        { AtomicFile abandoned(folder_ / "abandoned"); }
        open.erase(open.begin() + 50);
        if (files() == 100) end_process(3);
      },
      testing::ExitedWithCode(3), "");
  EXPECT_EQ(files(), 1u);
  EXPECT_TRUE(fs::exists(folder_ / "finished"));
}

constexpr std::size_t piece_bytes = 100'000;

// Files made, written, finished or given up, one after the other; never returns.
[[noreturn]] void write_for_ever(const fs::path& folder, int thread) {
  for (unsigned i = 0;; ++i) {
    AtomicFile file(folder / (std::to_string(thread) + "." + std::to_string(i % 3)));
    file.write(bytes(std::string(piece_bytes, 'x')));
    file.flush();
    if (i % 4 != 3) file.commit();
  }
}

// The child of a fork: three threads write. With `elsewhere` the signal is not taken by the thread that began, which
// waits, but by one that is in the middle of writing while others are, too.
[[noreturn]] void run_child(const fs::path& folder, bool elsewhere) {
  for (const int number : {SIGINT, SIGTERM}) signal(number, end_process);
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) threads.emplace_back(write_for_ever, folder, t);
  sigset_t all;
  sigfillset(&all);
  if (elsewhere) pthread_sigmask(SIG_BLOCK, &all, nullptr);
  for (;;) pause();
}

// At random moments, and always at once with others: the handler runs beside creating, renaming and removing.
TEST_F(AtomicFileTest, SignalsAtAnyMomentLeaveNoTemporary) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) run_child(folder_, trial % 2 == 1);
    while (files() == 0) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 5000));
    const int signal = trial % 3 == 0 ? SIGTERM : SIGINT;
    kill(child, signal);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == signal) << status;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      EXPECT_EQ(entry.path().filename().string().find(".tmp."), std::string::npos) << entry << " in trial " << trial;
      EXPECT_EQ(fs::file_size(entry), piece_bytes) << entry;
      fs::remove(entry);
    }
  }
}

// ---- what killed processes leave ----

// In a process that is killed while it writes a file and a folder.
void leave_orphans(const fs::path& folder) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    AtomicFile file(folder / "a");
    file.write(bytes("half of it"));
    AtomicFolder tiles(folder / "tiles"), inside(folder / "there");
    for (const AtomicFolder* one : {&tiles, &inside}) {
      fs::create_directories(one->path() / "0" / "1");
      std::ofstream(one->path() / "0" / "1" / "b") << "half of it";
    }
    kill(getpid(), SIGKILL);
  }
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
}

TEST_F(AtomicFileTest, OrphansAreThoseOfKilledProcesses) {
  fs::create_directory(folder_ / "there");
  leave_orphans(folder_);
  EXPECT_EQ(files(), 3u);
  EXPECT_FALSE(fs::is_empty(folder_ / "there"));
  std::ofstream(folder_ / "a.tmp.notes") << "mine";
  AtomicFile alive(folder_ / "a");
  remove_orphans(folder_ / "a");
  EXPECT_EQ(files(), 4u) << "there, tiles, notes and the one that is being written";
  alive.commit();
  EXPECT_TRUE(fs::exists(folder_ / "a.tmp.notes"));
  for (const char* name : {"tiles", "there"}) {
    AtomicFolder folder(folder_ / name);
    std::ofstream(folder.path() / "b") << "whole";
    folder.commit();
    EXPECT_EQ(content(folder_ / name / "b"), "whole");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / name), fs::directory_iterator()), 1);
  }
  EXPECT_EQ(files(), 4u) << "a, notes, there, tiles";
}

// In a container a process may have the number of one that was killed.
TEST_F(AtomicFileTest, NamesThatOrphansHaveAreNotTaken) {
  std::string taken;
  {
    AtomicFile probe(folder_ / "a");
    taken = fs::directory_iterator(folder_)->path().filename().string();
  }
  const std::size_t dot = taken.rfind('.');
  for (int k = 1; k < 4; ++k)
    std::ofstream(folder_ / (taken.substr(0, dot + 1) + std::to_string(std::stoi(taken.substr(dot + 1)) + k))) << "old";
  AtomicFile file(folder_ / "a");
  file.write(bytes("new"));
  file.commit();
  EXPECT_EQ(content(folder_ / "a"), "new");
  EXPECT_EQ(files(), 4u);
}

TEST_F(AtomicFileTest, FoldersGoWithAllThatTheyHold) {
  {
    AtomicFolder folder(folder_ / "tiles");
    for (int k = 0; k < 300; ++k) {  // more than a system call lists
      fs::create_directories(folder.path() / std::to_string(k) / "inner");
      std::ofstream(folder.path() / std::to_string(k) / "inner" / "file") << k;
    }
    fs::create_symlink(folder_, folder.path() / "link");
    std::ofstream(folder_ / "kept") << "by whom the link leads to";
  }
  EXPECT_EQ(files(), 1u);
}

TEST_F(AtomicFileTest, FoldersGoWhenTheProcessIsAboutToEnd) {
  EXPECT_EXIT(
      {
        AtomicFolder folder(folder_ / "tiles");
        std::ofstream(folder.path() / "a") << "half of it";
        end_process(3);
      },
      testing::ExitedWithCode(3), "");
  EXPECT_EQ(files(), 0u);
}

}  // namespace
}  // namespace lodestone
