// Messages about an unknown name list the known ones, and say which of them was probably meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lodestone {

// The name that is nearest to a misspelt one: the fewest letters that are missing, added, different or swapped
// (damerau1964), at most a third of the longer one's; or one that it shortens to three letters or more. Empty if there
// is none.
[[nodiscard]] std::string nearest_name(std::string_view word, const std::vector<std::string>& names);

// "; did you mean b?"; empty where none is near.
[[nodiscard]] std::string did_you_mean(std::string_view word, const std::vector<std::string>& names);

// "known are a, b, c", and "; did you mean b?" where one is near.
[[nodiscard]] std::string known_names(std::string_view word, const std::vector<std::string>& names);

}  // namespace lodestone
