#include "core/progressive/progressive_file.h"

#include <algorithm>
#include <cctype>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/byte_reader.h"
#include "core/progressive/gltf/progressive_glb.h"
#include "core/progressive/mesh/thumbnails.h"

namespace lodestone {
namespace {

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// Images of which there is a thumbnail come last.
ProgressiveFileSize glb_size(const ProgressiveMesh& mesh, std::span<const Texture> thumbnails, std::size_t bytes) {
  ProgressiveFileSize size{bytes, bytes, bytes, mesh.finest_error};
  for (std::size_t k = 0; k < thumbnails.size(); ++k) {
    const std::size_t image = mesh.wedges.textures[k].bytes.size(), thumbnail = thumbnails[k].bytes.size();
    const bool has_copy = thumbnail > 0 && thumbnails[k].bytes != mesh.wedges.textures[k].bytes;
    size.geometry -= image + (has_copy ? thumbnail : 0);
    if (has_copy) size.base -= (image + 3) / 4 * 4;
  }
  return size;
}

}  // namespace

bool keeps_normals(const std::filesystem::path& path) { return lower_extension(path) != ".lpm"; }

progressive::MetricKind fitting_metric(const WedgeAttributes& attributes) {
  const bool any = !attributes.normal.empty() || !attributes.colour.empty() || !attributes.uv.empty();
  return any ? progressive::MetricKind::attribute_quadric : progressive::MetricKind::quadric;
}

ProgressiveFileSize save_progressive(const ProgressiveMesh& mesh, const std::filesystem::path& path,
                                     const ProgressiveFileConfig& config) {
  return save_progressive(mesh, path, config, Runner{});
}

ProgressiveFileSize save_progressive(const ProgressiveMesh& mesh, const std::filesystem::path& path,
                                     const ProgressiveFileConfig& config, const Runner& runner) {
  const std::string extension = lower_extension(path);
  const std::vector<Texture> thumbnails = make_thumbnails(mesh, runner);
  std::vector<std::byte> bytes;
  ProgressiveFileSize size;
  if (extension == ".lpm") {
    LpmBytes lpm = encode_lpm(mesh, config.lpm, thumbnails);
    size = {lpm.bytes.size(), lpm.geometry, lpm.base, lpm.finest_error};
    bytes = std::move(lpm.bytes);
  } else if (extension == ".glb") {
    bytes = encode_progressive_glb(mesh, config.compress_glb, thumbnails);
    size = glb_size(mesh, thumbnails, bytes.size());
  } else {
    throw UnsupportedError(describe(path.string(), "", "progressive meshes are not written to '" + extension + "'",
                                    "give a name that ends in .lpm or .glb"));
  }
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
  return size;
}

ProgressiveMesh read_progressive(ByteReader& input, bool prefix) {
  return input.window(4).starts_with("glTF") ? read_progressive_glb(input) : read_lpm(input, prefix);
}

ProgressiveMesh load_progressive(const std::filesystem::path& path, bool prefix) {
  ByteReader input(path);
  return read_progressive(input, prefix);
}

}  // namespace lodestone
