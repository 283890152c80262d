// Blocks of meshes with attributes: what cells store are wedges, what is simplified are vertices.
//
// Wedges of one vertex stand at the same position and have to move together. The block welds them before simplifying
// and takes P of the vertices back to the wedges afterwards: pos(P(wedge)) = P(pos(wedge)), and every wedge stays in
// its chart (a chart is a part of the surface that hangs together by its wedges).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/base/disjoint_sets.h"
#include "core/base/key_numbers.h"
#include "core/math/vec3.h"
#include "core/simplify/contract/simplifier.h"

namespace lodestone {

// Working memory of one worker, reused between blocks.
class BlockWedges {
 public:
  // vertex_ids: of each wedge, equal for wedges of one vertex; positions, locked: of each wedge; corners: the triangles
  // by wedge. The spans must outlive the calls below. Afterwards a wedge is locked if any of its vertex is.
  void weld(std::span<const std::uint32_t> vertex_ids, std::span<const Vec3f> positions,
            std::span<const Triangle> corners, std::span<std::uint8_t> locked);

  // The block by vertices. Simplifiers that do not know wedges get the charts around each vertex as its label.
  [[nodiscard]] const SimplifyResult& simplify(Simplifier& simplifier, float max_displacement,
                                               std::size_t target_triangles, double least_share, Lattice lattice = {});

  // Vertex of each wedge in [0, vertices()).
  [[nodiscard]] std::span<const std::uint32_t> vertex() const { return vertex_; }
  [[nodiscard]] std::size_t vertices() const { return positions_.size(); }

  // For each wedge that survives and has moved: a triangle of the block that had its vertex, and where in it the new
  // position is nearest, as weights of the three corners. What the wedge's attributes are interpolated from.
  struct Moved {
    std::uint32_t wedge = 0, triangle = 0;
    std::array<float, 3> weight{};
  };
  [[nodiscard]] std::span<const Moved> moved() const { return moved_; }

 private:
  void label_charts();
  void resolve_by_chart(const SimplifyResult& by_vertex);
  void find_moved(const SimplifyResult& by_vertex);
  void expand(const SimplifyResult& by_vertex);

  std::span<const Triangle> corners_;
  std::vector<std::uint32_t> vertex_;  // of each wedge
  KeyNumbers<std::uint32_t> vertices_;
  std::vector<std::uint32_t> first_wedge_;  // of each vertex
  std::vector<Vec3f> positions_;            // of each vertex
  std::vector<std::uint8_t> locked_;
  std::vector<Triangle> triangles_;  // by vertex
  DisjointSets charts_;              // of the wedges
  std::vector<std::uint32_t> labels_;
  std::map<std::vector<std::uint32_t>, std::uint32_t> label_of_;  // of charts that meet at a vertex
  std::vector<std::uint32_t> next_wedge_;                         // of the same vertex; itself at the end
  std::vector<Moved> moved_;
  std::vector<std::uint32_t> moved_of_;  // of each vertex: its index in moved_
  std::vector<double> nearest_;          // of each vertex, while find_moved looks
  SimplifyResult by_wedge_;
};

}  // namespace lodestone
