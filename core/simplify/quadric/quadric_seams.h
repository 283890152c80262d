// Wedges around the vertices of a block while half-edges collapse: which targets keep every chart, and what P is on
// wedges.
//
// A wedge is a vertex as some of its triangles see it; an edge is a *seam* where its two triangles see one of its ends
// as different wedges. Seams cut the fan of a vertex into sectors of one wedge each. A vertex without seams may go
// anywhere: its wedge becomes the one of the sector that it lies in. A vertex inside a seam may only go along it, and
// its two wedges become those on the two sides of the seam at the target. All others (where seams end or meet, or meet
// the border of the surface) stay. So charts keep their triangles, and no texture is ever stretched across a seam.
#pragma once

#include <cstdint>
#include <vector>

#include "core/simplify/block/simplifier.h"
#include "core/simplify/quadric/quadric_block.h"

namespace lodestone::quadric {

class Seams {
 public:
  // Of a block whose rings are made; input.corners must not be empty. Flags the rings of the vertices with seams as
  // `seamed`, and those that neither go nor are arrived at, since their sectors have no order or are too many, as
  // `sealed`.
  void reset(const SimplifyInput& input, Arrays& arrays);

  // Lanes of the two neighbours along the seam of a seamed vertex; 0 where the vertex has to stay.
  [[nodiscard]] unsigned lanes(Id v, const Ring& ring, unsigned degree) const;

  // Whether v, which is seamed, may collapse into u, its neighbour along the seam, without an end to a chart or a seam.
  [[nodiscard]] bool lets(Id v, Id u) const;

  // To be called before the rings change: v goes to u.
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

  std::vector<std::uint32_t> wedge_;   // of each vertex: its first; the only one unless it is in several
  std::vector<std::uint8_t> several_;  // of each vertex: it has more than one wedge, or a neighbour that has
  std::vector<std::uint32_t> record_of_;
  std::vector<Record> records_;
  std::vector<Corner> corners_;       // of the candidates, by vertex
  std::vector<std::uint32_t> first_;  // of each candidate's corners, by `candidate_`
  std::vector<std::uint32_t> candidate_;
  std::vector<std::uint32_t> to_;  // of each wedge: where its vertex's collapse took it
};

}  // namespace lodestone::quadric
