// Programs of the device from their text, and programs that draw the whole picture.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "render/backends/gl/device/object.h"

namespace lodestone {

struct GlStage {
  GLenum stage = 0;
  std::string source;  // without the line that says the version
};

// Throws UnsupportedError with the compiler's log when the driver refuses it.
[[nodiscard]] GlProgram link_program(std::span<const GlStage> stages);

// A program whose fragments are those of the viewport, each once.
[[nodiscard]] GlProgram make_screen_program(std::string_view fragment_source);
// Draws the viewport with the program in use; `nothing` is a vertex array without attributes.
void draw_screen(const GlVertexArray& nothing);

}  // namespace lodestone
