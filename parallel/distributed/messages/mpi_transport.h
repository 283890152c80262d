// Ranks that are processes of an MPI job.
#pragma once

#include <memory>

#include "parallel/distributed/messages/transport.h"

namespace lodestone {

// Initialises MPI, once in a process, and ends it when the transport does. With one rank no launcher is needed.
// receive() gives up after `timeout_seconds`. Throws UnsupportedError when MPI does not start.
class MpiTransport final : public Transport {
 public:
  MpiTransport(int* argc, char*** argv);
  ~MpiTransport() override;
  MpiTransport(const MpiTransport&) = delete;
  MpiTransport& operator=(const MpiTransport&) = delete;

  void set_timeout(double seconds) { timeout_seconds_ = seconds; }

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int ranks() const override { return ranks_; }
  [[nodiscard]] const std::string& host() const override { return host_; }
  void send(int to, Message&& message) override;
  [[nodiscard]] Message receive(int from) override;
  void fail(const RankFailure& failure) noexcept override;
  [[nodiscard]] bool failed() const override { return failed_; }

 private:
  class Sends;
  void look_for_failure();

  int rank_ = 0, ranks_ = 1;
  std::string host_;
  double timeout_seconds_ = 600;
  std::unique_ptr<Sends> sends_;
  bool failed_ = false;
};

}  // namespace lodestone
