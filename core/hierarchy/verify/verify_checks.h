// Internals of verify: the collector of findings, and the groups of checks. verify.h documents each check.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/hierarchy/verify/verify.h"

namespace lodestone::verify {

// Result of one check while it runs: numbers of items examined and failed, the first failure in words.
class Finding {
 public:
  explicit Finding(std::string name) : name_(std::move(name)) {}

  // say() returns the failure in words; it is called for the first failure only.
  template <typename Say>
  void require(bool holds, Say&& say) {
    ++examined_;
    if (!holds) fail(std::forward<Say>(say));
  }
  template <typename Say>
  void fail(Say&& say) {
    if (failures_++ == 0) first_ = say();
  }
  [[nodiscard]] VerifyCheck check() const;

 private:
  std::string name_;
  std::uint64_t examined_ = 0, failures_ = 0;
  std::string first_;
};

// Names of cells and vertices for messages.
[[nodiscard]] std::string place(int level, CellId cell);
[[nodiscard]] std::string place(int level, CellId cell, VertexId vertex);

// True if `stored` is a bound of `exact` and at most bound_slack larger.
[[nodiscard]] bool is_tight_bound(float stored, double exact);

// Identity of the stored vertices of a level: identity[first_vertex[cell - first_cell] + i] is the number of the first
// stored copy of vertex i of the cell. Vertices without a shared id are their own first copy.
struct LevelIdentity {
  CellId first_cell;
  std::vector<std::uint32_t> first_vertex;  // one per cell of the level and one more
  std::vector<std::uint32_t> identity;      // one per stored vertex
  struct Shared {
    std::uint32_t id = 0;
    CellId cell;
    VertexId local;
    std::uint32_t number = 0;  // of the stored vertex
  };
  // With wedges, the first wedge of the same vertex; otherwise empty: every identity is a vertex of its own.
  std::vector<std::uint32_t> vertex;
  std::vector<Shared> shared;  // all copies of vertices with a shared id, by id, then by cell

  [[nodiscard]] std::uint32_t of(CellId cell, VertexId local) const {
    return identity[first_vertex[cell - first_cell] + local];
  }
  [[nodiscard]] std::uint32_t vertex_of(CellId cell, VertexId local) const {
    const std::uint32_t number = first_vertex[cell - first_cell] + local;
    return vertex.empty() ? identity[number] : vertex[number];
  }
};
[[nodiscard]] LevelIdentity identify(const Hierarchy& hierarchy, int level);

// verify_relations.cpp: identities and P.
void check_copies(const Hierarchy& hierarchy, int level, const LevelIdentity& fine, Finding& identity);
void check_positions_distinct(const Hierarchy& hierarchy, const LevelIdentity& finest, Finding& identity);
void check_ids_kept(const Hierarchy& hierarchy, const LevelIdentity& fine, const LevelIdentity& coarse,
                    Finding& identity);
void check_parent_function(const Hierarchy& hierarchy, int level, const LevelIdentity& fine,
                           const LevelIdentity& coarse, Finding& parents);
void check_images(const Hierarchy& hierarchy, int coarse_level, const LevelIdentity& coarse, Finding& vertices,
                  Finding& triangles);
// With wedges: finds the wedges of one vertex. The groups go to `vertex` of the identities.
void group_by_position(const Hierarchy& hierarchy, LevelIdentity& finest);
// Also requires that wedges of one vertex have parents at one position.
void group_by_parents(const Hierarchy& hierarchy, int level, const LevelIdentity& fine, LevelIdentity& coarse,
                      Finding& wedges);

// verify_attributes.cpp: wedges and their materials; copies of textures.
void check_wedges(const Hierarchy& hierarchy, Finding& wedges);
void check_textures(const Hierarchy& hierarchy, Finding& textures);

// verify_geometry.cpp: lengths, boxes, stored bounds.
void check_displacements(const Hierarchy& hierarchy, Finding& displacement);
void check_lattice(const Hierarchy& hierarchy, Finding& lattice);
void check_edges(const Hierarchy& hierarchy, Finding& edges);
void check_boxes(const Hierarchy& hierarchy, Finding& boxes);
void check_reach(const Hierarchy& hierarchy, Finding& reach);
void check_bound(Finding& finding, const char* what, int level, float stored, double exact);

// verify_errors.cpp: the distances of the levels from M_L.
// Returns VerifyReport::error_ratio.
[[nodiscard]] std::vector<double> check_errors(const Hierarchy& hierarchy, Finding& errors);

// verify_signatures.cpp: those that the hierarchy has.
void check_signatures(const Hierarchy& hierarchy, Finding& signatures);

// verify_input.cpp: M_L against the input.
void check_cells(const Hierarchy& hierarchy, Finding& cells);
void check_partition(const Hierarchy& hierarchy, Finding& partition);
void check_fingerprint(const Hierarchy& hierarchy, const LevelIdentity& finest, Finding& fingerprint);
void check_input(const Hierarchy& hierarchy, const IndexedMesh& input, Finding& same);

}  // namespace lodestone::verify
