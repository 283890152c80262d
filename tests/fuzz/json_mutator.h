// Mutations of JSON that keep it JSON, alone or as the first chunk of a binary glTF whose lengths are set right.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace lodestone {

inline void collect(nlohmann::json& value, std::vector<nlohmann::json*>& values) {
  values.push_back(&value);
  if (value.is_structured())
    for (nlohmann::json& member : value) collect(member, values);
}

inline void change(nlohmann::json& document, std::mt19937& random) {
  std::vector<nlohmann::json*> values;
  collect(document, values);
  nlohmann::json& one = *values[random() % values.size()];
  const nlohmann::json other = *values[random() % values.size()];
  constexpr double numbers[] = {0, 1, -1, 2, 3, 255, 65535, 65536, 2147483648.0, 4294967295.0, 1e19, -1e300, 0.5, 5121};
  if (one.is_number() && random() % 4 != 0) {
    const double number = numbers[random() % std::size(numbers)];
    one = number;
    if (random() % 2 == 0 && std::abs(number) < 1e15) one = static_cast<std::int64_t>(number);
  } else if (one.is_array() && !one.empty() && random() % 2 == 0) {
    const std::size_t at = random() % one.size();
    random() % 2 == 0 ? one.erase(at) : one.push_back(nlohmann::json(one[at]));
  } else if (one.is_object() && !one.empty() && random() % 2 == 0) {
    one.erase(std::next(one.begin(), static_cast<std::ptrdiff_t>(random() % one.size())));
  } else {
    one = other;
  }
}

// Returns the new size.
inline std::size_t mutate_json(std::uint8_t* data, std::size_t size, std::size_t most, unsigned int seed) {
  std::mt19937 random(seed);
  const bool binary = size > 20 && std::memcmp(data, "glTF", 4) == 0;
  std::uint32_t length = 0;
  if (binary) std::memcpy(&length, data + 12, 4);
  const std::size_t begin = binary ? 20 : 0, end = binary ? std::min<std::size_t>(size, 20 + length) : size;
  nlohmann::json document = nlohmann::json::parse(data + begin, data + end, nullptr, false);
  if (document.is_discarded() || random() % 4 == 0) return LLVMFuzzerMutate(data, size, most);
  change(document, random);
  std::string text = document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t all = begin + text.size() + (size - end);
  if (all > most) return LLVMFuzzerMutate(data, size, most);
  std::memmove(data + begin + text.size(), data + end, size - end);
  std::memcpy(data + begin, text.data(), text.size());
  length = static_cast<std::uint32_t>(text.size());
  const auto total = static_cast<std::uint32_t>(all);
  if (binary) std::memcpy(data + 12, &length, 4), std::memcpy(data + 8, &total, 4);
  return all;
}

}  // namespace lodestone
