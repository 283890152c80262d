// Builds by several ranks of which one fails, anywhere: an error that names it, and no file.
#include <gtest/gtest.h>

#include <atomic>

#include "tests/expect_error.h"
#include "tests/parallel/distributed/distributed.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using testing::Distributed;

class DistributedFaults : public Distributed {
 protected:
  DistributedFaults() : stream_(open_mesh_stream(mesh(test::raw_of(test::sphere_mesh(4))))) {}

  // Builds with something that happens at message `at` of rank 1; returns the number of messages that it sends.
  template <class Fault>
  int build_with_fault(int at, const Fault& fault) {
    std::atomic<int> sent{0};
    const LocalRanksConfig local{.timeout_seconds = 0.5, .on_send = [&](int from, int, Message& message) {
                                   return from != 1 || sent++ != at || fault(message);
                                 }};
    (void)build(stream_, 3, 0, local);
    return sent;
  }
  // The input, and no other file.
  void expect_no_output() const { EXPECT_EQ(files(), 1u); }

  const std::shared_ptr<const MeshStream> stream_;
};

TEST_F(DistributedFaults, ARankThatFailsAnywhereEndsTheJob) {
  const int messages = build_with_fault(-1, [](Message&) { return true; });
  fs::remove(config_.output);
  for (int at = 0; at < messages; at += 1 + messages / 40) {
    expect_error_of<FileError>(
        [&] { build_with_fault(at, [](Message&) -> bool { throw FileError("scan.ply: cannot read: I/O error"); }); },
        {"rank 1 on this process", "scan.ply: cannot read"});
    expect_no_output();
  }
}

TEST_F(DistributedFaults, LostAndDamagedMessagesEndTheJobInTime) {
  const int messages = build_with_fault(-1, [](Message&) { return true; });
  fs::remove(config_.output);
  for (const int at : {0, messages / 3, messages / 2, messages - 2}) {
    EXPECT_THROW(build_with_fault(at, [](Message&) { return false; }), Error);
    EXPECT_THROW(build_with_fault(at, [](Message& m) { return m.pop_back(), true; }), Error);
    expect_no_output();
  }
}

TEST_F(DistributedFaults, AFullDiskEndsTheJob) {
  config_.output = "/dev/full";
  expect_error_of<FileError>([&] { (void)build(stream_, 3, 0); }, {"/dev/full", "No space left"});
}

TEST_F(DistributedFaults, AnOutputThatCannotBeWrittenEndsTheJob) {
  config_.output = folder_ / "missing" / "m.lode";
  expect_error_of<FileError>([&] { (void)build(stream_, 3, 0); }, {"rank 0 on this process", "m.lode: cannot create"});
}

TEST_F(DistributedFaults, AFileThatIsCutShortEndsTheJob) {
  fs::resize_file(folder_ / "m.ply", fs::file_size(folder_ / "m.ply") - 20);
  expect_error_of<InputError>([&] { (void)build(stream_, 3, 0); },
                              {"rank 2 on this process", "m.ply", "the file ends here"});
  expect_no_output();
}

TEST_F(DistributedFaults, AMeshWithoutTrianglesIsRefused) {
  RawMesh raw = test::raw_of(test::sphere_mesh(1));
  for (Triangle& t : raw.triangles) t.v[1] = t.v[0];
  expect_error_of<InputError>([&] { (void)build(open_mesh_stream(mesh(raw)), 3, 0); }, {"no triangle"});
}

}  // namespace
}  // namespace lodestone
