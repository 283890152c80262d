// A picture on the screen, and what is drawn over it.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "render/viewer/controls/layout.h"
#include "render/viewer/session/legend.h"
#include "render/viewer/session/projection.h"
#include "render/viewer/session/surface_pick.h"

struct ImVec2;

namespace lodestone::viewer {

// Draws into a rectangle of the window, below the panel and messages. Coordinates are pixels of the picture shown
// there.
class PictureNotes {
 public:
  // `pixels` of the picture to a unit of the window.
  PictureNotes(Rect rect, double pixels) : rect_(rect), unit_(static_cast<float>(1 / pixels)) {}

  void picture(unsigned texture) const;
  void name(const std::string& name) const;  // in the upper right corner
  void lines(std::span<const Line> lines, bool faded) const;
  void legends(std::span<const Legend> legends) const;        // in the lower left corner
  void axes(const std::array<Vec3d, 3>& axes_in_view) const;  // in the lower right corner
  // Points, the line through them and a label in its middle.
  void measure(std::span<const Vec3f> points, const std::string& label) const;

 private:
  [[nodiscard]] ImVec2 at(float x, float y) const;
  [[nodiscard]] float width() const { return static_cast<float>(rect_.width); }
  [[nodiscard]] float height() const { return static_cast<float>(rect_.height); }

  Rect rect_;
  float unit_;
};

// Beside the pointer.
void show_facts(const SurfaceFacts& facts, bool several_models);

}  // namespace lodestone::viewer
