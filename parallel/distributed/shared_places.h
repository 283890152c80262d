// Places near which several ranks have vertices: only there can a vertex of one rank equal one of another.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/math/vec3.h"
#include "core/mesh/clean_kernels.h"
#include "parallel/clean/stream_clean.h"
#include "parallel/distributed/messages/ranks.h"

namespace lodestone {

// Each rank tells which cells of a grid over the unit cube it has vertices in, by hashes of the cells.
class SharedPlaces {
 public:
  // Called by all ranks, with the vertices of each and their states. Memory: two bits per vertex of all ranks, up to 16
  // MiB, and about three bytes per vertex of a share until it is there.
  SharedPlaces(std::span<const Vec3f> positions, std::span<const VertexState> states, std::uint64_t all_vertices,
               Ranks& ranks);

  // False only if no other rank has a vertex in use there.
  [[nodiscard]] bool contains(const Vec3f& position) const { return shared_ && (*shared_)[place(position)]; }

 private:
  [[nodiscard]] std::uint64_t place(const Vec3f& position) const;

  std::uint64_t places_;          // cells are numbered by their hash
  float side_;                    // of the cube in cells
  std::optional<BitSet> shared_;  // of several ranks
};

}  // namespace lodestone
