// Internals of verify: the collector of findings, and the groups of checks. verify.h documents each check.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/hierarchy/verify/verify.h"
#include "core/hierarchy/verify/verify_part.h"

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
  // Adds up the numbers of all peers, which call it together; names the first failure of the first that has one.
  [[nodiscard]] VerifyCheck check(const Part& part) const;

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

// Checks whose arguments have a Part are made by all peers together.

// verify_images.cpp
class LevelWedges;
// `wedges` of the coarse level where the hierarchy has them, else null.
void check_images(const Part& part, int coarse_level, const LevelWedges* wedges, Finding& vertices, Finding& triangles);

// verify_attributes.cpp: wedges and their materials; copies of textures.
void check_wedges(const Part& part, Finding& wedges);
void check_textures(const Hierarchy& hierarchy, Finding& textures);

// verify_geometry.cpp: lengths, boxes, stored bounds.
void check_displacements(const Part& part, Finding& displacement);
void check_lattice(const Part& part, Finding& lattice);
void check_edges(const Part& part, Finding& edges);
void check_boxes(const Part& part, Finding& boxes);
void check_reach(const Part& part, Finding& reach);
void check_bound(Finding& finding, const char* what, int level, float stored, double exact);

// verify_errors.cpp: the distances of the levels from M_L.
// Returns VerifyReport::error_ratio.
[[nodiscard]] std::vector<double> check_errors(const Part& part, Finding& errors);

// verify_signatures.cpp: those that the hierarchy has.
void check_signatures(const Part& part, Finding& signatures);

// verify_finest.cpp
void check_cells(const Part& part, Finding& cells);
void check_partition(const Part& part, Finding& partition);
// `vertices` of the finest level, each counted once.
void check_fingerprint(const Part& part, std::uint64_t vertices, Finding& fingerprint);

// verify_input.cpp: M_L against the input.
void check_input(const Part& part, const IndexedMesh& input, Finding& same);

}  // namespace lodestone::verify
