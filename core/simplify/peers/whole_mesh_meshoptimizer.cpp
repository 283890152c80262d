#include <meshoptimizer.h>

#include <algorithm>

#include "core/base/error.h"
#include "core/simplify/peers/whole_mesh.h"

namespace lodestone {
namespace {

constexpr float no_error_limit = 1e9f;

PeerMesh with_indices(const PeerMesh& mesh, const std::vector<unsigned>& indices, std::size_t count) {
  PeerMesh left{mesh.positions, {}, mesh.locked};
  for (std::size_t i = 0; i < count; i += 3) left.triangles.push_back({{indices[i], indices[i + 1], indices[i + 2]}});
  return left;
}

}  // namespace

PeerMesh simplify_with_meshoptimizer(const PeerMesh& mesh, std::size_t triangles) {
  std::vector<unsigned> out(3 * mesh.triangles.size());
  const bool locks = std::ranges::count(mesh.locked, 0) != static_cast<std::ptrdiff_t>(mesh.locked.size());
  const std::size_t count =
      meshopt_simplify(out.data(), mesh.triangles[0].v.data(), out.size(), &mesh.positions[0].x, mesh.positions.size(),
                       sizeof(Vec3f), 3 * triangles, no_error_limit, locks ? meshopt_SimplifyLockBorder : 0, nullptr);
  return with_indices(mesh, out, count);
}

PeerMesh cluster_with_meshoptimizer(const PeerMesh& mesh, std::size_t triangles) {
  std::vector<unsigned> out(3 * mesh.triangles.size());
  const std::size_t count =
      meshopt_simplifySloppy(out.data(), mesh.triangles[0].v.data(), out.size(), &mesh.positions[0].x,
                             mesh.positions.size(), sizeof(Vec3f), 3 * triangles, no_error_limit, nullptr);
  return with_indices(mesh, out, count);
}

#if MESHOPTIMIZER_VERSION >= 1020

bool has_meshoptimizer_remesher() { return true; }

PeerMesh remesh_with_meshoptimizer(const PeerMesh& mesh, int voxels) {
  const auto remesh = [&](std::vector<Vec3f>& corners) {
    return meshopt_remesh(corners.empty() ? nullptr : &corners[0].x, corners.size() / 3, mesh.triangles[0].v.data(),
                          3 * mesh.triangles.size(), &mesh.positions[0].x, mesh.positions.size(), sizeof(Vec3f),
                          std::clamp(voxels, 4, 256), meshopt_RemeshSolve);
  };
  // About six triangles a square of voxels, on a surface a few times that of the box; again where that was too few.
  std::vector<Vec3f> corners(std::size_t{3} * 40 * 256 * 256);
  std::size_t count = remesh(corners);
  if (3 * count > corners.size()) corners.resize(3 * count), count = remesh(corners);
  corners.resize(3 * count);
  std::vector<unsigned> number(corners.size());
  const std::size_t vertices = meshopt_generateVertexRemap(number.data(), nullptr, corners.size(), corners.data(),
                                                           corners.size(), sizeof(Vec3f));
  PeerMesh made;
  made.positions.resize(vertices);
  for (std::size_t k = 0; k < corners.size(); ++k) made.positions[number[k]] = corners[k];
  for (std::size_t k = 0; k < corners.size(); k += 3)
    made.triangles.push_back({{number[k], number[k + 1], number[k + 2]}});
  return made;
}

#else

bool has_meshoptimizer_remesher() { return false; }

PeerMesh remesh_with_meshoptimizer(const PeerMesh&, int) {
  throw Error("meshoptimizer: this version has no remesher; version 1.2 has");
}

#endif

}  // namespace lodestone
