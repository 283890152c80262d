// Helpers of the panel and of the notes over the pictures: lengths, numbers as text, colours of words.
#pragma once

#include <imgui.h>

#include <cstdint>
#include <string>

namespace lodestone::viewer {

inline const ImVec4 wrong{1.0f, 0.42f, 0.36f, 1};  // colour of words about what is wrong

// A length given for the usual text, 13 pixels high.
[[nodiscard]] inline float scaled(float length) { return length * ImGui::GetFontSize() / 13; }

// A number by a format of printf.
[[nodiscard]] std::string text(const char* format, double value);
// 1234, 12.3 k, 12.3 M
[[nodiscard]] std::string count_text(std::uint64_t n);

}  // namespace lodestone::viewer
