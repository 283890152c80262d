#include "experiments/sweep/processor_claim.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstring>
#include <string>
#include <utility>

namespace lodestone {
namespace {

// A socket that nobody connects to: the kernel lets one process have its name, and frees it when that ends, leaving no
// file. -1: another has it.
int claim(int processor) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = "lodestone.processor." + std::to_string(processor);
  std::memcpy(address.sun_path + 1, name.data(), name.size());  // after a zero: no name of a file
  const int descriptor = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return -1;
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), length) == 0) return descriptor;
  close(descriptor);
  return -1;
}

}  // namespace

ProcessorClaim::ProcessorClaim(int threads, const std::vector<int>& allowed) {
  const auto wanted = threads > 0 ? static_cast<std::size_t>(threads) : allowed.size();
  for (const int processor : allowed) {
    if (processors_.size() == wanted) return;
    const int descriptor = claim(processor);
    if (descriptor < 0) continue;
    processors_.push_back(processor);
    sockets_.push_back(descriptor);
  }
  if (processors_.size() < wanted) give_back();
}

ProcessorClaim::~ProcessorClaim() { give_back(); }

ProcessorClaim::ProcessorClaim(ProcessorClaim&& other) noexcept
    : processors_(std::exchange(other.processors_, {})), sockets_(std::exchange(other.sockets_, {})) {}

void ProcessorClaim::give_back() {
  for (const int descriptor : sockets_) close(descriptor);
  sockets_.clear();
  processors_.clear();
}

}  // namespace lodestone
