// The decimater of OpenMesh: its half-edges, its quadrics (garland1997) and its heap; the contract is ours (decision
// 0007).
//
// The contract has to be tested twice, when a collapse is ranked and again when its turn comes, since it looks one ring
// further than the decimater updates. The decimater calls `is_collapse_ok` of its mesh both times: that method runs the
// tests of CollapseMesh. A module then reports each collapse to CollapseMesh.
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModBaseT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "core/simplify/contract/collapse_mesh.h"
#include "core/simplify/peers/peers.h"

namespace lodestone {
namespace {

using Id = CollapseMesh::Id;

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

Id id_of(OpenMesh::VertexHandle v) { return static_cast<Id>(v.idx()); }

// Vertex handles are the ids of the input.
class HalfEdgeMesh : public OpenMesh::TriMesh_ArrayKernelT<DoubleTraits> {
 public:
  using Base = OpenMesh::TriMesh_ArrayKernelT<DoubleTraits>;

  HalfEdgeMesh(const SimplifyInput& input, CollapseMesh& contract) : contract_(contract) {
    request_vertex_status();
    request_edge_status();
    request_face_status();
    for (const Vec3f& p : input.positions) add_vertex({p.x, p.y, p.z});
    for (Id v = 0; v < input.positions.size(); ++v) status(handle(v)).set_locked(!contract.is_movable(v));
    for (const Triangle& t : input.triangles) add(t);
  }

  // Hides the method of the same name that the decimater calls. The bound comes first: OpenMesh walks the rings of both
  // vertices, which takes quadratic time around a hub, and from most of its spokes the hub is too far away.
  bool is_collapse_ok(HalfedgeHandle h) {
    const Id from = id_of(from_vertex_handle(h)), to = id_of(to_vertex_handle(h));
    return contract_.within_bound(from, contract_.position(to)) && Base::is_collapse_ok(h) && contract_.allows(from, to);
  }
  [[nodiscard]] CollapseMesh& contract() { return contract_; }

 private:
  VertexHandle handle(Id v) { return VertexHandle(static_cast<int>(v)); }

  // Half-edges hold manifolds only. A triangle at a nonmanifold vertex is left out, and its other corners, which could
  // move it, are locked.
  void add(const Triangle& t) {
    bool is_manifold = true;
    for (const Id v : t.v) is_manifold &= contract_.fan(v) != CollapseMesh::Fan::none;
    if (is_manifold) {
      add_face(handle(t.v[0]), handle(t.v[1]), handle(t.v[2]));
    } else {
      for (const Id v : t.v) status(handle(v)).set_locked(true);
    }
  }

  CollapseMesh& contract_;
};

template <class MeshT>
class ModFollow : public OpenMesh::Decimater::ModBaseT<MeshT> {
 public:
  DECIMATING_MODULE(ModFollow, MeshT, Follow);
  explicit ModFollow(MeshT& mesh) : Base(mesh, true) {}
  void postprocess_collapse(const CollapseInfo& info) override {
    Base::mesh().contract().collapse(id_of(info.v0), id_of(info.v1));
  }
};

class OpenMeshSimplifier final : public Simplifier {
 public:
  const SimplifyResult& simplify(const SimplifyInput& input) override {
    contract_.start(input);
    const std::size_t target = triangles_to_keep(input, contract_.count_movable());
    if (target < input.triangles.size()) decimate(input, target);
    contract_.write_result(result_);
    return result_;
  }

 private:
  void decimate(const SimplifyInput& input, std::size_t target) {
    HalfEdgeMesh mesh(input, contract_);
    OpenMesh::Decimater::DecimaterT<HalfEdgeMesh> decimater(mesh);
    OpenMesh::Decimater::ModQuadricT<HalfEdgeMesh>::Handle quadric;
    ModFollow<HalfEdgeMesh>::Handle follow;
    decimater.add(quadric);
    decimater.add(follow);
    decimater.module(quadric).unset_max_err();
    if (!decimater.initialize()) return;
    // A vertex whose collapse is refused when its turn comes leaves the heap; another run over what is left takes it up
    // again. The decimater counts from all faces it ever had.
    std::size_t before;
    do {
      before = contract_.live();
      const std::size_t excess = before - target;
      decimater.decimate_to_faces(0, mesh.n_faces() > excess ? mesh.n_faces() - excess : 0);
    } while (contract_.live() > target && contract_.live() < before);
  }

  CollapseMesh contract_;
  SimplifyResult result_;
};

}  // namespace

std::unique_ptr<Simplifier> make_openmesh_simplifier() { return std::make_unique<OpenMeshSimplifier>(); }

}  // namespace lodestone
