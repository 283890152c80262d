// The program's version, as it stands in manifests and in `lodestone --version`.
#pragma once

#include <string_view>

namespace lodestone {
[[nodiscard]] std::string_view program_version();
}  // namespace lodestone
