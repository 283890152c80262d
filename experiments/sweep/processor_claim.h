// Processors that a run has for itself, among all runs of the user's sweeps on this machine, whichever processes
// started them.
#pragma once

#include <vector>

#include "experiments/sweep/files.h"

namespace lodestone {

class ProcessorClaim {
 public:
  ProcessorClaim() = default;
  // The first `threads` of the allowed processors that no other run has, in their order; all of them for threads = 0.
  // None when these are too few. A claim is a locked file (flock) per processor: it ends with this object, or with the
  // process. Throws FileError when the files cannot be made.
  ProcessorClaim(int threads, const std::vector<int>& allowed);

  [[nodiscard]] const std::vector<int>& processors() const { return processors_; }

 private:
  std::vector<int> processors_;
  std::vector<FileLock> locks_;
};

}  // namespace lodestone
