// The nodes of a glTF scene: which meshes it shows, and where.
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

// The nodes with meshes below the default scene (the first one if none is named; without scenes, below every node that
// is not a child), parents before children, in file order. Throws InputError for a node that is met twice, since the
// nodes would not form a tree and might contain a cycle.
[[nodiscard]] std::vector<GltfMeshNode> list_mesh_nodes(const GltfDocument& document);

// The maps of the instances of a node's mesh (EXT_mesh_gpu_instancing); the identity alone without the extension.
[[nodiscard]] std::vector<Affine3d> instances_of(GltfDocument& document, const JsonView& node);

}  // namespace lodestone
