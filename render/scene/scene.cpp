#include "render/scene/scene.h"

#include <algorithm>
#include <filesystem>
#include <limits>

#include "render/camera/placement.h"

namespace lodestone {
namespace {

// Bounds of the root, turned and scaled.
Box3d turned_bounds(const Hierarchy& hierarchy, const Similarity& placement) {
  Box3d box;
  const Box3f& b = hierarchy.cells.front().bounds;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f c{corner & 1 ? b.hi.x : b.lo.x, corner & 2 ? b.hi.y : b.lo.y, corner & 4 ? b.hi.z : b.lo.z};
    box.extend(placement(to_double(c)));
  }
  return box;
}

}  // namespace

Similarity placement_of(const SceneModel& model, const Hierarchy& hierarchy) {
  const Similarity own = to_similarity(hierarchy.transform);
  Similarity place;
  place.rotation = rotation_about_axes(model.rotation);
  place.scale = model.scale;
  if (model.extent) {
    const Box3d box = turned_bounds(hierarchy, place * own);
    const Vec3d size = box.hi - box.lo;
    place.scale = *model.extent / std::max({size.x, size.y, size.z, std::numeric_limits<double>::min()}) * model.scale;
  }
  place.translation = model.position;
  if (model.anchor != Anchor::origin) {
    const Box3d box = turned_bounds(hierarchy, place * own);
    Vec3d at = 0.5 * (box.lo + box.hi);
    if (model.anchor == Anchor::base) at.z = box.lo.z;
    place.translation = model.position + (model.position - at);
  }
  return place * own;
}

Scene scene_of(const std::string& file) {
  Scene scene;
  scene.models.emplace_back();
  scene.models.back().name = std::filesystem::path(file).stem().string();
  scene.models.back().file = file;
  scene.camera.path = "fly-in";
  return scene;
}

}  // namespace lodestone
