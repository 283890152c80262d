// Meshes given to the subcommands: their options, reading them, what is said about them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "experiments/command_line/options.h"

namespace lodestone {

// For --help.
inline constexpr const char* mesh_formats =
    ".ply, .obj, .stl, .off, .drc, .glb, .gltf, a tileset.json or its folder, .hgt or a folder of them, .asc";

struct InputOptions {
  bool fill_voids = false, allow_outside = false;
  std::string grid;               // as given by --grid; empty: none
  std::optional<std::string> up;  // as given by --up
};

// The options with those of InputOptions after them.
[[nodiscard]] OptionTable with_input_options(OptionTable table, InputOptions& options);

// The option --up, for commands to which it makes a difference.
[[nodiscard]] OptionSpec up_option(std::optional<std::string>& up);
// A note on standard output if it is a guess.
void print_up_note(Up up);

// Throws InputError when --grid is given, but every file is of a format that its name tells.
[[nodiscard]] ReadConfig read_config(const InputOptions& options, const std::vector<std::string>& files);

// "note: ..." lines on standard output, the first ten.
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace lodestone
