// The vertices and edges of a closed surface, with the order of the edges around each vertex, for shortest paths and
// for cuts along loops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/prefetch.h"
#include "core/spherical/surface.h"
#include "core/spherical/topology/sides.h"

namespace lodestone::spherical {

// An edge as seen from one of its ends. Small, as searches wait for memory most of the time.
struct Link {
  Id to : 31 = 0;
  Id is_labelled : 1 = 0;  // its label is not 0
  float length = 0;
  void set_to(Id v) { to = v & 0x7FFF'FFFFu; }
};

// Cuts close the surface again: each side gets a cap, one face without triangles, which paths cannot cross. A cut makes
// a second copy of every vertex of its loop, numbered after all others. Memory: 20 bytes for each end of an edge and 12
// for each vertex.
class SurfaceGraph {
 public:
  // Closed, oriented, manifold, one component, at most one edge between two vertices.
  explicit SurfaceGraph(const Surface& surface);

  [[nodiscard]] Id vertex_count() const { return static_cast<Id>(rows_.size()); }
  // Triangles first, then caps.
  [[nodiscard]] Id face_count() const { return triangles_ + caps_; }
  [[nodiscard]] Id cap_count() const { return caps_; }
  [[nodiscard]] Id genus() const { return genus_; }
  [[nodiscard]] float mean_length() const { return mean_length_; }  // of the links
  [[nodiscard]] float greatest_length() const { return greatest_length_; }

  void prefetch_row(Id v) const { prefetch(&rows_[v]); }
  void prefetch_links(Id v) const { prefetch(links_.data() + rows_[v].begin); }

  // Counter-clockwise around v. face(v, k) is the face between link k and the next one.
  [[nodiscard]] std::span<const Link> links(Id v) const { return {links_.data() + rows_[v].begin, rows_[v].count}; }
  [[nodiscard]] std::span<Link> links(Id v) { return {links_.data() + rows_[v].begin, rows_[v].count}; }
  [[nodiscard]] Id face(Id v, std::size_t k) const { return faces_[rows_[v].begin + k]; }
  // The link is in one of the rows. Both ends of an edge have the same label (cycle_labels.h).
  [[nodiscard]] std::uint64_t label(const Link& link) const {
    return link.is_labelled != 0 ? labels_[static_cast<std::size_t>(&link - links_.data())] : 0;
  }
  void set_label(Link& link, std::uint64_t label) {
    link.is_labelled = label != 0;
    labels_[static_cast<std::size_t>(&link - links_.data())] = label;
  }
  [[nodiscard]] std::size_t find(Id v, Id to) const;  // the place of a neighbour among the links
  // The number of cuts made before v was last on the loop of one, plus one; 0: never.
  [[nodiscard]] std::uint32_t last_cut(Id v) const { return last_cut_[v]; }
  [[nodiscard]] std::uint32_t cut_count() const { return caps_ / 2; }

  // Cuts along a simple loop of at least three vertices that does not separate the surface: loop[k] stays on the left
  // and its copy, vertex_count() before the cut + k, is on the right. The triangles of the surface that the graph was
  // made of are renamed and it gets the copies.
  void cut(std::span<const Id> loop, Surface& surface);

  // The loop of vertices around each cap, as it has to be filled (fill_holes.h).
  [[nodiscard]] std::vector<std::vector<Id>> cap_loops() const;

 private:
  struct Row {
    std::uint32_t begin = 0, count = 0;
  };
  void split_row(Id v, Id from, Id to, Id left_cap);
  [[nodiscard]] bool is_inside_copy(Id copy, Id neighbour, std::span<const Id> loop) const;
  [[nodiscard]] Id original(Id v, std::span<const Id> loop) const {
    const auto first_copy = static_cast<Id>(rows_.size() - loop.size());
    return v < first_copy ? v : loop[v - first_copy];
  }

  std::vector<Row> rows_;
  std::vector<std::uint32_t> last_cut_;
  std::vector<Link> links_;
  std::vector<std::uint64_t> labels_;
  std::vector<Id> faces_;
  std::vector<Id> place_;  // on the loop being cut; no_id: not on it
  Id triangles_ = 0, caps_ = 0, genus_ = 0;
  float mean_length_ = 0, greatest_length_ = 0;
};

}  // namespace lodestone::spherical
