#include "render/position_map/map_files.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/json.h"
#include "core/files/temporaries.h"
#include "core/files/text_file.h"
#include "core/mesh/up_axis.h"
#include "render/position_map/map_view.h"
#include "render/position_map/read_map.h"

namespace lodestone {
namespace {

Json to_json(Vec3d v) { return Json::array({v.x, v.y, v.z}); }

Vec3d vector_of(const Json& value) {
  if (!value.is_array() || value.size() != 3) throw std::runtime_error("three numbers were expected");
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

Json to_json(const MapView& view, const std::string& file) {
  return {{"file", file},
          {"projection", view.projection == Projection::perspective ? "perspective" : "orthographic"},
          {"eye", to_json(view.eye)},
          {"right", to_json(view.right)},
          {"up", to_json(view.up)},
          {"forward", to_json(view.forward)},
          {"pixel", view.pixel},
          {"nearest", view.nearest},
          {"width", view.width},
          {"height", view.height}};
}

MapView view_of(const Json& value) {
  MapView view;
  const std::string projection = value.value("projection", "orthographic");
  if (projection != "orthographic" && projection != "perspective")
    throw std::runtime_error("projection '" + projection + "' is neither orthographic nor perspective");
  view.projection = projection == "perspective" ? Projection::perspective : Projection::orthographic;
  view.eye = vector_of(value.at("eye"));
  view.right = vector_of(value.at("right"));
  view.up = vector_of(value.at("up"));
  view.forward = vector_of(value.at("forward"));
  view.pixel = value.at("pixel").get<double>();
  view.nearest = value.value("nearest", 0.0);
  view.width = view.height = 1;  // the file tells
  return view;
}

Transform transform_of(const Json& list) {
  Transform transform;
  if (!list.contains("transform")) return transform;
  transform.origin = vector_of(list.at("transform").at("origin"));
  transform.scale = list.at("transform").at("scale").get<double>();
  if (!is_finite(transform.origin) || !(transform.scale > 0) || !std::isfinite(transform.scale))
    throw std::runtime_error("the transform is not finite or has no scale");
  if (const Json& from = list.at("transform"); from.contains("up")) {
    const auto axis = up_axis_named(from.at("up").get<std::string>());
    if (!axis)
      throw std::runtime_error("up '" + from.at("up").get<std::string>() + "' is none of x, y, z, -x, -y, -z, earth");
    transform.up = {*axis, false};
  }
  return transform;
}

std::filesystem::path list_path(const std::filesystem::path& path) {
  return std::filesystem::is_directory(path) ? path / "views.json" : path;
}

}  // namespace

void complete_map(PositionMap& map, const std::string& name) {
  check_view(map.view, name);
  const std::size_t n = map.view.pixels(), width = static_cast<std::size_t>(map.view.width);
  if (map.triangle.empty()) map.triangle.assign(n, 0);
  const bool measure = map.depth.empty();
  map.depth.resize(n);
  std::size_t seen = 0, astray = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!is_finite(map.position[i])) map.triangle[i] = no_triangle;
    if (!map.sees(i)) {
      map.position[i] = {}, map.depth[i] = 0;
      if (!map.normal.empty()) map.normal[i] = {};
      if (!map.uv.empty()) map.uv[i] = {};
      if (!map.colour.empty()) map.colour[i] = {0, 0, 0, 0};
      continue;
    }
    const WindowPoint w = to_window(map.view, to_double(map.position[i]));
    if (measure || !std::isfinite(map.depth[i])) map.depth[i] = static_cast<float>(w.depth);
    if (!map.normal.empty() && !is_finite(map.normal[i])) map.normal[i] = {};
    ++seen;
    const double dx = w.x - (static_cast<double>(i % width) + 0.5), dy = w.y - (static_cast<double>(i / width) + 0.5);
    astray += !(std::abs(dx) <= 1) || !(std::abs(dy) <= 1);
  }
  if (2 * astray > seen)
    throw InputError(describe(
        name, "",
        std::to_string(astray) + " of " + std::to_string(seen) + " positions do not lie on the rays of the view",
        "check eye, directions and pixel of the view, and that row 0 is on top"));
}

void write_map_set(const std::filesystem::path& folder, std::span<const PositionMap> maps, MapSurface surface,
                   MapFormat format) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw FileError(describe(folder.string(), "", "cannot be made: " + failed.message()));
  remove_orphans(folder, [](std::string_view name) { return name.starts_with("view"); });
  Json views = Json::array();
  for (std::size_t k = 0; k < maps.size(); ++k) {
    std::string number = std::to_string(k);
    number.insert(0, 3 - std::min<std::size_t>(3, number.size()), '0');
    const std::string name = "view" + number + (format == MapFormat::exr ? ".exr" : ".pfm");
    format == MapFormat::exr ? write_exr_map(folder / name, maps[k]) : write_pfm_map(folder / name, maps[k]);
    views.push_back(to_json(maps[k].view, name));
  }
  const Transform transform = maps.empty() ? Transform{} : maps.front().transform;
  const Json list = {
      {"transform",
       {{"origin", to_json(transform.origin)}, {"scale", transform.scale}, {"up", name_of(transform.up.axis)}}},
      {"closed", surface.closed},
      {"oriented", surface.oriented},
      {"views", views}};
  AtomicFile file(folder / "views.json");
  const std::string text = list.dump(1) + "\n";
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

MapSet read_map_set(const std::filesystem::path& path) {
  const std::filesystem::path file = list_path(path);
  MapSet set;
  try {
    const Json list = Json::parse(read_text(file));
    const Transform transform = transform_of(list);
    set.closed = list.value("closed", false), set.oriented = list.value("oriented", false);
    for (const Json& entry : list.at("views")) {
      const std::filesystem::path image = file.parent_path() / entry.at("file").get<std::string>();
      const MapView view = view_of(entry);
      check_view(view, image.string());
      set.maps.push_back(without_gaps(image.extension() == ".pfm" ? read_pfm_map(image, view, transform)
                                                                  : read_exr_map(image, view, transform)));
    }
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(describe(file.string(), "", std::string("is not a list of views: ") + error.what()));
  }
  if (set.maps.empty()) throw InputError(describe(file.string(), "", "lists no view"));
  return set;
}

bool is_map_set(const std::filesystem::path& path) {
  std::error_code ignored;
  return path.filename() == "views.json" ||
         (std::filesystem::is_directory(path, ignored) && std::filesystem::exists(path / "views.json", ignored));
}

}  // namespace lodestone
