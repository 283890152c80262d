// The real models, unpacked by scripts/data, and the sources, which hold one of them (examples/models).
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

// The path of, say, "scans/armadillo.obj", in that folder or in examples/models; empty when it is in neither.
[[nodiscard]] std::optional<std::filesystem::path> model(std::string_view name);

}  // namespace lodestone

// Declares `variable`, the path of a model, or skips the test, visibly.
#define LODESTONE_MODEL_OR_SKIP(variable, name)                                                            \
  const std::optional<std::filesystem::path> variable##_found = ::lodestone::model(name);                  \
  if (!variable##_found)                                                                                   \
    GTEST_SKIP() << "no model " << (name) << " in " << ::lodestone::data_folder() << ": run scripts/data"; \
  const std::filesystem::path& variable = *variable##_found
