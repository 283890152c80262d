#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "core/simplify/peers/whole_mesh.h"

namespace lodestone {
namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;

Mesh half_edges_of(const PeerMesh& input) {
  Mesh mesh;
  mesh.request_face_normals();
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  std::vector<OpenMesh::VertexHandle> handles;
  for (const Vec3f& p : input.positions) handles.push_back(mesh.add_vertex({p.x, p.y, p.z}));
  for (std::size_t v = 0; v < input.locked.size(); ++v)
    if (input.locked[v]) mesh.status(handles[v]).set_locked(true);
  omerr().disable();  // it complains about each face that it refuses
  for (const auto& [v] : input.triangles) {
    if (mesh.add_face(handles[v[0]], handles[v[1]], handles[v[2]]).is_valid()) continue;
    const auto copy = [&](std::uint32_t w) { return mesh.add_vertex(mesh.point(handles[w])); };
    mesh.add_face(copy(v[0]), copy(v[1]), copy(v[2]));
  }
  omerr().enable();
  mesh.update_face_normals();
  return mesh;
}

}  // namespace

PeerMesh simplify_with_openmesh(const PeerMesh& input, std::size_t triangles) {
  Mesh mesh = half_edges_of(input);
  OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  OpenMesh::Decimater::ModNormalFlippingT<Mesh>::Handle flipping;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.module(quadric).unset_max_err();
  decimater.initialize();
  decimater.decimate_to_faces(0, triangles);

  PeerMesh left;
  for (const auto v : mesh.all_vertices()) {
    const auto p = mesh.point(v);
    left.positions.push_back({p[0], p[1], p[2]});
  }
  for (const auto face : mesh.all_faces()) {
    if (mesh.status(face).deleted()) continue;
    Triangle t;
    int k = 0;
    for (const auto v : mesh.fv_range(face)) t.v[k++] = static_cast<std::uint32_t>(v.idx());
    left.triangles.push_back(t);
  }
  left.locked = input.locked;
  left.locked.resize(left.positions.size(), 0);
  return left;
}

}  // namespace lodestone
