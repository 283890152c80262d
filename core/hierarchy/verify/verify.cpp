#include "core/hierarchy/verify/verify.h"

#include <algorithm>

#include "core/hierarchy/model/structure.h"
#include "core/hierarchy/verify/verify_checks.h"

namespace lodestone {
namespace verify {

VerifyCheck Finding::check() const {
  if (failures_ == 0) return {name_, true, std::to_string(examined_) + " examined"};
  return {name_, false, first_ + " (" + std::to_string(failures_) + " failures)"};
}

std::string place(int level, CellId cell) {
  return "level " + std::to_string(level) + ", cell " + std::to_string(cell);
}

std::string place(int level, CellId cell, VertexId vertex) {
  return place(level, cell) + ", vertex " + std::to_string(vertex);
}

bool is_tight_bound(float stored, double exact) {
  constexpr double smallest = 1e-17;  // over h_l, what squares that vanish in float may hide
  return stored >= exact && stored <= exact * (1 + bound_slack) + smallest;
}

namespace {

bool check_structure(const Hierarchy& hierarchy, Finding& structure) {
  const std::string fault = table_fault(hierarchy);
  structure.require(fault.empty(), [&] { return fault; });
  bool sound = fault.empty();
  for (int l = 0; sound && l <= hierarchy.finest(); ++l) {
    const std::uint64_t vertices = hierarchy.levels[static_cast<std::size_t>(l)].vertices;
    structure.require(vertices < 0xffff'ffffu, [&] { return "more than 2^32 vertices on level " + std::to_string(l); });
    sound = sound && vertices < 0xffff'ffffu;
  }
  for (CellId c{0}; sound && c < hierarchy.cells.size(); ++c) {
    const char* wrong = payload_fault(hierarchy, c);
    structure.require(!wrong, [&] { return place(hierarchy.level_of(c), c) + ": " + wrong; });
    sound = sound && !wrong;
  }
  return sound;
}

// Counts the steps of a run: the cells, the identities of each level, shapes, errors, and the rest.
class Steps {
 public:
  Steps(std::size_t count, const VerifyProgress& progress) : count_(count), progress_(progress) {}
  void next() {
    ++done_;
    if (progress_) progress_(static_cast<double>(done_) / static_cast<double>(count_));
  }

 private:
  std::size_t count_, done_ = 0;
  const VerifyProgress& progress_;
};

}  // namespace
}  // namespace verify

bool VerifyReport::valid() const {
  return !checks.empty() && std::all_of(checks.begin(), checks.end(), [](const VerifyCheck& c) { return c.passed; });
}

const VerifyCheck* VerifyReport::find(const std::string& name) const {
  const auto at = std::find_if(checks.begin(), checks.end(), [&](const VerifyCheck& c) { return c.name == name; });
  return at == checks.end() ? nullptr : &*at;
}

VerifyReport verify_hierarchy(const Hierarchy& hierarchy, const IndexedMesh* input, const VerifyProgress& progress) {
  using namespace verify;
  Finding structure("structure"), cells("cells"), partition("partition"), identity("identity"), parents("parents"),
      vertices("vertices"), triangles("triangles"), displacement("displacement"), lattice("lattice"), edges("edges"),
      boxes("boxes"), reach("reach"), errors("errors"), fingerprint("fingerprint"), wedges("wedges"),
      textures("textures"), signatures("signatures"), same("input");
  const bool has_wedges = hierarchy.attributes.wedges;
  VerifyReport report;
  Steps steps(4 + static_cast<std::size_t>(hierarchy.finest()), progress);

  if (check_structure(hierarchy, structure)) {
    check_cells(hierarchy, cells);
    check_partition(hierarchy, partition);
    steps.next();
    LevelIdentity fine = identify(hierarchy, hierarchy.finest());
    check_copies(hierarchy, hierarchy.finest(), fine, identity);
    if (has_wedges) {
      group_by_position(hierarchy, fine);
    } else {
      check_positions_distinct(hierarchy, fine, identity);
    }
    check_fingerprint(hierarchy, fine, fingerprint);
    for (int level = hierarchy.finest(); level > 0; --level) {
      LevelIdentity coarse = identify(hierarchy, level - 1);
      check_copies(hierarchy, level - 1, coarse, identity);
      check_ids_kept(hierarchy, fine, coarse, identity);
      check_parent_function(hierarchy, level, fine, coarse, parents);
      if (has_wedges) group_by_parents(hierarchy, level, fine, coarse, wedges);
      check_images(hierarchy, level - 1, coarse, vertices, triangles);
      fine = std::move(coarse);
      steps.next();
    }
    check_displacements(hierarchy, displacement);
    check_lattice(hierarchy, lattice);
    check_edges(hierarchy, edges);
    check_boxes(hierarchy, boxes);
    check_reach(hierarchy, reach);
    steps.next();
    report.error_ratio = check_errors(hierarchy, errors);
    steps.next();
    if (has_wedges) check_wedges(hierarchy, wedges);
    if (hierarchy.signatures) check_signatures(hierarchy, signatures);
    check_textures(hierarchy, textures);
    if (input) check_input(hierarchy, *input, same);
    steps.next();
  } else {
    for (Finding* finding : {&cells, &partition, &identity, &parents, &vertices, &triangles, &displacement, &lattice,
                             &edges, &boxes, &reach, &errors, &fingerprint, &wedges, &signatures, &textures, &same})
      finding->fail([] { return std::string("not examined, since the structure is broken"); });
  }

  for (const Finding* finding : {&structure, &cells, &partition, &identity, &parents, &vertices, &triangles,
                                 &displacement, &lattice, &edges, &boxes, &reach, &errors, &fingerprint})
    report.checks.push_back(finding->check());
  if (hierarchy.signatures) report.checks.push_back(signatures.check());
  if (has_wedges) report.checks.push_back(wedges.check());
  if (!hierarchy.texture_copies.empty()) report.checks.push_back(textures.check());
  if (input) report.checks.push_back(same.check());
  return report;
}

}  // namespace lodestone
