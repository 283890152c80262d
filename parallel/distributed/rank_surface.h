// The attributes of a mesh as the ranks read them, and the materials and textures of all.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/distributed/messages/ranks.h"

namespace lodestone {

// The arrays of RawWedges that a mesh has.
struct SurfaceKinds {
  bool uv = false, normals = false, colours = false, materials = false;
  [[nodiscard]] bool any() const { return uv || normals || colours || materials; }
  void add(const SurfaceKinds& more) {
    uv |= more.uv, normals |= more.normals, colours |= more.colours, materials |= more.materials;
  }
};
[[nodiscard]] SurfaceKinds kinds_of(const RawMesh& mesh);

// The attributes of all files together, and of the part of the mesh that a rank has read.
struct RankSurface {
  SurfaceKinds kinds;               // of all ranks
  std::size_t wedges = 0;           // of the own part
  RawWedges own;                    // all kinds of arrays, with `corners`; materials are indices into those of all
  std::vector<Material> materials;  // of all: at rank 0
  std::vector<Texture> textures;
};

// Memory of the attributes, and of the textures: of these twice, as they are written, too.
[[nodiscard]] std::uint64_t surface_bytes(const RankSurface& surface);

// Called by all ranks, with the part that each has read, and the kinds of all parts together, at least one. Materials
// and textures, of which equal ones become one as by append_mesh, go to rank 0. Takes the attributes out of the mesh.
// `name` is for messages.
[[nodiscard]] RankSurface share_surface(RawMesh& own, const SurfaceKinds& kinds, const std::string& name, Ranks& ranks);

}  // namespace lodestone
