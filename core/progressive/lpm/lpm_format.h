// The frames and the header of .lpm files, for both directions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/files/json.h"
#include "core/files/json_view.h"
#include "core/progressive/lpm/split_codec.h"
#include "core/progressive/mesh/progressive_mesh.h"

namespace lodestone::progressive {

inline constexpr char lpm_magic[9] = "LODELPM1";

struct LpmHeader {
  CodecSettings settings;
  std::uint32_t vertices = 0, groups = 0, base_groups = 0;
  std::array<double, 2> uv_low{}, uv_step{};
  Transform transform;
  double finest_error = 0;  // as in ProgressiveMesh, with what quantization adds
  std::vector<Material> materials;
  std::vector<std::uint32_t> object_normals;                // as in ProgressiveMesh
  std::vector<GeometryTexture> geometry_images;             // likewise
  std::vector<std::optional<OctahedralLayout>> octahedral;  // likewise
  std::vector<Texture> textures;                            // without their bytes
  std::vector<std::string> thumbnails;  // by texture: the type of its thumbnail; empty if it has none
};

[[nodiscard]] Json to_json(const LpmHeader& header);
[[nodiscard]] LpmHeader read_header(const JsonView& json);

// Frames grow with the mesh: what is on the screen gets finer by a share each time.
[[nodiscard]] inline std::uint32_t splits_in_frame(std::uint32_t groups) {
  return std::min(std::max(groups / 2, 256u), 16384u);
}

}  // namespace lodestone::progressive
