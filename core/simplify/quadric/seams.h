// Wedges around the vertices of a block while half-edges collapse: the targets that keep every chart, and P of the
// wedges.
//
// A wedge is a vertex as some of its triangles see it; an edge is a *seam* where its two triangles see one of its ends
// as different wedges. Seams cut the fan of a vertex into sectors of one wedge each. A vertex without seams may go
// anywhere: its wedge becomes the one of the sector that it lies in. A vertex inside a seam may only go along it, and
// its two wedges become those on the two sides of the seam at the target. All others (where seams end or meet, or meet
// the border of the surface) are kept. So charts keep their triangles, and no texture is ever stretched across a seam.
#pragma once

#include <cstdint>
#include <vector>

#include "core/simplify/contract/simplifier.h"
#include "core/simplify/quadric/block_arrays.h"

namespace lodestone::quadric {

class Seams {
 public:
  // Takes a block whose rings are made; input.corners must not be empty. Flags the rings of the vertices with seams as
  // `seamed`, and as `sealed` those whose sectors have no order or are too many, so that they can be neither source nor
  // target of a collapse.
  void reset(const SimplifyInput& input, Arrays& arrays);

  // Lanes of the two neighbours along the seam of a seamed vertex; 0 if the vertex must be kept.
  [[nodiscard]] unsigned lanes(Id v, const Ring& ring, unsigned degree) const;

  // True if v, which is seamed, may collapse into u, its neighbour along the seam, without ending a chart or a seam.
  [[nodiscard]] bool allows(Id v, Id u) const;

  // Records that v goes to u; to be called before the rings change.
  void collapse(Id v, Id u, const Arrays& arrays);

  // P of every wedge, resolved. parent: P of every vertex, resolved.
  void resolve(const SimplifyInput& input, const std::vector<std::uint32_t>& parent,
               std::vector<std::uint32_t>& wedge_parent);

 private:
  static constexpr unsigned most_seams = 7;
  static constexpr std::uint32_t no_wedge = 0xffff'ffffu;
  // The seam edges of a vertex, counter-clockwise; after[k] is the wedge between edge k and the next one, `first` that
  // of an open fan before its first seam edge.
  struct Record {
    unsigned count = 0;
    bool open = false;
    std::uint32_t first = no_wedge;
    Id neighbour[most_seams]{};
    std::uint32_t after[most_seams]{};
    [[nodiscard]] unsigned find(Id x) const;
  };
  // A triangle as one of its corners sees it.
  struct Corner {
    Id vertex, from, to;
    std::uint32_t wedge, from_wedge, to_wedge;
  };

  void find_candidates(const SimplifyInput& input);
  void gather_corners(const SimplifyInput& input);
  void make_record(Id v, Ring& ring);
  [[nodiscard]] const Corner* corner_of(Id v, Id from, Id to) const;
  [[nodiscard]] std::uint32_t sector(Id u, unsigned lane, const Ring& ring) const;

  std::vector<std::uint32_t> wedge_;   // first wedge of each vertex; the only one unless it has several
  std::vector<std::uint8_t> several_;  // by vertex: 2 if it has several wedges, 1 if a neighbour has
  std::vector<std::uint32_t> record_of_;
  std::vector<Record> records_;
  std::vector<Corner> corners_;       // of the candidates, by vertex
  std::vector<std::uint32_t> first_;  // corner of each candidate, by `candidate_`
  std::vector<std::uint32_t> candidate_;
  std::vector<std::uint32_t> to_;  // the wedge that each wedge has collapsed into
};

}  // namespace lodestone::quadric
