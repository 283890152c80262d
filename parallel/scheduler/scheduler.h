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

// Long calls that are watched: ended from outside, and asked how far they are, whatever they do.
struct Watch {
  const CancelFlag* cancel = nullptr;
  // Gets the name of the work (Scheduler::name_work; empty before the first), and the share that is done of the loop or
  // graph which runs, in [0, 1] and never less than before within one. Called in steps of a hundredth, from any thread
  // but one at a time, outside of nested loops. What it throws ends the work like an exception of the work's own.
  std::function<void(const std::string& work, double share)> progress = {};
};

// Passes all work on to `inner`, and throws Cancelled out of it soon after the flag is set: before the next chunk or
// task. So load_mesh, prepare_mesh, save_lode, load_lode, compare_meshes, make_progressive, reconstruct and every other
// function that takes a scheduler can be cancelled and tell how far it is. Files are written completely or not at all
// then, too. Reading a text file ends within a mebibyte of it; another step that runs on one thread alone ends before
// the flag is noticed. `inner` and the flag outlive the result.
[[nodiscard]] std::unique_ptr<Scheduler> make_watched_scheduler(Scheduler& inner, Watch watch);

}  // namespace lodestone
