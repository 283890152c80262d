// Which processors threads run on. Linux alone.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace lodestone {

// Processors that the calling thread may use, by number.
[[nodiscard]] std::vector<int> allowed_processors();
// The calling thread and those it will start run on these alone; none: wherever they may. Throws ResourceError.
void pin_to(const std::vector<int>& processors);

// The core that a processor is a hardware thread of, by the name that the system has for it; where that tells nothing,
// a name of its own.
[[nodiscard]] std::string core_of_processor(int processor);
// In the order in which to take them: the first of every core, then the second of every core, and so on; as given among
// these. So that as many workers as there are cores share none.
[[nodiscard]] std::vector<int> one_per_core_first(const std::vector<int>& processors,
                                                  const std::function<std::string(int)>& core_of = core_of_processor);

// Binds all threads of the process to some processors, idle ones of a scheduler included, as long as it lives; then to
// those that the calling thread was allowed before. The calling thread begins on the first of them, which the others
// leave to it where there are more. Nothing else starts threads when it begins and ends. Rather than an
// observer of the scheduler, which would call the system in the middle of what is timed.
class BoundThreads {
 public:
  // At least one processor. Throws ResourceError.
  explicit BoundThreads(const std::vector<int>& processors);
  ~BoundThreads();
  BoundThreads(const BoundThreads&) = delete;
  BoundThreads& operator=(const BoundThreads&) = delete;

 private:
  std::vector<int> before_;
};

}  // namespace lodestone
