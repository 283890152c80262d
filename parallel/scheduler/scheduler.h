// The whole contract of parallel execution: worker count, chunked loop, task graph, cancellation.
//
// Two schedulers implement it: `serial`, the slow and obvious twin, which passes every test, and `tbb`. How work is
// cut depends on counts and grains alone, never on the number of workers, so that any number gives the same bytes.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lodestone {

struct ChunkRange {
  std::size_t begin = 0, end = 0;
  std::size_t index = 0;  // chunk number, counted from 0: reductions store one partial result per chunk, in this order
};

// Tasks 0..task_count-1 with dependencies; a task runs when all its predecessors have run. Acyclic.
struct TaskGraph {
  std::size_t task_count = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  // (before, after)
  std::vector<int> priority;                                   // one per task, higher first; empty: all equal
  std::function<std::string(std::uint32_t)> label{};           // of a task, for traces; may be empty
  std::function<std::string(std::uint32_t)> place{};           // what a task works on, for traces; may be empty
};

// Set from a signal handler or another thread; polled between tasks and chunks.
using CancelFlag = std::atomic<bool>;

// Thrown out of a scheduler's call when the cancel flag was set.
class Cancelled : public std::exception {
 public:
  [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }
};

class Scheduler {
 public:
  virtual ~Scheduler() = default;
  [[nodiscard]] virtual int workers() const = 0;
  // Index of the calling worker, in [0, workers()): for per-worker scratch memory inside a body.
  [[nodiscard]] virtual int worker_index() const = 0;
  // Names the work of the calls from here on, for traces (parallel/scheduler/trace.h). Not from inside a body.
  virtual void name_work(std::string_view /*name*/) {}

  // Calls body for the chunks [k*grain, min((k+1)*grain, count)). The first exception of a body is rethrown after all
  // running bodies have ended. Nested calls are allowed: a worker that waits for one runs none of the outer bodies.
  virtual void for_chunks(std::size_t count, std::size_t grain, const std::function<void(ChunkRange)>& body) = 0;

  // Runs every task of the graph once. Same rules for exceptions; throws Cancelled when `cancel` becomes true.
  virtual void run_graph(const TaskGraph& graph, const std::function<void(std::uint32_t)>& body,
                         const CancelFlag* cancel = nullptr) = 0;
};

[[nodiscard]] inline std::size_t chunk_count(std::size_t count, std::size_t grain) {
  return (count + grain - 1) / grain;
}

[[nodiscard]] std::unique_ptr<Scheduler> make_serial_scheduler();
// threads = 0: as many as the machine has. More are possible. Any number of schedulers may live and work at
// the same time, each with its own number of workers.
[[nodiscard]] std::unique_ptr<Scheduler> make_tbb_scheduler(int threads = 0);

}  // namespace lodestone
