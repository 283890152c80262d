#include "parallel/scheduler/cancelling_scheduler.h"

namespace lodestone {
namespace {

class CancellingScheduler final : public Scheduler {
 public:
  CancellingScheduler(Scheduler& inner, const CancelFlag* cancel) : inner_(inner), cancel_(cancel) {}

  [[nodiscard]] int workers() const override { return inner_.workers(); }
  [[nodiscard]] int worker_index() const override { return inner_.worker_index(); }
  void name_work(std::string_view name) override { inner_.name_work(name); }

  void for_chunks(std::size_t count, std::size_t grain, const std::function<void(ChunkRange)>& body) override {
    inner_.for_chunks(count, grain, [&](ChunkRange range) {
      check();
      body(range);
    });
  }

  void run_graph(const TaskGraph& graph, const std::function<void(std::uint32_t)>& body,
                 const CancelFlag* cancel) override {
    inner_.run_graph(
        graph,
        [&](std::uint32_t task) {
          check();
          body(task);
        },
        cancel);
  }

 private:
  void check() const {
    if (cancel_ && *cancel_) throw Cancelled{};
  }
  Scheduler& inner_;
  const CancelFlag* cancel_;
};

}  // namespace

std::unique_ptr<Scheduler> make_cancelling_scheduler(Scheduler& inner, const CancelFlag* cancel) {
  return std::make_unique<CancellingScheduler>(inner, cancel);
}

}  // namespace lodestone
