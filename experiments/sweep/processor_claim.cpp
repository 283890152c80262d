#include "experiments/sweep/processor_claim.h"

#include <unistd.h>

#include <cstdlib>
#include <string>

namespace lodestone {
namespace {

std::filesystem::path lock_folder() {
  const char* const runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime && access(runtime, W_OK) == 0) return std::filesystem::path(runtime) / "lodestone.processors";
  return std::filesystem::temp_directory_path() / ("lodestone.processors." + std::to_string(getuid()));
}

}  // namespace

ProcessorClaim::ProcessorClaim(int threads, const std::vector<int>& allowed) {
  const auto wanted = threads > 0 ? static_cast<std::size_t>(threads) : allowed.size();
  const std::filesystem::path folder = lock_folder();
  make_folder(folder);
  for (const int processor : allowed) {
    if (processors_.size() == wanted) return;
    FileLock lock = FileLock::try_lock(folder / std::to_string(processor));
    if (!lock.held()) continue;
    processors_.push_back(processor);
    locks_.push_back(std::move(lock));
  }
  if (processors_.size() < wanted) processors_.clear(), locks_.clear();
}

}  // namespace lodestone
