// The real models, unpacked by scripts/data, which are not part of the repository, and the sources themselves.
// The two folders are known to one object alone, so that a compiler cache serves every checkout for all others.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string_view>

namespace lodestone {

// The folder that scripts/data fills, and the root of the sources.
[[nodiscard]] const std::filesystem::path& data_folder();
[[nodiscard]] const std::filesystem::path& source_folder();

// The path of, say, "scans/armadillo.obj"; empty when the models are not there.
[[nodiscard]] std::optional<std::filesystem::path> model(std::string_view name);

}  // namespace lodestone

// Declares `variable`, the path of a model, or skips the test, visibly.
#define LODESTONE_MODEL_OR_SKIP(variable, name)                                                            \
  const std::optional<std::filesystem::path> variable##_found = ::lodestone::model(name);                  \
  if (!variable##_found)                                                                                   \
    GTEST_SKIP() << "no model " << (name) << " in " << ::lodestone::data_folder() << ": run scripts/data"; \
  const std::filesystem::path& variable = *variable##_found
