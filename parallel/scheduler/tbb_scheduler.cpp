// The oneTBB scheduler: an arena of fixed width, parallel_for for chunks, a flow graph of continue nodes for tasks.
#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <mutex>
#include <new>
#include <set>
#include <utility>

#include "parallel/scheduler/scheduler.h"

namespace lodestone {
namespace {

namespace flow = oneapi::tbb::flow;

// oneTBB makes no more threads than the machine has unless a global_control allows it, and of several controls the
// smallest holds. An arena limits its own width anyway, so there is one control for the whole process, there to raise
// only: as wide as the widest scheduler alive. Each scheduler thus gets the workers it was made for, whatever others
// are.
class AllowedThreads {
 public:
  explicit AllowedThreads(int threads) {
    const std::lock_guard lock(shared().mutex);
    mine_ = shared().wanted.insert(threads);
    renew();
  }
  ~AllowedThreads() {
    const std::lock_guard lock(shared().mutex);
    shared().wanted.erase(mine_);
    renew();
  }
  AllowedThreads(const AllowedThreads&) = delete;
  AllowedThreads& operator=(const AllowedThreads&) = delete;

 private:
  using Control = oneapi::tbb::global_control;
  struct Shared {
    std::mutex mutex;
    std::multiset<int> wanted;  // by the schedulers alive
    std::unique_ptr<Control> control;
  };
  static Shared& shared() {
    static Shared instance;
    return instance;
  }
  // Without memory the control remains as it was: a worker more or less changes no result.
  static void renew() {
    Shared& s = shared();
    const int widest = s.wanted.empty() ? 0 : *s.wanted.rbegin();
    try {
      std::unique_ptr<Control> next;
      if (widest > oneapi::tbb::info::default_concurrency())
        next = std::make_unique<Control>(Control::max_allowed_parallelism, static_cast<std::size_t>(widest));
      s.control = std::move(next);
    } catch (const std::bad_alloc&) {
    }
  }
  std::multiset<int>::iterator mine_;
};

class TbbScheduler final : public Scheduler {
 public:
  explicit TbbScheduler(int threads) : allowed_(threads), arena_(threads) {}

  [[nodiscard]] int workers() const override { return arena_.max_concurrency(); }

  [[nodiscard]] int worker_index() const override {
    const int index = oneapi::tbb::this_task_arena::current_thread_index();
    return index < 0 ? 0 : std::min(index, workers() - 1);
  }

  // Isolated: a worker that waits for the last chunks of a nested loop takes no chunk or task of an outer one, which
  // would use the scratch memory of the body that waits.
  void for_chunks(std::size_t count, std::size_t grain, const std::function<void(ChunkRange)>& body) override {
    const auto loop = [&] {
      oneapi::tbb::parallel_for(
          std::size_t{0}, chunk_count(count, grain),
          [&](std::size_t index) {
            body({index * grain, std::min((index + 1) * grain, count), index});
          },
          oneapi::tbb::simple_partitioner{});
    };
    arena_.execute([&] { oneapi::tbb::this_task_arena::isolate(loop); });
  }

  void run_graph(const TaskGraph& graph, const std::function<void(std::uint32_t)>& body,
                 const CancelFlag* cancel) override {
    using Node = flow::continue_node<flow::continue_msg>;
    arena_.execute([&] {
      flow::graph flow_graph;
      std::deque<Node> nodes;  // nodes neither move nor copy
      std::vector<char> has_predecessor(graph.task_count, 0);
      for (std::uint32_t task = 0; task < graph.task_count; ++task) {
        const auto run = [&, task](const flow::continue_msg&) {
          if (cancel && *cancel) throw Cancelled{};
          body(task);
        };
        if (graph.priority.empty()) {
          nodes.emplace_back(flow_graph, run);
        } else {
          nodes.emplace_back(flow_graph, run, static_cast<flow::node_priority_t>(graph.priority[task]));
        }
      }
      for (const auto& [before, after] : graph.edges) {
        flow::make_edge(nodes[before], nodes[after]);
        has_predecessor[after] = 1;
      }
      try {
        for (std::uint32_t task = 0; task < graph.task_count; ++task)
          if (!has_predecessor[task]) nodes[task].try_put(flow::continue_msg{});
      } catch (...) {  // no memory for a task; others run, and need the nodes
        flow_graph.cancel();
        flow_graph.wait_for_all();
        throw;
      }
      flow_graph.wait_for_all();  // rethrows the first exception of a body after the running ones have ended
    });
  }

 private:
  AllowedThreads allowed_;
  mutable oneapi::tbb::task_arena arena_;
};

}  // namespace

std::unique_ptr<Scheduler> make_tbb_scheduler(int threads) {
  if (threads <= 0) threads = oneapi::tbb::info::default_concurrency();
  return std::make_unique<TbbScheduler>(threads);
}

}  // namespace lodestone
