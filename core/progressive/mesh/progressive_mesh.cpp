#include "core/progressive/mesh/progressive_mesh.h"

#include <cmath>
#include <string>

#include "core/base/error.h"

namespace lodestone {

void check_progressive(const ProgressiveMesh& mesh, const std::string& name) {
  const auto fail = [&](const std::string& place, const std::string& what) {
    throw InputError(describe(name, place, what, "make it anew with `lodestone progressive`"));
  };
  const std::uint32_t count = mesh.vertex_count();
  if (mesh.parents.size() != count || mesh.errors.size() != count)
    fail("", "parents and errors are not one per vertex");
  if (!(mesh.finest_error >= 0) || !std::isfinite(mesh.finest_error))
    fail("", "the error of the finest level is not a distance");
  if (mesh.base_vertices > count) fail("", "the base has more vertices than the mesh");
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::string place = "vertex " + std::to_string(v);
    if (!is_finite(mesh.positions[v])) fail(place, "the position is not finite");
    if (v >= mesh.base_vertices && mesh.parents[v] >= v) fail(place, "the parent comes in after it");
    if (!(mesh.errors[v] >= 0) || !std::isfinite(mesh.errors[v])) fail(place, "the error is not a distance");
    if (v > 0 && mesh.errors[v] > mesh.errors[v - 1]) fail(place, "the error is larger than that of the vertex before");
  }
  if (!mesh.tangents.empty() && mesh.tangents.size() != count) fail("", "tangents are not one per vertex");
  for (const GeometryTexture& image : mesh.geometry_images)
    if (!is_finite(image.origin) || !(image.step > 0)) fail("geometry image", "the step is not positive");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t id : mesh.triangles[t].v)
      if (id >= count) fail("triangle " + std::to_string(t), "there is no vertex " + std::to_string(id));
}

}  // namespace lodestone
