// The [[figure]] of a sweep file.
#pragma once

#include "experiments/sweep/sweep_file.h"
#include "render/scene/toml_table.h"

namespace lodestone {

// A figure of the sweeps that `file` has so far, which receives notes. Throws InputError, with the line.
[[nodiscard]] FigureSpec read_figure(TomlTable& table, const toml::node& at, SweepFile& file);

}  // namespace lodestone
