#include "render/viewer/window/panel.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/viewer/window/looks_panel.h"
#include "render/viewer/window/widgets.h"

namespace lodestone::viewer {
namespace {

void marked(bool bad, const std::string& words) {
  if (bad) ImGui::PushStyleColor(ImGuiCol_Text, wrong);
  ImGui::TextWrapped("%s", words.c_str());
  if (bad) ImGui::PopStyleColor();
}

std::string key_name(char key) {
  switch (key) {
    case '\t':
      return "Tab";
    case '\n':
      return "Home";
    case '\x1b':
      return "Esc";
    case ' ':
      return "Space";
    default:
      return {key};
  }
}

void show_model(const PanelFacts& facts, PanelRequests& requests) {
  const Model& model = *facts.model;
  std::uint64_t triangles = 0, cells = 0;
  int levels = 0;
  const float first = model.opened.models().front().hierarchy->sigma0;
  std::pair sigma0{first, first};
  for (const OpenModel& m : model.opened.models()) {
    triangles += m.hierarchy->provenance.input_triangles;
    cells += m.hierarchy->cells.size();
    levels = std::max(levels, m.hierarchy->finest() + 1);
    sigma0 = {std::min(sigma0.first, m.hierarchy->sigma0), std::max(sigma0.second, m.hierarchy->sigma0)};
  }
  ImGui::Text("%s", model.name.c_str());
  if (model.opened.models().size() > 1) {
    ImGui::SameLine();
    ImGui::TextDisabled("%d models", static_cast<int>(model.opened.models().size()));
  }
  ImGui::Text("%s triangles", count_text(triangles).c_str());
  ImGui::Text("%d levels, %s cells, sigma0 %s", levels, count_text(cells).c_str(),
              sigma0.first == sigma0.second
                  ? text("%.3g", sigma0.first).c_str()
                  : (text("%.3g", sigma0.first) + " to " + text("%.3g", sigma0.second)).c_str());
  if (ImGui::BeginCombo("backend", facts.backend.c_str())) {
    for (const std::string& name : facts.backends)
      if (ImGui::Selectable(name.c_str(), name == facts.backend) && name != facts.backend) requests.backend = name;
    ImGui::EndCombo();
  }
  if (!facts.device.empty() && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", facts.device.c_str());
}

void edit_blend(ViewSettings& settings) {
  const auto name = [](Blend blend) { return std::string(name_of(blend)); };
  if (!ImGui::BeginCombo("blending", name(settings.blend).c_str())) return;
  for (const Blend blend : all_blends()) {
    const bool pops = blend == Blend::step;
    if (pops) ImGui::PushStyleColor(ImGuiCol_Text, wrong);
    if (ImGui::Selectable((name(blend) + (pops ? " (pops)" : "")).c_str(), blend == settings.blend))
      settings.blend = blend;
    if (pops) ImGui::PopStyleColor();
  }
  ImGui::EndCombo();
}

// The tolerance in pixels, and whether every cell has its own radius.
void edit_tolerance(ViewSettings& settings) {
  ImGui::SetNextItemWidth(scaled(110));
  ImGui::SliderFloat("pixels", &settings.pixel_error, 0.1f, 50, "%.2f", ImGuiSliderFlags_Logarithmic);
  ImGui::SameLine();
  bool per_cell = settings.rule == RadiiRule::adaptive;
  if (ImGui::Checkbox("per cell", &per_cell)) settings.rule = per_cell ? RadiiRule::adaptive : RadiiRule::per_level;
}

// kappa0 and its rule; red where the guarantee does not hold.
void edit_kappa0(ViewSettings& settings, const Admissibility& found) {
  constexpr std::array frames{ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive};
  if (!found.admissible)
    for (const ImGuiCol_ frame : frames) ImGui::PushStyleColor(frame, ImVec4{0.45f, 0.12f, 0.1f, 1});
  ImGui::SliderFloat("kappa0", &settings.kappa0, 0.25f, 32, "%.3f", ImGuiSliderFlags_Logarithmic);
  if (!found.admissible) ImGui::PopStyleColor(static_cast<int>(frames.size()));
  int rule = settings.rule == RadiiRule::uniform ? 1 : 0;
  const bool per_level = ImGui::RadioButton("per level", &rule, 0);
  ImGui::SameLine();
  const bool uniform = ImGui::RadioButton("uniform", &rule, 1);
  if (per_level || uniform) settings.rule = rule == 1 ? RadiiRule::uniform : RadiiRule::per_level;
  ImGui::SameLine();
  ImGui::TextDisabled("rho %.4f", static_cast<double>(found.least_kappa0));
}

void edit_detail(const PanelFacts& facts, ViewState& state) {
  ViewSettings& settings = state.current();
  std::vector<const Hierarchy*> models;
  for (const OpenModel& model : facts.model->opened.models()) models.push_back(model.hierarchy);
  const Admissibility found = admissibility(models, settings, state.metric);
  int by = settings.by_kappa0 ? 1 : 0;
  ImGui::RadioButton("tolerance in pixels", &by, 0);
  ImGui::SameLine();
  ImGui::RadioButton("kappa0##by", &by, 1);
  settings.by_kappa0 = by == 1;
  if (settings.by_kappa0)
    edit_kappa0(settings, found);
  else
    edit_tolerance(settings);
  edit_blend(settings);
  ImGui::SliderFloat("band", &settings.beta, 0.05f, 8, "at least %.2f h", ImGuiSliderFlags_Logarithmic);
  int metric = static_cast<int>(state.metric);
  ImGui::RadioButton("euclidean", &metric, static_cast<int>(DistanceMetric::euclidean));
  ImGui::SameLine();
  ImGui::RadioButton("chebyshev", &metric, static_cast<int>(DistanceMetric::chebyshev));
  state.metric = static_cast<DistanceMetric>(metric);
  settings = clamped(settings);
  if (!found.remark.empty()) marked(true, found.remark);
}

// In rows of three.
class Switches {
 public:
  bool operator()(const char* name, bool& on) {
    if (column_ > 0) ImGui::SameLine(scaled(column_ == 1 ? 84 : 160));
    column_ = (column_ + 1) % 3;
    return ImGui::Checkbox(name, &on);
  }

 private:
  int column_ = 0;
};

void edit_switches(ViewState& state, PanelRequests& requests) {
  ViewSettings& settings = state.current();
  Switches row;
  row("levels", settings.tint);
  row("band", settings.band);
  row("boxes", settings.boxes);
  row("wires", settings.wireframe);
  row("split", state.split);
  row("overdraw", settings.overdraw);
  if (bool frozen = state.frozen; row("freeze", frozen)) requests.actions.push_back(Action::toggle_frozen);
  row("probe", state.probe);
  bool smooth = settings.samples == 4;
  row("4 samples", smooth);
  settings.samples = smooth ? 4 : 1;
  row("errors", settings.errors);
  row("measure", state.measure.on);
  if (const auto length = distance(state.measure)) {
    ImGui::SameLine();
    ImGui::Text("%.6g", *length);
  } else if (state.measure.on) {
    ImGui::SameLine();
    ImGui::TextDisabled("two clicks");
  }
  if (state.frozen) ImGui::TextDisabled("frozen: tolerance and radii wait");
}

void show_camera(const PanelFacts& facts, const ViewState& state, PanelRequests& requests) {
  const auto button = [&](const char* name, Action action) {
    if (ImGui::Button(name)) requests.actions.push_back(action);
    ImGui::SameLine();
  };
  button(state.steering == Steering::orbit ? "orbit" : "fly", Action::toggle_steering);
  button("home", Action::go_home);
  button(facts.recording ? "end##record" : "record", Action::record);
  if (facts.has_path || facts.playing) button(facts.playing ? "end##play" : "play", Action::play);
  button("picture", Action::screenshot);
  ImGui::NewLine();
}

void show_statistics(const PanelFacts& facts) {
  if (!facts.report || !ImGui::CollapsingHeader("statistics", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const ViewReport& report = *facts.report;
  ImGui::Text("%s triangles in %s cells", count_text(report.stats.triangles).c_str(),
              count_text(report.stats.cells).c_str());
  ImGui::Text("%.1f ms, selection %.2f ms", report.total_milliseconds, report.select_milliseconds);
  for (const auto& [stage, milliseconds] : report.stats.milliseconds)
    if (stage != "total") ImGui::TextDisabled("  %s %.2f ms", stage.c_str(), milliseconds);
  if (facts.model && facts.model->opened.streamed())
    ImGui::Text("%.0f MB in memory%s", static_cast<double>(facts.model->opened.resident_bytes()) * 1e-6,
                facts.model->opened.complete() ? "" : ", more is missing");
  ImGui::Text("resolution %.0f %%", 100 * facts.scale);
  const std::vector<float>& times = facts.frame_milliseconds;
  const float highest = times.empty() ? 1 : *std::max_element(times.begin(), times.end());
  ImGui::PlotLines("##times", times.data(), static_cast<int>(times.size()), 0, text("up to %.1f ms", highest).c_str(),
                   0, 1.2f * highest, {ImGui::GetContentRegionAvail().x, scaled(60)});
}

void show_keys() {
  if (!ImGui::CollapsingHeader("keys and mouse")) return;
  for (const ActionKey& key : action_keys())
    ImGui::Text("%-6s %.*s", key_name(key.key).c_str(), static_cast<int>(key.name.size()), key.name.data());
  ImGui::TextWrapped(
      "left: orbit or look; right: pan; wheel: nearer, or speed of flight; double click: focus; W A S D Q E: fly, "
      "shift "
      "faster; drop files to open them");
}

// In units of the window; `down` is a share of their height.
ImVec2 middle_of_pictures(const PanelFacts& facts, float down) {
  const auto unit = static_cast<float>(1 / facts.pixels);
  const Rect& all = facts.pictures;
  return {(static_cast<float>(all.x) + 0.5f * static_cast<float>(all.width)) * unit,
          (static_cast<float>(all.y) + down * static_cast<float>(all.height)) * unit};
}

void show_loading(const PanelFacts& facts, PanelRequests& requests) {
  ImGui::SetNextWindowPos(middle_of_pictures(facts, 0.5f), ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({scaled(360), 0});
  ImGui::Begin("opening", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::Text("%s: %s", facts.loading_name.c_str(), facts.loading->phase.c_str());
  if (facts.loading->share)
    ImGui::ProgressBar(*facts.loading->share);
  else
    ImGui::TextDisabled("...");
  if (ImGui::Button("cancel")) requests.actions.push_back(Action::stop);
  ImGui::End();
}

void show_message(const PanelFacts& facts) {
  const ImVec2 bottom = middle_of_pictures(facts, 1);
  const auto width = static_cast<float>(facts.pictures.width / facts.pixels);
  ImGui::SetNextWindowPos({bottom.x, bottom.y - 12}, ImGuiCond_Always, {0.5f, 1});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(200.0f, width - 40), 200});
  ImGui::Begin("message", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoInputs);
  ImGui::PushTextWrapPos(std::max(200.0f, width - 80));
  if (facts.message_is_error)
    ImGui::TextColored(wrong, "%s", facts.message.c_str());
  else
    ImGui::Text("%s", facts.message.c_str());
  ImGui::PopTextWrapPos();
  ImGui::End();
}

void show_settings(const PanelFacts& facts, ViewState& state, PanelRequests& requests) {
  const auto unit = static_cast<float>(1 / facts.pixels);
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(
      {static_cast<float>(facts.panel.width) * unit, static_cast<float>(facts.panel.height) * unit});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
  ImGui::Begin("Lodestone", nullptr,
               ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove);
  ImGui::PopStyleVar();
  ImGui::PushItemWidth(-scaled(70));
  if (!facts.model) {
    ImGui::TextWrapped("Drop a mesh or a .lode file into the window.");
  } else {
    show_model(facts, requests);
    edit_models(facts.model->scene, state.looks);
    ImGui::Separator();
    int chosen = static_cast<int>(state.chosen);
    ImGui::RadioButton("settings A", &chosen, 0);
    ImGui::SameLine();
    ImGui::RadioButton("settings B", &chosen, 1);
    state.chosen = static_cast<std::size_t>(chosen);
    edit_detail(facts, state);
    ImGui::Separator();
    edit_switches(state, requests);
    ImGui::Separator();
    show_camera(facts, state, requests);
    edit_light(state.home.up, state.looks);
    if (facts.frame) edit_effects(*facts.frame, facts.radius, state.looks);
    edit_clip(state.clip);
    show_statistics(facts);
  }
  show_keys();
  ImGui::PopItemWidth();
  ImGui::End();
}

}  // namespace

PanelRequests draw_panel(const PanelFacts& facts, ViewState& state) {
  PanelRequests requests;
  if (state.panel) show_settings(facts, state, requests);
  if (facts.loading) show_loading(facts, requests);
  if (!facts.message.empty()) show_message(facts);
  return requests;
}

}  // namespace lodestone::viewer
