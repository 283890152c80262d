// What the current OpenGL context can do, and whether that is enough.
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

// In builds with assertions: messages of the driver go to stderr, and an error among them is a failed assertion. The
// context must have been made for debugging to say much.
void watch_errors();

// Throws ResourceError when the last calls ran out of memory; any other pending error is an assertion. `what` was being
// done.
void check_memory(const std::string& what);

}  // namespace lodestone
