#include "experiments/version.h"

namespace lodestone {
std::string_view program_version() { return LODESTONE_VERSION; }
}  // namespace lodestone
