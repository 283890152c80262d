// Two-component vectors as plain data (see vec3.h).
#pragma once

namespace lodestone {

struct Vec2f {
  float x = 0, y = 0;
  friend constexpr bool operator==(const Vec2f&, const Vec2f&) = default;
};

}  // namespace lodestone
