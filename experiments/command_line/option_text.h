// Options in words: what the completion of shells and the manual pages say of a table.
#pragma once

#include <string>
#include <vector>

#include "experiments/command_line/options.h"

namespace lodestone {

// "-o" and "--output"; empty for an argument without a name before it.
[[nodiscard]] std::vector<std::string> flags_of(const OptionSpec& option);
[[nodiscard]] bool is_argument(const OptionSpec& option);

// The kind of its value, as "SIZE" or "fast|normal|best"; empty for a flag.
[[nodiscard]] std::string value_text(const OptionSpec& option);

// The value that it has when it is not given; empty where there is none.
[[nodiscard]] std::string default_text(const OptionSpec& option);

}  // namespace lodestone
