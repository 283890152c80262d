// Parts of the sweep engine: hashes, remembered content, processors, the share done, what a row may hold.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>

#include "core/base/error.h"
#include "experiments/command_line/version.h"
#include "experiments/studies/experiment.h"
#include "experiments/sweep/inputs.h"
#include "experiments/sweep/processor_claim.h"
#include "experiments/sweep/program_identity.h"
#include "experiments/sweep/run_child.h"
#include "experiments/sweep/sha256.h"
#include "experiments/sweep/time_left.h"
#include "render/backends/gl/device/graphics_driver.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// The examples of nist2015's companion; texts and files have one hash.
TEST(Sha256, KnownAnswers) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  const TestFolder folder;
  const fs::path file = folder / "text";
  for (std::size_t length = 0; length < 200; ++length) {
    const std::string text(length, 'x');
    std::ofstream(file) << text;
    EXPECT_EQ(sha256_of_file(file), sha256(text)) << length;
  }
}

TEST(ContentHashes, AreRememberedUntilTheFileChanges) {
  const TestFolder folder;
  const fs::path file = folder / "a.txt", memory = folder / "hashes.json";
  std::ofstream(file) << "abc";
  {
    ContentHashes fresh(memory);
    EXPECT_EQ(fresh.of(file).sha256, sha256("abc"));
    fresh.save();
    EXPECT_FALSE(fs::exists(memory)) << "a file that has changed just now could change again unseen";
  }
  std::ofstream(folder / "b.txt") << "abd";
  EXPECT_EQ(ContentHashes(memory).of(folder / "b.txt").sha256, sha256("abd"));
  EXPECT_THROW((void)ContentHashes(memory).of(folder / "none"), FileError);
  std::ofstream(memory) << "no json";
  EXPECT_EQ(ContentHashes(memory).of(file).sha256, sha256("abc"));
}

TEST(ContentHashes, BelieveTheirMemoryAsLongAsTimesAndSizeAgree) {
  const TestFolder folder;
  const fs::path file = folder / "a.txt", memory = folder / "hashes.json";
  std::ofstream(file) << "abc";
  struct stat status {};
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  const Json key = {status.st_size,         status.st_ino,         status.st_mtim.tv_sec,
                    status.st_mtim.tv_nsec, status.st_ctim.tv_sec, status.st_ctim.tv_nsec};
  std::ofstream(memory) << Json{{file.string(), {{"key", key}, {"sha256", "remembered"}}}}.dump();
  EXPECT_EQ(ContentHashes(memory).of(file).sha256, "remembered");
  std::ofstream(file) << "abcd";
  EXPECT_EQ(ContentHashes(memory).of(file).sha256, sha256("abcd"));
}

TEST(ContentHashes, KnowWhichFilesHaveChangedSince) {
  const TestFolder folder;
  const fs::path set = folder / "set";
  fs::create_directories(set / "deep");
  std::ofstream(set / "a") << "1";
  std::ofstream(set / "deep" / "b") << "2";
  const auto hashed = [&](const fs::path& path) { return ContentHashes(folder / "hashes.json").of(path); };
  SweepInput input = hashed(set);
  EXPECT_FALSE(changed_file(input));
  EXPECT_FALSE(changed_file({})) << "not yet made";
  poll(nullptr, 0, 20);  // times are no finer than a tick of the system
  std::ofstream(set / "deep" / "b") << "3";
  EXPECT_EQ(changed_file(input), (set / "deep" / "b").string());
  input = hashed(set);
  std::ofstream(set / "c") << "4";
  EXPECT_EQ(changed_file(input), (set / "c").string());
  input = hashed(set / "a");
  fs::rename(set / "c", set / "a");
  EXPECT_EQ(changed_file(input), (set / "a").string());
  input = hashed(set / "a");
  fs::remove(set / "a");
  EXPECT_EQ(changed_file(input), (set / "a").string());
}

TEST(ContentHashes, OfFoldersKnowNamesAndContents) {
  const TestFolder folder;
  const fs::path set = folder / "set";
  fs::create_directories(set / "deep");
  std::ofstream(set / "a") << "1";
  std::ofstream(set / "deep" / "b") << "2";
  const auto hash = [&] { return ContentHashes(folder / "hashes.json").of(set).sha256; };
  const std::string before = hash();
  EXPECT_EQ(before.size(), 64u);
  EXPECT_EQ(hash(), before);
  fs::rename(set / "a", set / "c");
  const std::string renamed = hash();
  EXPECT_NE(renamed, before);
  std::ofstream(set / "deep" / "b") << "3";
  EXPECT_NE(hash(), renamed);
}

TEST(ProgramIdentity, IsOneHash) {
  EXPECT_EQ(program_hash().size(), 64u);
  EXPECT_EQ(program_hash(), program_hash());
  for (const char* key : {"program", "version", "commit", "dirty", "compiler", "flags", "build_type"})
    EXPECT_TRUE(program_facts().contains(key)) << key;
}

bool has(const std::vector<LoadedLibrary>& libraries, const std::string& name) {
  return std::any_of(libraries.begin(), libraries.end(), [&](const LoadedLibrary& library) {
    return fs::path(library.path).filename().string().starts_with(name);
  });
}

TEST(Libraries, AreKnownByWhatIdentifiesThem) {
  const std::vector<LoadedLibrary> loaded = loaded_libraries(), deciding = deciding_libraries();
  EXPECT_TRUE(has(loaded, "libc.so"));
  EXPECT_FALSE(has(deciding, "libc.so")) << "security updates replace it often";
  EXPECT_EQ(has(deciding, "libtbb.so"), has(loaded, "libtbb.so")) << "which is not there in a build without oneTBB";
  EXPECT_TRUE(has(deciding, "libmeshoptimizer.so"));
  for (const LoadedLibrary& library : loaded) EXPECT_GE(library.identity.size(), 16u) << library.path;
  for (const LoadedLibrary& library : deciding) EXPECT_TRUE(has(loaded, fs::path(library.path).filename().string()));
}

TEST(Libraries, OnesThatAreLoadedLaterDoNotDecide) {
  const std::size_t deciding = deciding_libraries().size(), loaded = loaded_libraries().size();
  void* const opened = dlopen("libEGL.so.1", RTLD_NOW);
  if (!opened) GTEST_SKIP() << "no libEGL here";
  EXPECT_GT(loaded_libraries().size(), loaded);
  EXPECT_EQ(deciding_libraries().size(), deciding);
  dlclose(opened);
}

TEST(GraphicsDriver, IsTheLastThatWasAsked) {
  note_graphics_driver({"vendor", "first", "1"});
  note_graphics_driver({"vendor", "second", "2"});
  ASSERT_TRUE(last_graphics_driver());
  EXPECT_EQ(last_graphics_driver()->renderer, "second");
}

TEST(ProgramIdentity, CommitIsWhatLooksLikeOne) {
  const std::string hash(40, 'a');
  set_program_commit(hash);
  EXPECT_EQ(program_commit().hash, hash);
  EXPECT_FALSE(program_commit().dirty);
  set_program_commit(hash + " dirty");
  EXPECT_EQ(program_commit().hash, hash);
  EXPECT_TRUE(program_commit().dirty);
  for (const char* other : {"unknown", "", "abc", "fatal: not a git repository"}) {
    set_program_commit(other);
    EXPECT_EQ(program_commit().hash, "unknown") << other;
    EXPECT_FALSE(program_commit().dirty);
  }
}

TEST(ProcessorClaim, NobodyHasOneTwice) {
  const std::vector<int> allowed = {9001, 9002, 9003};  // that no machine has: nobody else claims them
  const ProcessorClaim first(1, allowed);
  EXPECT_EQ(first.processors(), std::vector<int>{9001});
  {
    const ProcessorClaim second(2, allowed);
    EXPECT_EQ(second.processors(), (std::vector<int>{9002, 9003}));
    EXPECT_TRUE(ProcessorClaim(1, allowed).processors().empty());
  }
  EXPECT_TRUE(ProcessorClaim(3, allowed).processors().empty());
  EXPECT_EQ(ProcessorClaim(1, allowed).processors(), std::vector<int>{9002}) << "what was too few was given back";
  EXPECT_TRUE(ProcessorClaim(0, allowed).processors().empty()) << "all of them, and one is taken";
}

TEST(ProcessorClaim, IsOfAllForNoNumberAndInTheirOrder) {
  const std::vector<int> allowed = {9006, 9004, 9005};
  const ProcessorClaim all(0, allowed);
  EXPECT_EQ(all.processors(), allowed);
  EXPECT_TRUE(ProcessorClaim(1, allowed).processors().empty());
}

TEST(TimeLeft, ExpectsWhatWasMeasured) {
  TimeLeft left;
  for (const std::size_t run : {0, 0, 1, 1}) left.expected(run);
  EXPECT_EQ(left.share(0, 0.5), 0.125) << "nothing is known but shares";
  left.ended(0, 3.0, true);
  EXPECT_DOUBLE_EQ(left.of(1), 3) << "the mean";
  EXPECT_DOUBLE_EQ(left.share(0, 0), 3.0 / 12);
  left.ended(1, 1.0, true);
  EXPECT_DOUBLE_EQ(left.share(0, 0), 4.0 / 8);
  EXPECT_DOUBLE_EQ(left.share(2, 0.9), 6.0 / 8);
  left.ended(0, 3.0, true);
  left.ended(1, 1.0, true);
  EXPECT_DOUBLE_EQ(left.share(0, 0), 1);

  TimeLeft resumed;
  resumed.ended(0, 5.0, false);  // in an earlier session
  resumed.expected(0);
  EXPECT_DOUBLE_EQ(resumed.share(0, 0), 0);
  EXPECT_DOUBLE_EQ(resumed.share(2, 0), 0.4);
}

TEST(Rows, FaultyValuesAreNamed) {
  const Experiment probe = probe_experiment();
  EXPECT_TRUE(faulty_values(probe, {{{"number", 1}, {"multiple", nullptr}}, Row::object()}).empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [row, part] :
       std::vector<std::pair<Row, std::string>>{{Row::array(), "row 0 is not an object"},
                                                {{{"other", 1}}, "other is not a column of probe"},
                                                {{{"multiple", nan}}, "multiple is not finite"},
                                                {{{"multiple", {1, 2}}}, "not a single value"}}) {
    const std::vector<std::string> wrong = faulty_values(probe, {row});
    ASSERT_EQ(wrong.size(), 1u) << row.dump();
    EXPECT_NE(wrong[0].find(part), std::string::npos) << wrong[0];
  }
}

}  // namespace
}  // namespace lodestone
