// The pictures of the two settings in the window: kept when a renderer has drawn them, shown with their notes.
#pragma once

#include <array>
#include <optional>

#include "render/viewer/session/view_session.h"
#include "render/viewer/window/notes.h"
#include "render/viewer/window/picture.h"

namespace lodestone::viewer {

class ShownPictures {
 public:
  // Takes the last picture of a renderer before it draws another; `gl` is the renderer where it is that one.
  void keep(const ViewSession& session, std::size_t settings, ImageSize size, Renderer& renderer, GlRenderer* gl);
  [[nodiscard]] bool has(std::size_t settings) const { return kept_[settings]; }

  // Shows those of the layout, with notes where the panel is shown. `pointer`: where it is over a picture, if at all.
  void show(const ViewSession& session, ImageSize window, double pixels, const std::optional<Point>& pointer) const;

 private:
  std::array<Picture, 2> pictures_;
  std::array<bool, 2> kept_{};
};

}  // namespace lodestone::viewer
