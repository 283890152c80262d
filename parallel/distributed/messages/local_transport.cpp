#include "parallel/distributed/messages/local_transport.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace lodestone {
namespace {

// The queues between all pairs of ranks, and the first failure.
class LocalNetwork {
 public:
  LocalNetwork(int count, const LocalRanksConfig& config)
      : count_(static_cast<std::size_t>(count)), config_(config), queues_(count_ * count_) {}

  void send(int from, int to, Message&& message) {
    if (config_.on_send && !config_.on_send(from, to, message)) return;
    {
      const std::lock_guard lock(mutex_);
      queue(from, to).push_back(std::move(message));
    }
    changed_.notify_all();
  }

  [[nodiscard]] Message receive(int from, int to) {
    std::unique_lock lock(mutex_);
    std::deque<Message>& waiting = queue(from, to);
    const bool in_time = changed_.wait_for(lock, std::chrono::duration<double>(config_.timeout_seconds),
                                           [&] { return failure_ || !waiting.empty(); });
    if (failure_) std::rethrow_exception(failure_->error());
    if (!in_time) throw silent_rank(from, host(), config_.timeout_seconds);
    Message message = std::move(waiting.front());
    waiting.pop_front();
    return message;
  }

  void fail(const RankFailure& failure) {
    {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = failure;
    }
    changed_.notify_all();
  }

  [[nodiscard]] std::optional<RankFailure> failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
  }
  [[nodiscard]] int count() const { return static_cast<int>(count_); }
  [[nodiscard]] const std::string& host() const { return host_; }

 private:
  [[nodiscard]] std::deque<Message>& queue(int from, int to) {
    return queues_[static_cast<std::size_t>(from) * count_ + static_cast<std::size_t>(to)];
  }

  std::size_t count_;
  const LocalRanksConfig& config_;
  const std::string host_ = "this process";
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::deque<Message>> queues_;
  std::optional<RankFailure> failure_;
};

class LocalTransport final : public Transport {
 public:
  LocalTransport(LocalNetwork& network, int rank) : network_(network), rank_(rank) {}
  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int ranks() const override { return network_.count(); }
  [[nodiscard]] const std::string& host() const override { return network_.host(); }
  void send(int to, Message&& message) override { network_.send(rank_, to, std::move(message)); }
  [[nodiscard]] Message receive(int from) override { return network_.receive(from, rank_); }
  void fail(const RankFailure& failure) noexcept override { network_.fail(failure); }
  [[nodiscard]] bool failed() const override { return network_.failure().has_value(); }

 private:
  LocalNetwork& network_;
  int rank_;
};

}  // namespace

void run_local_ranks(int count, const std::function<void(Transport&)>& body, const LocalRanksConfig& config) {
  LocalNetwork network(count, config);
  const auto run = [&](int rank) {
    LocalTransport transport(network, rank);
    try {
      run_rank(transport, [&] { body(transport); });
    } catch (const std::exception&) {  // the network knows
    }
  };
  {
    std::vector<std::jthread> threads;
    try {
      for (int rank = 0; rank < count; ++rank) threads.emplace_back(run, rank);
    } catch (const std::exception& error) {  // no thread more: the others must not wait for it
      network.fail(RankFailure::of(static_cast<int>(threads.size()), network.host(), error));
    }
  }
  if (const auto failure = network.failure()) std::rethrow_exception(failure->error());
}

}  // namespace lodestone
