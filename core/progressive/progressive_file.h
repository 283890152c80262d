// Files of progressive meshes: .lpm (lpm.h) and .glb (progressive_glb.h).
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "core/progressive/collapse/metric_kind.h"
#include "core/progressive/lpm/lpm.h"
#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone {

class ByteReader;
struct Runner;  // core/base/runner.h

struct ProgressiveFileConfig {
  LpmConfig lpm = {};
  bool compress_glb = false;
};

struct ProgressiveFileSize {
  std::size_t bytes = 0;
  std::size_t geometry = 0;  // the part without images and thumbnails
  std::size_t base = 0;      // the part needed before anything can be drawn
  double finest_error = 0;   // ProgressiveMesh::finest_error of the mesh that a reader gets
};

// False for .lpm. Normals are then to be left out before a mesh is made progressive: they would cut it at their seams,
// and keep vertices where they turn at the price of the shape, for nothing.
[[nodiscard]] bool keeps_normals(const std::filesystem::path& path);

// The metric for a mesh with these attributes: attribute_quadric if any of them vary over the surface (normals,
// colours, texture coordinates), for these slide and smear where geometry alone decides; otherwise quadric, which is
// nearer to the surface.
[[nodiscard]] progressive::MetricKind fitting_metric(const WedgeAttributes& attributes);

// The extension, in upper or lower case, decides on the format. The file is written completely or not at all. Throws
// UnsupportedError for other extensions, FileError if it cannot be written. The thumbnails are
// made by the runner, if there is one.
ProgressiveFileSize save_progressive(const ProgressiveMesh& mesh, const std::filesystem::path& path,
                                     const ProgressiveFileConfig& config = {});
ProgressiveFileSize save_progressive(const ProgressiveMesh& mesh, const std::filesystem::path& path,
                                     const ProgressiveFileConfig& config, const Runner& runner);

// The first bytes decide on the format. `prefix`: as in read_lpm(). Throws FileError, and InputError with the place.
[[nodiscard]] ProgressiveMesh load_progressive(const std::filesystem::path& path, bool prefix = false);

// The same from bytes.
[[nodiscard]] ProgressiveMesh read_progressive(ByteReader& input, bool prefix = false);

}  // namespace lodestone
