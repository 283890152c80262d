#include <algorithm>
#include <mutex>
#include <utility>

#include "parallel/scheduler/scheduler.h"

namespace lodestone {
namespace {

// Loops and graphs that the calling thread is inside of.
thread_local int depth = 0;

struct Inside {
  Inside() { ++depth; }
  ~Inside() { --depth; }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
};

class WatchedScheduler final : public Scheduler {
 public:
  WatchedScheduler(Scheduler& inner, Watch watch) : inner_(inner), watch_(std::move(watch)) {}

  [[nodiscard]] int workers() const override { return inner_.workers(); }
  [[nodiscard]] int worker_index() const override { return inner_.worker_index(); }
  void name_work(std::string_view name) override {
    work_ = name;
    inner_.name_work(name);
  }

  void for_chunks(std::size_t count, std::size_t grain, const std::function<void(ChunkRange)>& body) override {
    const bool outer = begin(count);
    inner_.for_chunks(count, grain, [&](ChunkRange range) {
      check();
      const Inside inside;
      body(range);
      if (outer) add(range.end - range.begin);
    });
  }

  void run_graph(const TaskGraph& graph, const std::function<void(std::uint32_t)>& body,
                 const CancelFlag* cancel) override {
    const bool outer = begin(graph.task_count);
    inner_.run_graph(
        graph,
        [&](std::uint32_t task) {
          check();
          const Inside inside;
          body(task);
          if (outer) add(1);
        },
        cancel);
  }

 private:
  void check() const {
    if (watch_.cancel && *watch_.cancel) throw Cancelled{};
  }

  // True if the progress is told of this loop.
  bool begin(std::size_t count) {
    check();
    if (depth > 0 || !watch_.progress) return false;
    const std::scoped_lock lock(mutex_);
    count_ = count, done_ = 0, told_ = 0;
    return true;
  }

  void add(std::size_t items) {
    const std::scoped_lock lock(mutex_);
    done_ += items;
    const std::size_t hundredths = 100 * done_ / std::max<std::size_t>(count_, 1);
    if (hundredths == told_) return;
    told_ = hundredths;
    watch_.progress(work_, static_cast<double>(done_) / static_cast<double>(count_));
  }

  Scheduler& inner_;
  Watch watch_;
  std::string work_;
  std::mutex mutex_;
  std::size_t count_ = 0, done_ = 0, told_ = 0;
};

}  // namespace

std::unique_ptr<Scheduler> make_watched_scheduler(Scheduler& inner, Watch watch) {
  return std::make_unique<WatchedScheduler>(inner, std::move(watch));
}

}  // namespace lodestone
