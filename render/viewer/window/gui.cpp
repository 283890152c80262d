#include "render/viewer/window/gui.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <cmath>
#include <utility>

namespace lodestone::viewer {

Gui::Gui(GLFWwindow* window) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 150");
}

Gui::~Gui() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

// Text is made anew at each size, as enlarged letters are blurred.
void Gui::set_scale(float scale) {
  if (std::exchange(scale_, scale) == scale) return;
  ImGuiStyle& style = ImGui::GetStyle();
  style = {};
  ImGui::StyleColorsDark();
  style.FrameRounding = 3;
  style.ScaleAllSizes(scale);
  ImFontConfig font;
  font.SizePixels = std::round(13 * scale);
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  fonts.AddFontDefault(&font);
  if (fonts.TexID == nullptr) return;  // the first frame makes the texture
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Gui::begin_frame(float scale) {
  set_scale(scale / static_cast<float>(pixels()));
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Gui::end_frame() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool Gui::wants_mouse() const { return ImGui::GetIO().WantCaptureMouse; }
bool Gui::wants_text() const { return ImGui::GetIO().WantTextInput; }

std::optional<Point> Gui::pointer() const {
  if (wants_mouse() || !ImGui::IsMousePosValid()) return {};
  const ImVec2 at = ImGui::GetMousePos();
  return Point{at.x * pixels(), at.y * pixels()};
}

double Gui::pixels() const {
  const double scale = ImGui::GetIO().DisplayFramebufferScale.x;
  return scale > 0 ? scale : 1;
}

}  // namespace lodestone::viewer
