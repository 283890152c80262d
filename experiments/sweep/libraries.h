// The shared libraries of this process, by what identifies their code.
#pragma once

#include <string>
#include <vector>

namespace lodestone {

struct LoadedLibrary {
  std::string path;
  std::string identity;  // build-id (hexadecimal), or where it has none the SHA-256 of the file
};

// All that are loaded now, those that were asked for at run time included: drivers of OpenGL, what is preloaded.
// Without the executable and the kernel's.
[[nodiscard]] std::vector<LoadedLibrary> loaded_libraries();

// Those that the executable names and whose code decides results, by path in the order of their names.
[[nodiscard]] std::vector<LoadedLibrary> deciding_libraries();

}  // namespace lodestone
