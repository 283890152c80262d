// Identity of the program: the hash of what it does, and the shared libraries that it has loaded.
#pragma once

#include <string>
#include <vector>

#include "core/files/json.h"

namespace lodestone {

struct LoadedLibrary {
  std::string path;
  std::string identity;  // checksum of the file, hexadecimal
};

// All that are loaded now, those that were asked for at run time included: drivers of OpenGL, preloaded ones. Without
// the executable and the kernel's.
[[nodiscard]] std::vector<LoadedLibrary> loaded_libraries();

// Those whose code decides results: loaded when the program started, and neither preloaded nor the system's run-time.
[[nodiscard]] std::vector<LoadedLibrary> deciding_libraries();

// SHA-256 of the executable file without the commit that it was built from, and of the libraries that decide results.
[[nodiscard]] const std::string& program_hash();

// The hash, version, commit, dirty, compiler, flags, build type, and all libraries that are loaded when it is called,
// for manifests.
[[nodiscard]] Json program_facts();

}  // namespace lodestone
