#include <meshoptimizer.h>

#include <algorithm>

#include "core/simplify/peers/whole_mesh.h"

namespace lodestone {
namespace {

constexpr float any_error = 1e9f;

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
                       sizeof(Vec3f), 3 * triangles, any_error, locks ? meshopt_SimplifyLockBorder : 0, nullptr);
  return with_indices(mesh, out, count);
}

PeerMesh cluster_with_meshoptimizer(const PeerMesh& mesh, std::size_t triangles) {
  std::vector<unsigned> out(3 * mesh.triangles.size());
  const std::size_t count =
      meshopt_simplifySloppy(out.data(), mesh.triangles[0].v.data(), out.size(), &mesh.positions[0].x,
                             mesh.positions.size(), sizeof(Vec3f), 3 * triangles, any_error, nullptr);
  return with_indices(mesh, out, count);
}

}  // namespace lodestone
