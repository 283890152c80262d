#include "render/viewer/window/notes.h"

#include <imgui.h>

#include <algorithm>

#include "render/viewer/window/widgets.h"

namespace lodestone::viewer {
namespace {

constexpr ImU32 shade = IM_COL32(0, 0, 0, 140);  // behind words
constexpr std::array axis_colours{Vec3f{0.95f, 0.35f, 0.3f}, Vec3f{0.45f, 0.8f, 0.35f}, Vec3f{0.4f, 0.6f, 1}};
constexpr ImU32 measure_colour = IM_COL32(255, 220, 90, 255);

ImDrawList& below_all() { return *ImGui::GetBackgroundDrawList(); }

ImU32 colour(Vec3f c, float opacity = 1) { return ImGui::ColorConvertFloat4ToU32({c.x, c.y, c.z, opacity}); }

// `crowd` in (0, 1]: less where there are many lines, so that what they lie over is still seen.
ImU32 colour_of(const Line& line, bool faded, float crowd) {
  return colour(line.colour, faded ? (0.25f + 0.75f * line.nearness) * crowd : 0.9f);
}

// Words on a dark ground; `pivot` is the share of their box that lies before `at`.
void words(ImVec2 at, ImVec2 pivot, const std::string& text) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float margin = scaled(4);
  const ImVec2 from{at.x - pivot.x * size.x, at.y - pivot.y * size.y};
  below_all().AddRectFilled({from.x - margin, from.y - margin}, {from.x + size.x + margin, from.y + size.y + margin},
                            shade);
  below_all().AddText(from, IM_COL32_WHITE, text.c_str());
}

// Title, and a row for each entry: a swatch and its label.
ImVec2 size_of(const Legend& legend) {
  float across = ImGui::CalcTextSize(legend.title.c_str()).x;
  for (const Legend::Entry& entry : legend.entries)
    across = std::max(across, scaled(24) + ImGui::CalcTextSize(entry.label.c_str()).x);
  return {across, ImGui::GetFontSize() * static_cast<float>(legend.entries.size() + 1) + scaled(4)};
}
void draw(const Legend& legend, ImVec2 from, ImVec2 size) {
  ImDrawList& list = below_all();
  const float margin = scaled(6), row = ImGui::GetFontSize();
  list.AddRectFilled({from.x - margin, from.y - margin}, {from.x + size.x + margin, from.y + size.y + margin}, shade);
  list.AddText(from, IM_COL32_WHITE, legend.title.c_str());
  ImVec2 at{from.x, from.y + row + scaled(4)};
  for (const Legend::Entry& entry : legend.entries) {
    list.AddRectFilled(at, {at.x + scaled(18), at.y + row}, colour(entry.colour));
    list.AddText({at.x + scaled(24), at.y}, IM_COL32_WHITE, entry.label.c_str());
    at.y += row;
  }
}

}  // namespace

ImVec2 PictureNotes::at(float x, float y) const {
  return {(static_cast<float>(rect_.x) + x) * unit_, (static_cast<float>(rect_.y) + y) * unit_};
}

void PictureNotes::picture(unsigned texture) const {
  below_all().AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), at(0, 0),
                       at(width(), height()));
}

void PictureNotes::name(const std::string& name) const {
  const ImVec2 corner = at(width(), 0);
  words({corner.x - scaled(10), corner.y + scaled(8)}, {1, 0}, name);
}

void PictureNotes::lines(std::span<const Line> lines, bool faded) const {
  ImDrawList& list = below_all();
  list.PushClipRect(at(0, 0), at(width(), height()), true);
  const float crowd = std::clamp(1500 / static_cast<float>(lines.size() + 1), 0.2f, 1.0f);
  for (const Line& line : lines)
    list.AddLine(at(line.x0, line.y0), at(line.x1, line.y1), colour_of(line, faded, crowd));
  list.PopClipRect();
}

void PictureNotes::legends(std::span<const Legend> legends) const {
  const ImVec2 corner = at(0, height());
  ImVec2 from{corner.x + scaled(14), corner.y - scaled(14)};
  for (const Legend& legend : legends) {
    const ImVec2 size = size_of(legend);
    draw(legend, {from.x, from.y - size.y}, size);
    from.x += size.x + scaled(18);
  }
}

void PictureNotes::axes(const std::array<Vec3d, 3>& axes_in_view) const {
  const float arm = scaled(26);
  const ImVec2 corner = at(width(), height()), centre{corner.x - scaled(42), corner.y - scaled(42)};
  std::array<std::size_t, 3> farthest_first{0, 1, 2};
  std::ranges::sort(farthest_first, {}, [&](std::size_t k) { return axes_in_view[k].z; });
  ImDrawList& list = below_all();
  list.AddCircleFilled(centre, scaled(38), shade);
  for (const std::size_t k : farthest_first) {
    const Vec3f axis = to_float(axes_in_view[k]);
    const ImU32 own = colour(axis_colours[k], axis.z < 0 ? 0.6f : 1);
    list.AddLine(centre, {centre.x + arm * axis.x, centre.y - arm * axis.y}, own, scaled(2));
    const char letter[2]{static_cast<char>('x' + k), 0};
    const ImVec2 size = ImGui::CalcTextSize(letter);
    const float beyond = arm + scaled(6);
    list.AddText({centre.x + beyond * axis.x - 0.5f * size.x, centre.y - beyond * axis.y - 0.5f * size.y}, own, letter);
  }
}

void PictureNotes::measure(std::span<const Vec3f> points, const std::string& label) const {
  ImDrawList& list = below_all();
  list.PushClipRect(at(0, 0), at(width(), height()), true);
  for (const Vec3f& point : points) list.AddCircleFilled(at(point.x, point.y), scaled(3.5f), measure_colour);
  if (points.size() == 2) {
    const ImVec2 from = at(points[0].x, points[0].y), to = at(points[1].x, points[1].y);
    list.AddLine(from, to, measure_colour, scaled(1.5f));
    words({0.5f * (from.x + to.x), 0.5f * (from.y + to.y) - scaled(6)}, {0.5f, 1}, label);
  }
  list.PopClipRect();
}

void show_facts(const SurfaceFacts& facts, bool several_models) {
  ImGui::BeginTooltip();
  if (several_models) ImGui::Text("%s", facts.model.c_str());
  ImGui::Text("cell %u, level %d%s", static_cast<unsigned>(facts.cell), facts.level,
              facts.morphing ? ", morphing" : "");
  ImGui::Text("%s triangles", count_text(facts.triangles).c_str());
  ImGui::Text("error %.3g (%.2f pixels), %s", facts.error, facts.error_pixels,
              facts.measured ? "measured" : "estimated");
  ImGui::Text("at %.6g, %.6g, %.6g", facts.point.x, facts.point.y, facts.point.z);
  ImGui::EndTooltip();
}

}  // namespace lodestone::viewer
