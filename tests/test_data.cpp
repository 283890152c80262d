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
  for (const std::filesystem::path& folder : {data_folder(), source_folder() / "examples/models"})
    if (std::filesystem::exists(folder / name)) return folder / name;
  return std::nullopt;
}

}  // namespace lodestone
