// Data that come with the program: the bundled page, the report's package.
#pragma once

#include <filesystem>
#include <optional>

namespace lodestone {

// The folder with a file or folder of this name: `installed`, given from that of the program, or else `built`, where
// the program was built. None: neither has it.
[[nodiscard]] std::optional<std::filesystem::path> find_data_folder(const std::filesystem::path& installed,
                                                                    const std::filesystem::path& built,
                                                                    const char* name);

}  // namespace lodestone
