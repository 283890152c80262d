#include "core/base/known_names.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace lodestone {
namespace {

char letter(char c) { return c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

// Edits from one word to the other. Takes the product of their lengths, which users write.
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      const std::size_t changed = letter(a[i - 1]) == letter(b[j - 1]) ? 0 : 1;
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + changed});
      const bool swapped =
          i > 1 && j > 1 && letter(a[i - 1]) == letter(b[j - 2]) && letter(a[i - 2]) == letter(b[j - 1]);
      if (swapped) cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  return cost[a.size()][b.size()];
}

bool shortens(std::string_view word, std::string_view name) {
  return word.size() >= 3 && name.size() > word.size() && edits(word, name.substr(0, word.size())) == 0;
}

}  // namespace

std::string nearest_name(std::string_view word, const std::vector<std::string>& names) {
  constexpr std::size_t longest = 64;  // no name is as long
  if (word.size() > longest) return {};
  std::string nearest;
  double least = 1.0 / 3;
  for (const std::string& name : names) {
    const double share =
        static_cast<double>(edits(word, name)) / static_cast<double>(std::max(word.size(), name.size()));
    if (share < least || (share == least && nearest.empty())) least = share, nearest = name;
  }
  if (!nearest.empty()) return nearest;
  const auto found = std::ranges::find_if(names, [&](const std::string& name) { return shortens(word, name); });
  return found == names.end() ? std::string() : *found;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& names) {
  const std::string nearest = nearest_name(word, names);
  return nearest.empty() ? std::string() : "; did you mean " + nearest + "?";
}

std::string known_names(std::string_view word, const std::vector<std::string>& names) {
  std::string text = "known are ";
  for (const std::string& name : names) {
    if (&name != &names.front()) text += ", ";
    text += name;
  }
  return text + did_you_mean(word, names);
}

}  // namespace lodestone
