#include "parallel/hierarchy/verify_threads.h"

#include <algorithm>
#include <atomic>
#include <barrier>
#include <exception>
#include <thread>
#include <vector>

#include "core/hierarchy/model/structure.h"
#include "core/hierarchy/verify/verify_peers.h"

namespace lodestone {
namespace {

using Bytes = VerifyPeers::Bytes;

// By cell: the thread in whose equal part of a level's triangles its family has the middle.
std::vector<std::uint32_t> owners_of(const Hierarchy& hierarchy, std::size_t threads) {
  std::vector<std::uint32_t> owners(hierarchy.cells.size());
  for (std::size_t l = 1; l < hierarchy.levels.size(); ++l) {
    std::uint64_t before = 0;  // twice the triangles
    for (const Cell& parent : hierarchy.cells_of(static_cast<int>(l) - 1)) {
      std::uint64_t own = 0;
      for (CellId c = parent.first_child; c < parent.end_child(); ++c) own += hierarchy.cells[c].triangles.size();
      const std::uint64_t owner = (before + own) * threads / (2 * hierarchy.levels[l].triangles + 1);
      std::fill_n(owners.begin() + parent.first_child, parent.child_count, static_cast<std::uint32_t>(owner));
      before += 2 * own;
    }
  }
  return owners;
}

// Another thread has failed.
struct Stopped {};

class Post {
 public:
  explicit Post(std::size_t peers)
      : sent_(peers, std::vector<Bytes>(peers)), meeting_(static_cast<std::ptrdiff_t>(peers)) {}

  std::vector<Bytes> exchange(std::size_t peer, std::vector<Bytes>&& out) {
    sent_[peer] = std::move(out);
    meet();
    std::vector<Bytes> in;
    for (std::vector<Bytes>& sent : sent_) in.push_back(std::move(sent[peer]));
    meet();
    return in;
  }
  // The others end at the next call.
  void fail() {
    failed_ = true;
    meeting_.arrive_and_drop();
  }

 private:
  void meet() {
    meeting_.arrive_and_wait();
    if (failed_) throw Stopped();
  }

  std::vector<std::vector<Bytes>> sent_;  // by sender, then by receiver
  std::barrier<> meeting_;
  std::atomic<bool> failed_ = false;
};

class ThreadPeer final : public VerifyPeers {
 public:
  ThreadPeer(const std::vector<std::uint32_t>& owners, std::size_t count, std::size_t index, Post& post)
      : owners_(owners), count_(count), index_(index), post_(post) {}
  [[nodiscard]] std::size_t count() const override { return count_; }
  [[nodiscard]] std::size_t index() const override { return index_; }
  [[nodiscard]] std::size_t owner(CellId cell) const override { return owners_[cell]; }
  [[nodiscard]] std::vector<Bytes> exchange(std::vector<Bytes>&& out) override {
    return post_.exchange(index_, std::move(out));
  }

 private:
  const std::vector<std::uint32_t>& owners_;
  std::size_t count_, index_;
  Post& post_;
};

}  // namespace

VerifyReport verify_hierarchy(const Hierarchy& hierarchy, const Scheduler& scheduler, const IndexedMesh* input,
                              const VerifyProgress& progress) {
  const auto count = static_cast<std::size_t>(scheduler.workers());
  if (count < 2 || hierarchy.attributes.wedges || !table_fault(hierarchy).empty())
    return verify_hierarchy(hierarchy, input, progress);
  const std::vector<std::uint32_t> owners = owners_of(hierarchy, count);
  Post post(count);
  VerifyReport report;  // of the calling thread
  std::vector<std::exception_ptr> errors(count);
  const auto verify = [&](std::size_t index) {
    try {
      ThreadPeer peer(owners, count, index, post);
      VerifyReport own = verify_by_peers(hierarchy, peer, input, index == 0 ? progress : VerifyProgress{});
      if (index == 0) report = std::move(own);
    } catch (const Stopped&) {
      post.fail();
    } catch (...) {
      errors[index] = std::current_exception();
      post.fail();
    }
  };
  {
    std::vector<std::jthread> threads;
    std::size_t started = 1;
    try {
      for (; started < count; ++started) threads.emplace_back(verify, started);
      verify(0);
    } catch (...) {  // no thread more: those that have begun must not wait for the others
      errors[0] = std::current_exception();
      for (std::size_t i = started; i <= count; ++i) post.fail();
    }
  }
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  return report;
}

}  // namespace lodestone
