#include "render/backends/gl/graphics_driver.h"

#include <mutex>

namespace lodestone {
namespace {

// Of the process, as renderers are made deep inside of what wants to record it.
std::mutex mutex;
std::optional<GraphicsDriver> last;

}  // namespace

std::optional<GraphicsDriver> last_graphics_driver() {
  const std::scoped_lock lock(mutex);
  return last;
}

void note_graphics_driver(const GraphicsDriver& driver) {
  const std::scoped_lock lock(mutex);
  last = driver;
}

}  // namespace lodestone
