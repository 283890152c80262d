// The message of an error: one line a user can act on.
#pragma once

#include <string>

#include "core/base/error_kinds.h"

namespace lodestone {

// "FILE: PLACE: WHAT; REMEDY", with empty parts left out.
[[nodiscard]] inline std::string describe(const std::string& file, const std::string& place, const std::string& what,
                                          const std::string& remedy = {}) {
  std::string line;
  if (!file.empty()) line += file + ": ";
  if (!place.empty()) line += place + ": ";
  line += what;
  if (!remedy.empty()) line += "; " + remedy;
  return line;
}

}  // namespace lodestone
