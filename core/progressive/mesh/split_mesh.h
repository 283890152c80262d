// A mesh that grows by vertex splits, which undo the collapses of a progressive mesh: the state of its codec.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "core/math/vec3.h"

namespace lodestone::progressive {

// Vertices here are groups (activation.h), counted in the order in which they come in; wedges are the vertices of the
// file.
struct SplitMesh {
  struct Spoke {
    std::uint32_t vertex = 0;
    std::uint32_t wedge = 0;  // of the vertex in the middle, in the triangle between this spoke and the next
  };
  struct Star {
    std::vector<Spoke> spokes;  // as in Ring (ring_mesh.h)
    bool open = false;
    std::uint32_t first_wedge = 0, wedges = 1;

    [[nodiscard]] std::size_t sectors() const { return spokes.size() - (open ? 1 : 0); }
    [[nodiscard]] std::size_t next(std::size_t k) const { return k + 1 < spokes.size() ? k + 1 : 0; }
    [[nodiscard]] std::size_t previous(std::size_t k) const { return k > 0 ? k - 1 : spokes.size() - 1; }
    // Throws InputError if there is no such spoke, which no encoder asks for.
    [[nodiscard]] std::size_t find(std::uint32_t vertex) const {
      for (std::size_t k = 0; k < spokes.size(); ++k)
        if (spokes[k].vertex == vertex) return k;
      throw InputError("inconsistent vertex splits");
    }
  };

  enum class Side : std::uint32_t { inside = 0, back = 1, front = 2 };  // of an open star: the new vertex's place

  // The vertex comes out of `parent` and takes the `between` spokes after its spoke `at` (before it, for
  // Side::front).
  struct Split {
    std::uint32_t parent = 0;
    Side side = Side::inside;
    std::uint32_t at = 0, between = 0;
    std::uint32_t neighbour = 0;         // at spoke `at`, for encoders
    std::vector<std::uint32_t> parents;  // of its wedges
    std::vector<std::uint32_t> sectors;  // the wedge, counted from 0, in each of its sectors, the first after `parent`
    // The wedges of the two vertices that it and its parent both meet, in the triangles with both.
    std::uint32_t wedge_a = 0, wedge_b = 0;
  };

  std::vector<Star> stars;
  std::vector<std::uint32_t> parents;  // of the wedges that came in by splits
  std::uint32_t wedge_count = 0;

  // True if a split fits the mesh as it is; wedges are not checked.
  [[nodiscard]] bool fits(const Split& split) const;
  // The star that the new vertex would have, without wedges.
  [[nodiscard]] Star star_of(const Split& split) const;
  void apply(const Split& split, Star&& star);
  // The triangles of all stars, in their order, each at its first vertex.
  [[nodiscard]] std::vector<Triangle> triangles() const;
};

}  // namespace lodestone::progressive
