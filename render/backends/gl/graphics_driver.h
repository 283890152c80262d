// What draws for the gl backend, as it names itself; for records of what results came from.
#pragma once

#include <optional>
#include <string>

namespace lodestone {

struct GraphicsDriver {
  std::string vendor, renderer, version;
};

// The one that this process asked last what it can do; none before the first context. Any thread may call either.
[[nodiscard]] std::optional<GraphicsDriver> last_graphics_driver();
void note_graphics_driver(const GraphicsDriver& driver);

}  // namespace lodestone
