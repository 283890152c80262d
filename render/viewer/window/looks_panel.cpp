#include "render/viewer/window/looks_panel.h"

#include "core/mesh/up_axis.h"
#include "render/viewer/window/widgets.h"

namespace lodestone::viewer {
namespace {

// Effects with a switch among those of the settings.
constexpr EffectSet switched_elsewhere{Effect::level_tint, Effect::wireframe, Effect::overdraw};
constexpr double usual_occlusion_radius = 0.05, thickest_fog = 2;  // times, and per, the radius of the scene

void edit_colour(const char* name, Vec3f& colour) {
  float rgb[3]{colour.x, colour.y, colour.z};
  if (ImGui::ColorEdit3(name, rgb, ImGuiColorEditFlags_NoInputs)) colour = {rgb[0], rgb[1], rgb[2]};
}

}  // namespace

void edit_models(const Scene& scene, Looks& looks) {
  if (scene.models.size() < 2) return;
  if (!ImGui::CollapsingHeader("models", ImGuiTreeNodeFlags_DefaultOpen)) return;
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    ImGui::PushID(static_cast<int>(m));
    bool shown = !is_hidden(looks, m);
    if (ImGui::Checkbox(scene.models[m].name.c_str(), &shown)) show(looks, m, shown);
    ImGui::PopID();
  }
}

void edit_light(Vec3d up, Looks& looks) {
  if (!ImGui::CollapsingHeader("light and background")) return;
  Lighting& light = looks.lighting;
  ImGui::SliderFloat("ambient", &light.ambient, 0, 1, "%.2f");
  ImGui::SliderFloat("eye", &light.head, 0, 2, "%.2f");
  ImGui::SliderFloat("sun", &light.directional.strength, 0, 2, "%.2f");
  const Bearing bearing = bearing_of(looks.towards_light, up);
  auto around = static_cast<float>(bearing.around), above = static_cast<float>(bearing.above);
  const bool turned = ImGui::SliderFloat("around", &around, -180, 180, "%.0f degrees");
  const bool lifted = ImGui::SliderFloat("above", &above, -90, 90, "%.0f degrees");
  if (turned || lifted) looks.towards_light = direction_of({around, above}, up);
  ImGui::Checkbox("shadows", &light.directional.shadows);
  ImGui::SameLine(scaled(110));
  edit_colour("background", looks.background);
}

void edit_clip(ClipChoice& clip) {
  if (!ImGui::CollapsingHeader("clipping plane")) return;
  ImGui::Checkbox("on", &clip.on);
  for (int axis = 0; axis < 3; ++axis) {
    ImGui::SameLine();
    const char letter[2]{static_cast<char>('x' + axis), 0};
    ImGui::RadioButton(letter, &clip.axis, axis);
  }
  ImGui::SameLine();
  ImGui::Checkbox("flip", &clip.other);
  if (ImGui::SliderFloat("place", &clip.place, -1, 1, "%.3f")) clip.on = true;
}

void edit_effects(const Frame& frame, double radius, Looks& looks) {
  if (!ImGui::CollapsingHeader("effects")) return;
  AmbientOcclusion& occlusion = looks.ambient_occlusion;
  ImGui::SliderFloat("creases", &occlusion.strength, 0, 1, "%.2f");
  if (occlusion.strength > 0 && !(occlusion.radius > 0))
    occlusion.radius = static_cast<float>(usual_occlusion_radius * radius);
  auto thickness = static_cast<float>(looks.fog.density * radius);
  if (ImGui::SliderFloat("fog", &thickness, 0, thickest_fog, "%.2f"))
    looks.fog.density = static_cast<float>(thickness / radius);
  ImGui::PushID("switches");  // one of them has the name of a slider
  for (const PlannedEffect& planned : explain_plan(frame)) {
    if (switched_elsewhere.contains(planned.effect)) continue;
    bool on = !looks.without.contains(planned.effect);
    if (!planned.called_for) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    if (ImGui::Checkbox(std::string(name_of(planned.effect)).c_str(), &on)) looks.without.set(planned.effect, !on);
    if (!planned.called_for) ImGui::PopStyleColor();
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s: %s", std::string(info_of(planned.effect).what).c_str(),
                        planned.called_for ? planned.reasons.front().why.c_str() : "nothing calls for it");
  }
  ImGui::PopID();
}

}  // namespace lodestone::viewer
