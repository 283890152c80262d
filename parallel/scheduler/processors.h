// Binding of threads to processors. Linux only.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace lodestone {

// Processors that the calling thread may use, by number.
[[nodiscard]] std::vector<int> allowed_processors();
// Binds the calling thread and those it will start to these; none: no change. Throws ResourceError.
void pin_to(const std::vector<int>& processors);

// Name of the core that a processor is a hardware thread of, as the system gives it; a name of its own where the system
// gives none.
[[nodiscard]] std::string core_of_processor(int processor);
// The processors in the order in which to use them: the first of every core, then the second of every core, and so on,
// each in the given order. As many workers as there are cores then share none.
[[nodiscard]] std::vector<int> one_per_core_first(const std::vector<int>& processors,
                                                  const std::function<std::string(int)>& core_of = core_of_processor);

// Likewise those that share a core side by side: as many workers as there are hardware threads in a core share it.
[[nodiscard]] std::vector<int> core_by_core(const std::vector<int>& processors,
                                            const std::function<std::string(int)>& core_of = core_of_processor);
// Different cores among the processors, and memories (NUMA nodes) that they are next to; one where the system does not
// say.
[[nodiscard]] std::size_t count_cores(const std::vector<int>& processors);
[[nodiscard]] std::size_t count_nodes(const std::vector<int>& processors);

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
