// Ranks that are threads of one process: for tests and sanitizers.
#pragma once

#include <functional>

#include "parallel/distributed/messages/transport.h"

namespace lodestone {

struct LocalRanksConfig {
  double timeout_seconds = 60;  // that receive() waits
  // Sees every message before it is sent, and may change it; false: it is lost. From any thread.
  std::function<bool(int from, int to, Message& message)> on_send = {};
};

// Calls body(transport) for ranks 0 to count - 1 at once, each on a thread of its own. A body that throws tells the
// others; when all have ended, the error of the rank that failed first is thrown, with its rank and host.
void run_local_ranks(int count, const std::function<void(Transport&)>& body, const LocalRanksConfig& config = {});

}  // namespace lodestone
