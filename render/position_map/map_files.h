// Position maps as files: OpenEXR images, portable float maps, and the list of the views that belong to them, so that
// maps of other renderers can be reconstructed, too.
//
// views.json names, for each view, its file and the geometry of MapView, in the space of the positions; and once, the
// transform from there to the model's space:
//
//     {"transform": {"origin": [x, y, z], "scale": s, "up": "y"}, "closed": true, "oriented": true,
//      "views": [{"file": "view000.exr", "projection": "orthographic", "eye": [..], "right": [..], "up": [..],
//                 "forward": [..], "pixel": p, "nearest": d}, ...]}
//
// Everything but "views" may be left out: no transform, an open surface whose sides are not distinguished; of a
// transform, "up" (z is guessed); of a view, "nearest". An EXR file has channels X, Y, Z (float), and, where there are
// any: triangle (uint), depth, NX, NY, NZ, U, V (float), R, G, B, A (as bytes / 255). A PFM file has X, Y, Z. X, Y and
// Z are NaN in pixels that see nothing.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "render/position_map/position_map.h"

namespace lodestone {

enum class MapFormat : std::uint8_t { exr, pfm };

// Complete or not there. Throws FileError when the file cannot be written.
void write_exr_map(const std::filesystem::path& path, const PositionMap& map);
void write_pfm_map(const std::filesystem::path& path, const PositionMap& map);

// Reads a map for a view whose width and height are taken from the file. If the file has no depths they are computed;
// if it has no triangles, a pixel that sees the surface sees triangle 0; normals may be missing. Throws FileError when
// the file cannot be read, InputError when it is not such an image, has no positions, is larger than largest_map_side,
// or when most positions do not lie within a pixel of the rays of the view.
[[nodiscard]] PositionMap read_exr_map(const std::filesystem::path& path, const MapView& view,
                                       const Transform& transform);
[[nodiscard]] PositionMap read_pfm_map(const std::filesystem::path& path, const MapView& view,
                                       const Transform& transform);

// The surface that maps show, as DrawnMaps has it.
struct MapSurface {
  bool closed = false, oriented = false;
};
struct MapSet : MapSurface {
  std::vector<PositionMap> maps;
};

// Writes view000.exr (or .pfm) and so on, and then views.json, into a folder, which is made if need be.
void write_map_set(const std::filesystem::path& folder, std::span<const PositionMap> maps, MapSurface surface,
                   MapFormat format);
// `path`: a views.json, or the folder of one. Throws as the readers do, and InputError for a malformed list.
[[nodiscard]] MapSet read_map_set(const std::filesystem::path& path);
// True if a path names a list of views: a views.json, or a folder that contains one.
[[nodiscard]] bool is_map_set(const std::filesystem::path& path);

}  // namespace lodestone
