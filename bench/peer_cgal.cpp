#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Constrained_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "bench/peers.h"

namespace lodestone::bench {
namespace {

namespace simplification = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Border edges are not collapsed, and their vertices are kept.
struct BorderEdges {
  using key_type = Mesh::Edge_index;
  using value_type = bool;
  using reference = bool;
  using category = boost::readable_property_map_tag;
  const Mesh* mesh;
  friend bool get(BorderEdges map, key_type edge) { return map.mesh->is_border(edge); }
};

struct EnoughFaces {
  std::size_t triangles;
  template <class Cost, class Profile>
  bool operator()(const Cost&, const Profile& profile, std::size_t, std::size_t) const {
    return profile.surface_mesh().number_of_faces() <= triangles;
  }
};

}  // namespace

PeerMesh simplify_with_cgal(const PeerMesh& input, std::size_t triangles) {
  Mesh mesh;
  for (const Vec3f& p : input.positions) mesh.add_vertex({p.x, p.y, p.z});
  for (const auto& [v] : input.triangles)
    mesh.add_face(Mesh::Vertex_index(v[0]), Mesh::Vertex_index(v[1]), Mesh::Vertex_index(v[2]));
  using Placement = simplification::LindstromTurk_placement<Mesh>;
  const BorderEdges border{&mesh};
  simplification::edge_collapse(
      mesh, EnoughFaces{triangles},
      CGAL::parameters::edge_is_constrained_map(border)
          .get_cost(simplification::LindstromTurk_cost<Mesh>())
          .get_placement(simplification::Constrained_placement<Placement, BorderEdges>(border)));

  PeerMesh left;
  left.positions.resize(input.positions.size());
  left.locked = input.locked;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    left.positions[v] = to_float({p.x(), p.y(), p.z()});
  }
  for (const auto face : mesh.faces()) {
    Triangle t;
    int k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(face))) t.v[k++] = static_cast<std::uint32_t>(v);
    left.triangles.push_back(t);
  }
  return left;
}

}  // namespace lodestone::bench
