// The backend that draws nothing and counts what would be drawn: selection and culling at their own cost.
#pragma once

#include <memory>

#include "render/frame/renderer.h"

namespace lodestone {

[[nodiscard]] std::unique_ptr<Renderer> make_null_renderer();

}  // namespace lodestone
