// The nodes of a glTF scene.
#pragma once

#include <cstddef>
#include <vector>

#include "core/formats/gltf/gltf_document.h"
#include "core/math/affine.h"

namespace lodestone {

struct GltfMeshNode {
  std::size_t node = 0;  // index in "nodes"; it has a mesh
  Affine3d map;          // from the mesh to the scene
};

// The nodes with meshes below the default scene (the first one where none is named; where there are no scenes, below
// every node that is no child), parents before children, in file order. Throws InputError for a node that is met twice:
// the nodes would form no tree, and might go round in circles.
[[nodiscard]] std::vector<GltfMeshNode> list_mesh_nodes(const GltfDocument& document);

// A 4 x 4 matrix by columns. Throws InputError when its last row is not (0, 0, 0, 1).
[[nodiscard]] Affine3d affine_of(const JsonView& matrix);

}  // namespace lodestone
