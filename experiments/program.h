// The whole `lodestone` command, for a program that adds parts of its own to it: simplifiers, backends, LOD systems,
// experiments, metrics (docs/extending.md).
#pragma once

#include <string_view>

namespace lodestone {

// All that main() of `lodestone` does: runs the subcommand that the command line names, and returns the exit status.
// Parts are added before. `commit`: what the program was built from, as "HASH" or "HASH dirty", for the manifests of
// sweeps. Installs handlers for SIGINT, SIGTERM, SIGBUS and of std::terminate; to be called once, from the main thread.
[[nodiscard]] int run_program(int argc, char** argv, std::string_view commit = {});

}  // namespace lodestone
