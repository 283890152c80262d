// Meshes given to the subcommands: their options, reading them, what is said about them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"

namespace lodestone {

// For --help.
inline constexpr const char* mesh_formats =
    ".ply, .obj, .stl, .off, .drc, .glb, .gltf, a tileset.json or its folder, .hgt or a folder of them, .asc";

struct InputOptions {
  bool fill_voids = false;
  std::string grid;  // as given by --grid; empty: none
};

// Adds --fill-voids and --grid.
void add_input_options(CLI::App& command, InputOptions& options);

// "WxH[:TYPE[:SPACING]]". Throws InputError for anything else.
[[nodiscard]] RawGridFormat parse_raw_grid(const std::string& text);

// Throws InputError when --grid is given, but every file is of a format that its name tells.
[[nodiscard]] ReadConfig read_config(const InputOptions& options, const std::vector<std::string>& files);

// "note: ..." lines on standard output, the first ten.
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace lodestone
