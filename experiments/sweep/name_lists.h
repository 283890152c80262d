// Lists of names in a sweep file, and whether the settings of a sweep measure what they name.
#pragma once

#include <string>
#include <vector>

#include "experiments/sweep/sweep_file.h"
#include "render/scene/toml_table.h"

namespace lodestone {

// "a, b, c"
[[nodiscard]] std::string joined(const std::vector<std::string>& names);

// A text or several, as a list; empty: the key is missing.
[[nodiscard]] std::vector<std::string> texts(TomlTable& table, const char* key);

// Checks that settings of the sweep have the column: an error where none has, a note in `file` where some have not.
void check_presence(TomlTable& table, const char* key, const std::string& name, const SweepSection& sweep,
                    const std::string& where, SweepFile& file);

}  // namespace lodestone
