#include "experiments/commands/build_notes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "experiments/commands/command.h"
#include "experiments/commands/input.h"

namespace lodestone {
namespace {

// Stored triangles over those of the input: 4/3 for a surface that simplifies everywhere. A ratio above this one is
// worth a note, if there is a cause.
// Stored triangles over those of the input: as they are in ordinary models, and where people should know why.
struct StoredRatio {
  double usual, large;
};
constexpr StoredRatio of_quarters{1.33, 1.6}, of_halves{2, 2.4};

StoredRatio stored_ratio_of(const Hierarchy& hierarchy) { return hierarchy.grids.halves ? of_halves : of_quarters; }
// A reason that holds for this share of a level's vertices is named as the cause.
constexpr double large_share = 0.3;

double percent(std::uint64_t part, std::uint64_t whole) {
  return 100 * static_cast<double>(part) / static_cast<double>(std::max<std::uint64_t>(whole, 1));
}

}  // namespace

std::string describe(const KeptVertices& kept, double stored_ratio, const Hierarchy& hierarchy) {
  struct Cause {
    std::uint64_t vertices;
    std::string what, remedy;
  };
  const std::array<Cause, 5> causes{
      {{kept.non_manifold, "are where more than two triangles meet at an edge or neighbours face against each other",
        "repair the surface; info counts these edges"},
       {kept.border, "are on borders of the surface, which is in small parts", "join parts that belong together"},
       {kept.seams, "are on seams of texture coordinates, normals, colours or materials",
        "--no-attributes simplifies the shape alone"},
       {kept.distant, "are too far from their neighbours for the bound of how far vertices may move",
        fmt::format("give a larger --sigma0 than {:g}, or more --cell-triangles", hierarchy.sigma0)},
       {kept.shared, "are on borders of cells, where blocks lock them", "give more --cell-triangles"}}};
  const Cause& cause = *std::ranges::max_element(causes, {}, &Cause::vertices);
  if (percent(cause.vertices, kept.vertices) < 100 * large_share) return {};
  return fmt::format(
      "stored are {:.2f} times the triangles of the input, where {:.3g} are usual: {:.0f} % of the vertices "
      "that level {} keeps {}; {}",
      stored_ratio, stored_ratio_of(hierarchy).usual, percent(cause.vertices, kept.vertices), kept.level, cause.what,
      cause.remedy);
}

const char* nature_of_errors(const Hierarchy& hierarchy) {
  return hierarchy.provenance.measured_errors
             ? "measured: no point is farther from the other surface"
             : "estimated at vertices: points may be somewhat farther (verify says by how much, build --measure-error "
               "makes them bounds)";
}

void print_build_notes(const BuildResult& result, double stored_ratio) {
  const Hierarchy& hierarchy = result.hierarchy;
  const Level& finest = hierarchy.levels.back();
  print_warnings(result.warnings);
  print_up_note(hierarchy.transform.up);
  print_repairs(hierarchy.provenance.repairs);
  if (finest.long_edges > 0)
    fmt::print(
        "note: {} half-edges of the input are longer than sigma0 h_L, the longest {:.1f} h_L; they cost triangles, not "
        "correctness: --refine splits them\n",
        finest.long_edges, finest.max_edge);
  if (const auto& measured = result.measured; measured && measured->stopped > 0)
    fmt::print(
        "note: the errors of {} cells, full of needles, were measured as far as a limited amount of work goes: they "
        "are "
        "bounds, at most {:.2g} h too large\n",
        measured->stopped, measured->excess);
  const bool has_payloads = !result.scratch;
  if (stored_ratio > stored_ratio_of(hierarchy).large && has_payloads)
    if (const std::string note = describe(find_kept(hierarchy), stored_ratio, hierarchy); !note.empty())
      fmt::print("note: {}\n", note);
}

}  // namespace lodestone
