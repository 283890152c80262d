// Small files that are read once, as wholes: lists, descriptions.
#pragma once

#include <filesystem>
#include <string>

namespace lodestone {

// The whole content of a file, or of a pipe. Throws FileError when it cannot be opened or read.
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

}  // namespace lodestone
