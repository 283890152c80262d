// Files of progressive meshes: .lpm (lpm.h) and .glb (progressive_glb.h).
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "core/progressive/lpm/lpm.h"
#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

struct ProgressiveFileConfig {
  LpmConfig lpm;
  bool compress_glb = false;
};

struct ProgressiveFileSize {
  std::size_t bytes = 0;
  std::size_t geometry = 0;  // of these, all but images
  std::size_t base = 0;      // what has to be there before something can be drawn; all of a .glb
};

// By the extension, in any case; complete or not at all. Throws UnsupportedError for other extensions, FileError when
// it cannot be written.
ProgressiveFileSize save_progressive(const ProgressiveMesh& mesh, const std::filesystem::path& path,
                                     const ProgressiveFileConfig& config = {});

// By the first bytes. `prefix`: of an .lpm that ends early, what there is. Throws FileError, InputError naming the
// place.
[[nodiscard]] ProgressiveMesh load_progressive(const std::filesystem::path& path, bool prefix = false);

// The same from bytes.
[[nodiscard]] ProgressiveMesh read_progressive(ByteReader& input, bool prefix = false);

}  // namespace lodestone
