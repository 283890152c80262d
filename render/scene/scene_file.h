// Scenes as TOML files; README.md describes the keys, experiments/scenes has examples.
#pragma once

#include <string>

#include "render/scene/scene.h"

namespace lodestone {

// Names of files inside are relative to the scene's own. Throws FileError when the file cannot be read, InputError with
// file and line for invalid TOML, for a key that is unknown, of the wrong kind or out of its range, and for a scene
// without models.
[[nodiscard]] Scene read_scene(const std::string& file);

// True if the extension of a file is that of a scene.
[[nodiscard]] bool is_scene_file(const std::string& file);

}  // namespace lodestone
