// The pictures on the screen, and what is drawn over them.
#pragma once

#include <span>
#include <string>

#include "render/viewer/controls/layout.h"
#include "render/viewer/session/projection.h"

namespace lodestone::viewer {

// Lines over a picture that lies at `rect`; `pixels` of the picture to a unit of the window.
void draw_lines(std::span<const Line> lines, Rect rect, double pixels, bool by_level);

// A texture at `rect`, below everything else, and a word in its upper corner.
void draw_picture(unsigned texture, Rect rect, double pixels, const std::string& label);

}  // namespace lodestone::viewer
