#include "experiments/sweep/manifest.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>
#include <set>

#include "parallel/scheduler/processors.h"

namespace lodestone {
namespace {

// The first line of /proc/cpuinfo with this key; some machines have none.
std::string cpu_model() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t value = line.find_first_not_of(" \t", line.find(':') + 1);
    return value == std::string::npos ? "unknown" : line.substr(value);
  }
  return "unknown";
}

// Pairs of package and core that the processors belong to; 0 where the system does not tell.
std::size_t core_count() {
  std::set<std::string> cores;
  const long processors = sysconf(_SC_NPROCESSORS_CONF);
  for (long i = 0; i < processors; ++i) {
    std::ifstream in("/sys/devices/system/cpu/cpu" + std::to_string(i) + "/topology/thread_siblings_list");
    std::string siblings;
    if (std::getline(in, siblings)) cores.insert(siblings);
  }
  return cores.size();
}

std::string system_name() {
  utsname name{};
  uname(&name);
  return std::string(name.sysname) + " " + name.release + " " + name.machine;
}

double load_average() {
  double load = 0;
  std::ifstream("/proc/loadavg") >> load;
  return load;
}

}  // namespace

Json machine_facts() {
  const auto memory =
      static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
  return {{"cpu", cpu_model()},
          {"cores", core_count()},
          {"processors", sysconf(_SC_NPROCESSORS_ONLN)},
          {"affinity", allowed_processors()},
          {"memory_bytes", memory},
          {"system", system_name()},
          {"load", load_average()}};
}

std::string utc(std::time_t time) {
  std::tm parts{};
  gmtime_r(&time, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

}  // namespace lodestone
