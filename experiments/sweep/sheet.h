// sweep.json as the engine reads it back: what a directory holds. (The report reads more of it: python/.)
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/files/json.h"

namespace lodestone {

struct SheetRun {
  std::string id;
  int repetitions = 1;  // the most that a sweep asks for
};

struct SweepSheet {
  std::string name;
  std::vector<SheetRun> runs;  // each once
  // All of it, but for where data lies on the machine that wrote it, which decides nothing: sheets that equal each
  // other are of the same sweep, program and data.
  Json content;
};

// Nothing where the folder has no sweep.json. Throws InputError that names the file and what is wrong in it.
[[nodiscard]] std::optional<SweepSheet> read_sheet(const std::filesystem::path& folder);

}  // namespace lodestone
