#include "experiments/command_line/data_folder.h"

#include <system_error>

namespace lodestone {

std::optional<std::filesystem::path> find_data_folder(const std::filesystem::path& installed,
                                                      const std::filesystem::path& built, const char* name) {
  std::error_code unreadable;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unreadable);
  for (const std::filesystem::path& folder : {program.parent_path() / installed, built})
    if (std::filesystem::exists(folder / name, unreadable)) return folder.lexically_normal();
  return std::nullopt;
}

}  // namespace lodestone
