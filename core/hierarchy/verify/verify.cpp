#include "core/hierarchy/verify/verify.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "core/hierarchy/model/structure.h"
#include "core/hierarchy/verify/verify_checks.h"
#include "core/hierarchy/verify/verify_copies.h"
#include "core/hierarchy/verify/verify_peers.h"
#include "core/hierarchy/verify/verify_wedges.h"

namespace lodestone {
namespace verify {

VerifyCheck Finding::check(const Part& part) const {
  const std::vector<std::uint64_t> numbers = part.reduce(std::vector{examined_, failures_}, std::plus<>());
  const std::uint64_t examined = numbers[0], failures = numbers[1];
  const std::vector<std::vector<char>> first = part.share(std::vector<char>(first_.begin(), first_.end()));
  if (failures == 0) return {name_, true, std::to_string(examined) + " examined"};
  const auto said = std::find_if(first.begin(), first.end(), [](const auto& text) { return !text.empty(); });
  return {name_, false, std::string(said->begin(), said->end()) + " (" + std::to_string(failures) + " failures)"};
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

bool check_structure(const Part& part, Finding& structure) {
  const Hierarchy& hierarchy = part.hierarchy;
  const std::string fault = table_fault(hierarchy);
  bool sound = fault.empty();
  if (part.has_tables()) structure.require(sound, [&] { return fault; });
  for (int l = 0; sound && l <= hierarchy.finest(); ++l) {
    sound = part.level(l).vertices < 0xffff'ffffu;
    if (part.has_tables())
      structure.require(sound, [&] { return "more than 2^32 vertices on level " + std::to_string(l); });
  }
  if (!sound) return false;  // at all peers
  for (int l = 0; l <= hierarchy.finest(); ++l)
    part.for_cells(l, [&](CellId c) {
      const char* wrong = payload_fault(hierarchy, c);
      structure.require(!wrong, [&] { return place(l, c) + ": " + wrong; });
      sound = sound && !wrong;
    });
  return part.sum(sound ? 0 : 1) == 0;
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

// A process that has all.
class Alone final : public VerifyPeers {
 public:
  [[nodiscard]] std::size_t count() const override { return 1; }
  [[nodiscard]] std::size_t index() const override { return 0; }
  [[nodiscard]] std::size_t owner(CellId) const override { return 0; }
  [[nodiscard]] std::vector<Bytes> exchange(std::vector<Bytes>&& out) override { return std::move(out); }
};

// The findings in the order of the report.
struct Findings {
  Finding structure{"structure"}, cells{"cells"}, partition{"partition"}, identity{"identity"}, parents{"parents"},
      vertices{"vertices"}, triangles{"triangles"}, displacement{"displacement"}, lattice{"lattice"}, edges{"edges"},
      boxes{"boxes"}, reach{"reach"}, errors{"errors"}, fingerprint{"fingerprint"}, signatures{"signatures"},
      wedges{"wedges"}, textures{"textures"}, input{"input"};

  [[nodiscard]] std::vector<Finding*> of(const Hierarchy& hierarchy, bool with_input) {
    std::vector<Finding*> list{&structure,    &cells,   &partition, &identity, &parents, &vertices, &triangles,
                               &displacement, &lattice, &edges,     &boxes,    &reach,   &errors,   &fingerprint};
    if (hierarchy.signatures) list.push_back(&signatures);
    if (hierarchy.attributes.wedges) list.push_back(&wedges);
    if (!hierarchy.texture_copies.empty()) list.push_back(&textures);
    if (with_input) list.push_back(&input);
    return list;
  }
};

// Identities and P, from the finest level to the root.
void check_levels(const Part& part, Findings& findings, Steps& steps) {
  const Hierarchy& hierarchy = part.hierarchy;
  const int finest = hierarchy.finest();
  std::vector<VertexCopy> fine = copies_of(part, finest);
  check_copies(part, finest, fine, findings.identity);
  std::optional<LevelWedges> wedges;
  if (hierarchy.attributes.wedges) {
    wedges = finest_wedges(part);
  } else {
    check_positions_distinct(part, fine, findings.identity);
  }
  check_fingerprint(part, count_vertices(part, finest, fine), findings.fingerprint);
  for (int level = finest; level > 0; --level) {
    std::vector<VertexCopy> coarse = copies_of(part, level - 1);
    check_copies(part, level - 1, coarse, findings.identity);
    check_ids_kept(fine, coarse, findings.identity);
    check_parent_function(level, fine, findings.parents);
    if (wedges) wedges = coarser_wedges(part, level, *wedges, findings.wedges);
    check_images(part, level - 1, wedges ? &*wedges : nullptr, findings.vertices, findings.triangles);
    fine = std::move(coarse);
    steps.next();
  }
}

VerifyReport verify_part(const Part& part, const IndexedMesh* input, const VerifyProgress& progress) {
  const Hierarchy& hierarchy = part.hierarchy;
  VerifyReport report;
  Findings findings;
  Steps steps(4 + static_cast<std::size_t>(hierarchy.finest()), progress);
  if (check_structure(part, findings.structure)) {
    check_cells(part, findings.cells);
    check_partition(part, findings.partition);
    steps.next();
    check_levels(part, findings, steps);
    check_displacements(part, findings.displacement);
    check_lattice(part, findings.lattice);
    check_edges(part, findings.edges);
    check_boxes(part, findings.boxes);
    check_reach(part, findings.reach);
    steps.next();
    report.error_ratio = check_errors(part, findings.errors);
    steps.next();
    if (hierarchy.attributes.wedges) check_wedges(part, findings.wedges);
    if (hierarchy.signatures) check_signatures(part, findings.signatures);
    if (part.has_tables()) check_textures(hierarchy, findings.textures);
    if (input) check_input(part, *input, findings.input);
    steps.next();
  } else if (part.has_tables()) {
    for (Finding* finding : findings.of(hierarchy, input))
      if (finding != &findings.structure)
        finding->fail([] { return std::string("not examined, since the structure is broken"); });
  }
  for (const Finding* finding : findings.of(hierarchy, input)) report.checks.push_back(finding->check(part));
  return report;
}

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
  verify::Alone alone;
  return verify::verify_part(verify::Part(hierarchy, alone), input, progress);
}

VerifyReport verify_by_peers(const Hierarchy& hierarchy, VerifyPeers& peers, const IndexedMesh* input,
                             const VerifyProgress& progress) {
  return verify::verify_part(verify::Part(hierarchy, peers), input, progress);
}

}  // namespace lodestone
