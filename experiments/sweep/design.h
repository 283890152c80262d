// The design of a sweep: which settings of its parameters are run.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "experiments/studies/experiment.h"
#include "render/scene/toml_table.h"

namespace lodestone {

// As the sweep file has it, still with its places in the file.
struct Design {
  enum class Kind { grid, list, random };

  Kind kind = Kind::grid;
  std::map<std::string, const toml::node*> values;  // of a grid or random design, by parameter
  const toml::array* list = nullptr;                // of a list
  std::int64_t count = 0;                           // of a random design
  const toml::node* count_at = nullptr;
  std::int64_t seed = 1;
};

// More settings than this in one sweep are a mistake.
inline constexpr std::size_t most_settings = 100'000;

// The settings, in order, as objects of the parameters that the file names; no two alike. A grid has the product of all
// values, the first parameter in the alphabet slowest. A random design draws value i of a parameter from the seed, i
// and the parameter's name alone: more runs, or another parameter, leave what was drawn as it is. Values are of the
// parameters' kinds and in their ranges. Throws InputError through `table`, with the line.
[[nodiscard]] std::vector<Json> settings_of(const Design& design, const std::vector<ParameterInfo>& known,
                                            const TomlTable& table);

}  // namespace lodestone
