// The program's version, as manifests and `lodestone --version` state it.
#pragma once

#include <string>
#include <string_view>

namespace lodestone {

[[nodiscard]] std::string_view program_version();

// The commit that the executable was built from. Only an executable can know, since a library would have to be linked
// anew with every commit: `main` sets it, from a text of its own (commit.cpp.in).
struct ProgramCommit {
  std::string hash = "unknown";  // 40 digits
  bool dirty = false;            // tracked files had been changed
};
inline constexpr std::size_t commit_size = 64;  // of the text in the executable, zeros after it included
[[nodiscard]] const ProgramCommit& program_commit();
// "HASH" or "HASH dirty"; anything else: unknown.
void set_program_commit(std::string_view text);

}  // namespace lodestone
