// The serial scheduler: the slow obvious twin of every other one.
#include <algorithm>
#include <queue>
#include <utility>

#include "parallel/scheduler/scheduler.h"

namespace lodestone {
namespace {

class SerialScheduler final : public Scheduler {
 public:
  [[nodiscard]] int workers() const override { return 1; }
  [[nodiscard]] int worker_index() const override { return 0; }

  void for_chunks(std::size_t count, std::size_t grain, const std::function<void(ChunkRange)>& body) override {
    for (std::size_t begin = 0, index = 0; begin < count; begin += grain, ++index)
      body({begin, std::min(begin + grain, count), index});
  }

  void run_graph(const TaskGraph& graph, const std::function<void(std::uint32_t)>& body,
                 const CancelFlag* cancel) override {
    std::vector<std::vector<std::uint32_t>> successors(graph.task_count);
    std::vector<std::uint32_t> waiting_for(graph.task_count, 0);
    for (const auto& [before, after] : graph.edges) {
      successors[before].push_back(after);
      ++waiting_for[after];
    }
    // Highest priority first, then the lowest number: a total order.
    std::priority_queue<std::pair<int, std::int64_t>> ready;
    const auto make_ready = [&](std::uint32_t task) {
      ready.emplace(graph.priority.empty() ? 0 : graph.priority[task], -static_cast<std::int64_t>(task));
    };
    for (std::uint32_t task = 0; task < graph.task_count; ++task)
      if (waiting_for[task] == 0) make_ready(task);
    while (!ready.empty()) {
      if (cancel && *cancel) throw Cancelled{};
      const auto task = static_cast<std::uint32_t>(-ready.top().second);
      ready.pop();
      body(task);
      for (const std::uint32_t next : successors[task])
        if (--waiting_for[next] == 0) make_ready(next);
    }
  }
};

}  // namespace

std::unique_ptr<Scheduler> make_serial_scheduler() { return std::make_unique<SerialScheduler>(); }

}  // namespace lodestone
