// The driver of the gl backend, as it names itself; for records of the origin of results.
#pragma once

#include <optional>
#include <string>

namespace lodestone {

struct GraphicsDriver {
  std::string vendor, renderer, version;
};

// The driver that this process queried last; none before the first context. Any thread may call either function.
[[nodiscard]] std::optional<GraphicsDriver> last_graphics_driver();
void note_graphics_driver(const GraphicsDriver& driver);

}  // namespace lodestone
