// Reconstructions of small meshes: their settings, and their distance from the model.
#pragma once

#include <algorithm>

#include "core/spatial/mesh_distance.h"
#include "render/reconstruct/reconstruct.h"
#include "tests/render/reconstruct/obvious_map.h"

namespace lodestone::test {

inline ReconstructConfig small_config(double resolution) {
  ReconstructConfig config;
  config.resolution = resolution;
  config.views.candidates = 24;
  config.views.samples = 4000;
  config.views.resolution = 64;
  return config;
}

inline RawMesh original(const IndexedMesh& mesh) {
  RawMesh raw;
  for (const Vec3f& p : mesh.positions) raw.positions.push_back(mesh.transform.to_model(p));
  raw.triangles = mesh.triangles;
  return raw;
}

// Root mean square of distances, in shares of the diagonal of the model.
inline double diagonal_share(const RawMesh& result, const IndexedMesh& mesh) {
  const MeshDistance d = compare_meshes(original(mesh), result);
  return std::max(d.forward.rms, d.backward.rms) / d.diagonal;
}

}  // namespace lodestone::test
