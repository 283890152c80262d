// Capabilities of the current OpenGL context, and a check that they suffice.
#pragma once

#include <cstddef>
#include <string>

namespace lodestone {

struct GlDevice {
  std::string renderer, version;            // as the driver names itself
  std::size_t max_storage_block_bytes = 0;  // of one shader storage block; 128 MiB on llvmpipe
  int max_target_size = 0;                  // width and height of a framebuffer, pixels
};

// Asks the current context. Throws UnsupportedError naming what is missing: OpenGL 4.5, storage blocks in vertex
// shaders.
[[nodiscard]] GlDevice query_device();

// In builds with assertions, sends messages of the driver to stderr and makes an error among them a failed assertion. A
// context that was not made for debugging reports little.
void watch_errors();

// Throws ResourceError when the last calls ran out of memory; any other pending error is a failed assertion. `what`
// names the work for the message.
void check_memory(const std::string& what);

}  // namespace lodestone
