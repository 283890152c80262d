#include "parallel/scheduler/processors.h"

#include <sched.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "core/base/error.h"

namespace lodestone {
namespace {

constexpr pid_t calling_thread = 0;

// Returns false when the thread has ended.
bool bind_thread(pid_t thread, const std::vector<int>& processors) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int i : processors) CPU_SET(i, &set);
  if (sched_setaffinity(thread, sizeof set, &set) == 0) return true;
  if (errno == ESRCH) return false;
  throw ResourceError(std::string("cannot pin the run to its processors: ") + strerror(errno));
}

// All but the calling one. Threads that one of these has started meanwhile are found by looking again.
void bind_others(const std::vector<int>& processors) {
  std::set<pid_t> bound{gettid()};
  for (bool found = true; found;) {
    found = false;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
      const std::string name = entry.path().filename().string();
      pid_t thread = 0;
      std::from_chars(name.data(), name.data() + name.size(), thread);
      found = (bound.insert(thread).second && bind_thread(thread, processors)) || found;
    }
  }
}

// The memory that a processor is next to; 0 where the system does not say.
int node_of_processor(int processor) {
  const std::filesystem::path folder = "/sys/devices/system/cpu/cpu" + std::to_string(processor);
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("node")) continue;
    int node = 0;
    if (std::from_chars(name.data() + 4, name.data() + name.size(), node).ec == std::errc{}) return node;
  }
  return 0;
}

}  // namespace

std::vector<int> allowed_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  std::vector<int> processors;
  if (sched_getaffinity(calling_thread, sizeof set, &set) != 0) return processors;
  for (int i = 0; i < CPU_SETSIZE; ++i)
    if (CPU_ISSET(i, &set)) processors.push_back(i);
  return processors;
}

void pin_to(const std::vector<int>& processors) {
  if (!processors.empty()) bind_thread(calling_thread, processors);
}

std::string core_of_processor(int processor) {
  const std::string number = std::to_string(processor);
  std::ifstream in("/sys/devices/system/cpu/cpu" + number + "/topology/thread_siblings_list");
  std::string siblings;
  return std::getline(in, siblings) ? siblings : "processor " + number;
}

std::vector<int> one_per_core_first(const std::vector<int>& processors,
                                    const std::function<std::string(int)>& core_of) {
  std::map<std::string, int> taken;          // of each core, so far
  std::vector<std::pair<int, int>> by_turn;  // of its core, and the processor
  for (const int processor : processors) by_turn.emplace_back(taken[core_of(processor)]++, processor);
  std::ranges::stable_sort(by_turn, {}, &std::pair<int, int>::first);
  std::vector<int> order;
  for (const auto& [turn, processor] : by_turn) order.push_back(processor);
  return order;
}

std::vector<int> core_by_core(const std::vector<int>& processors, const std::function<std::string(int)>& core_of) {
  std::map<std::string, std::size_t> first;  // place of the first processor of each core
  std::vector<std::pair<std::size_t, int>> by_core;
  for (std::size_t i = 0; i < processors.size(); ++i)
    by_core.emplace_back(first.try_emplace(core_of(processors[i]), i).first->second, processors[i]);
  std::ranges::stable_sort(by_core, {}, &std::pair<std::size_t, int>::first);
  std::vector<int> order;
  for (const auto& [place, processor] : by_core) order.push_back(processor);
  return order;
}

std::size_t count_cores(const std::vector<int>& processors) {
  std::set<std::string> cores;
  for (const int processor : processors) cores.insert(core_of_processor(processor));
  return cores.size();
}

std::size_t count_nodes(const std::vector<int>& processors) {
  std::set<int> nodes;
  for (const int processor : processors) nodes.insert(node_of_processor(processor));
  return nodes.size();
}

BoundThreads::BoundThreads(const std::vector<int>& processors) : before_(allowed_processors()) {
  // Threads that were bound to one processor before would share it until the system balances its loads.
  bind_thread(calling_thread, {processors.front()});
  bind_others(processors.size() > 1 ? std::vector(processors.begin() + 1, processors.end()) : processors);
  bind_thread(calling_thread, processors);  // it has come to the first, and what it starts may go anywhere
}

BoundThreads::~BoundThreads() {
  try {
    bind_others(before_);
    bind_thread(calling_thread, before_);
  } catch (const std::exception&) {  // they remain where they are
  }
}

}  // namespace lodestone
