// Processors that a run has for itself, among all runs of sweeps on this machine, whichever processes started them.
#pragma once

#include <vector>

namespace lodestone {

class ProcessorClaim {
 public:
  ProcessorClaim() = default;
  // The first `threads` of the allowed processors that no other run has, in their order; all of them for threads = 0.
  // None when these are too few. A claim ends with this object, or with the process.
  ProcessorClaim(int threads, const std::vector<int>& allowed);
  ~ProcessorClaim();
  ProcessorClaim(ProcessorClaim&& other) noexcept;
  ProcessorClaim& operator=(ProcessorClaim&&) = delete;

  [[nodiscard]] const std::vector<int>& processors() const { return processors_; }

 private:
  void give_back();

  std::vector<int> processors_;
  std::vector<int> sockets_;  // whose names are the claims
};

}  // namespace lodestone
