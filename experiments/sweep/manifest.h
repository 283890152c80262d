// The machine that a run ran on.
#pragma once

#include <ctime>
#include <string>

#include "core/files/json.h"

namespace lodestone {

// CPU, cores, affinity, memory, system and load: of this machine, as this process may use it. The machine's name is
// nobody's business and not in it.
[[nodiscard]] Json machine_facts();

// "2026-01-31T12:00:00Z"
[[nodiscard]] std::string utc(std::time_t time);

}  // namespace lodestone
