#include "render/backends/gl/device/graphics_driver.h"

#include <mutex>

namespace lodestone {
namespace {

// One record for the process, as renderers are made deep inside the code that wants to record their driver.
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
