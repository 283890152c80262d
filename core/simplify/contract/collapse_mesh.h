// A triangle mesh under half-edge collapses, with every test of the simplifiers' contract (simplifier.h).
//
// Written to be read and to take any input: stars are lists of triangle ids, members of a vertex a linked list, and
// everything is computed in double. The order of the collapses comes from outside: an exact heap
// (quadric_reference.cpp), another library's decimater (half_edge_simplifier.cpp) or its finished mesh
// (meshopt_simplifier.cpp). The kernel in quadric_kernel.h keeps the same rules on compact rings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/simplify/contract/simplifier.h"

namespace lodestone {

class CollapseMesh {
 public:
  using Id = std::uint32_t;

  // The connection of the triangles around a vertex.
  enum class Fan : std::uint8_t {
    closed,  // one closed fan
    open,    // one open fan, on the border of the surface
    none     // no triangles, several fans, or edges with more than two triangles or in the same direction twice
  };

  // Takes the mesh of the input, which must outlive it, as it is; reuses the memory of the mesh before.
  void start(const SimplifyInput& input);

  [[nodiscard]] std::size_t live() const { return live_; }                          // triangles left
  [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }  // degenerate where collapsed
  [[nodiscard]] std::span<const Id> star(Id v) const { return star_[v]; }           // triangles; empty once collapsed
  [[nodiscard]] Vec3d position(Id v) const { return position_[v]; }
  [[nodiscard]] Fan fan(Id v) const { return fan_[v]; }  // in the input; collapses do not change it
  // One fan and not locked: the only vertices that may collapse or move.
  [[nodiscard]] bool is_movable(Id v) const { return fan_[v] != Fan::none && input_.locked[v] == 0; }
  [[nodiscard]] std::size_t count_movable() const;       // in the input
  [[nodiscard]] std::vector<Id> neighbours(Id v) const;  // ascending

  // True if v may collapse into its neighbour u: both have one label, and all of the following three hold.
  [[nodiscard]] bool allows(Id v, Id u) const {
    const bool alike = input_.labels.empty() || input_.labels[v] == input_.labels[u];
    return is_movable(v) && alike && within_bound(v, position_[u]) && keeps_topology(v, u) &&
           !flips(v, position_[u], u);
  }
  // Bound (1) for everything that has collapsed into v, v itself included.
  [[nodiscard]] bool within_bound(Id v, Vec3d to) const;
  // The link condition (dey1999), borders along borders, no chord between locked vertices, no triangle twice.
  [[nodiscard]] bool keeps_topology(Id v, Id u) const;
  // True if moving v turns a triangle of its star by 90 degrees or more; triangles with `skip` are not counted.
  [[nodiscard]] bool flips(Id v, Vec3d to, Id skip) const;

  // Collapses v and all its members into u.
  void collapse(Id v, Id u);
  void move(Id v, Vec3d to) { position_[v] = to; }

  // Writes P, positions and the count; leaves distances empty.
  void write_result(SimplifyResult& result) const;

 private:
  [[nodiscard]] Fan fan_of(Id v) const;
  void gather_neighbours(Id v, std::vector<Id>& ring) const;
  [[nodiscard]] bool makes_locked_chord(Id u, const std::vector<Id>& ring) const;
  [[nodiscard]] bool doubles_triangle(Id v, Id u) const;

  SimplifyInput input_;
  std::vector<Triangle> triangles_;
  std::vector<std::vector<Id>> star_;
  std::vector<Vec3d> position_;
  std::vector<Fan> fan_;
  std::vector<Id> next_member_, last_member_;  // of the list that begins with the vertex itself
  std::size_t live_ = 0;
  mutable std::vector<Id> ring_, target_ring_, opposite_, common_;  // scratch of keeps_topology
};

}  // namespace lodestone
