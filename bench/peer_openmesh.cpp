#include "bench/peer_openmesh.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

namespace lodestone::bench {

std::vector<unsigned> decimate_with_openmesh(const Chunk& chunk, double share) {
  using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;
  Mesh mesh;
  mesh.request_face_normals();
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  std::vector<OpenMesh::VertexHandle> handles;
  for (const Vec3f& p : chunk.positions) handles.push_back(mesh.add_vertex({p.x, p.y, p.z}));
  for (std::size_t v = 0; v < handles.size(); ++v)
    if (chunk.locked[v]) mesh.status(handles[v]).set_locked(true);
  for (const auto& [v] : chunk.triangles) mesh.add_face(handles[v[0]], handles[v[1]], handles[v[2]]);
  mesh.update_face_normals();

  OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  OpenMesh::Decimater::ModNormalFlippingT<Mesh>::Handle flipping;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to_faces(0, static_cast<std::size_t>(share * static_cast<double>(chunk.triangles.size())));

  std::vector<unsigned> indices;
  for (const auto face : mesh.faces())
    if (!mesh.status(face).deleted())
      for (const auto v : mesh.fv_range(face)) indices.push_back(static_cast<unsigned>(v.idx()));
  return indices;
}

}  // namespace lodestone::bench
