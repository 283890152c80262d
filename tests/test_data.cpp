#include "tests/test_data.h"

namespace lodestone {

const std::filesystem::path& data_folder() {
  static const std::filesystem::path folder = LODESTONE_DATA_DIR;
  return folder;
}

const std::filesystem::path& source_folder() {
  static const std::filesystem::path folder = LODESTONE_SOURCE_DIR;
  return folder;
}

std::optional<std::filesystem::path> model(std::string_view name) {
  std::filesystem::path path = data_folder() / name;
  if (std::filesystem::exists(path)) return path;
  return std::nullopt;
}

}  // namespace lodestone
