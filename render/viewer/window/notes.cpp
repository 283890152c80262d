#include "render/viewer/window/notes.h"

#include <imgui.h>

#include <algorithm>

#include "render/frame/shading.h"
#include "render/viewer/window/widgets.h"

namespace lodestone::viewer {
namespace {

// `crowd` in (0, 1]: less where there are many lines, so that what they lie over is still seen.
ImU32 colour_of(const Line& line, bool by_level, float crowd) {
  const Vec3f c = by_level ? shading::tint_of(line.level) : Vec3f{1, 1, 1};
  const float opacity = by_level ? (0.25f + 0.75f * line.nearness) * crowd : 0.9f;
  return ImGui::ColorConvertFloat4ToU32({c.x, c.y, c.z, opacity});
}

}  // namespace

void draw_lines(std::span<const Line> lines, Rect rect, double pixels, bool by_level) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto unit = static_cast<float>(1 / pixels);
  const auto at = [&](float x, float y) {
    return ImVec2{(static_cast<float>(rect.x) + x) * unit, (static_cast<float>(rect.y) + y) * unit};
  };
  const auto width = static_cast<float>(rect.width), height = static_cast<float>(rect.height);
  list.PushClipRect(at(0, 0), at(width, height), true);
  const float crowd = std::clamp(1500 / static_cast<float>(lines.size() + 1), 0.2f, 1.0f);
  for (const Line& line : lines)
    list.AddLine(at(line.x0, line.y0), at(line.x1, line.y1), colour_of(line, by_level, crowd));
  list.PopClipRect();
}

void draw_picture(unsigned texture, Rect rect, double pixels, const std::string& label) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto unit = static_cast<float>(1 / pixels);
  const ImVec2 from{static_cast<float>(rect.x) * unit, static_cast<float>(rect.y) * unit};
  const ImVec2 to{static_cast<float>(rect.x + rect.width) * unit, static_cast<float>(rect.y + rect.height) * unit};
  list.AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), from, to);
  if (label.empty()) return;
  const ImVec2 extent = ImGui::CalcTextSize(label.c_str());
  const ImVec2 corner{to.x - extent.x - 10, from.y + 8};
  list.AddRectFilled({corner.x - 4, corner.y - 3}, {corner.x + extent.x + 4, corner.y + extent.y + 3},
                     IM_COL32(0, 0, 0, 140));
  list.AddText(corner, IM_COL32_WHITE, label.c_str());
}

}  // namespace lodestone::viewer
