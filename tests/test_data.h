// The real models, unpacked by scripts/data; not part of the repository.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string_view>

namespace lodestone {

// The path of, say, "scans/armadillo.obj"; empty when the models are not there.
[[nodiscard]] inline std::optional<std::filesystem::path> model(std::string_view name) {
  const std::filesystem::path path = std::filesystem::path(LODESTONE_DATA_DIR) / name;
  if (std::filesystem::exists(path)) return path;
  return std::nullopt;
}

}  // namespace lodestone

// Declares `variable`, the path of a model, or skips the test, visibly.
#define LODESTONE_MODEL_OR_SKIP(variable, name)                                                    \
  const std::optional<std::filesystem::path> variable##_found = ::lodestone::model(name);          \
  if (!variable##_found)                                                                           \
    GTEST_SKIP() << "no model " << (name) << " in " << LODESTONE_DATA_DIR << ": run scripts/data"; \
  const std::filesystem::path& variable = *variable##_found
