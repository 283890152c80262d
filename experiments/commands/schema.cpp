#include "experiments/commands/schema.h"

#include <fmt/core.h>

#include <utility>
#include <vector>

#include "experiments/studies/experiment.h"
#include "experiments/subjects/build.h"
#include "experiments/subjects/compare.h"
#include "experiments/subjects/progressive.h"
#include "experiments/subjects/reconstruct.h"
#include "experiments/subjects/render.h"
#include "experiments/subjects/spherical.h"

namespace lodestone {
namespace {

struct Key {
  std::string name, unit, meaning;
};

// The keys of a command besides its row.
struct CommandKeys {
  std::string command;
  std::vector<ColumnInfo> row;
  std::vector<Key> details;
};

std::vector<Key> repairs(const std::string& prefix = "repairs") {
  return {{prefix + ".polygons_triangulated", "", "polygons with more than three corners"},
          {prefix + ".faces_dropped", "", "faces with fewer than three corners"},
          {prefix + ".non_finite_triangles", "", "triangles with a corner that is not finite, left out"},
          {prefix + ".welded_vertices", "", "vertices at the place of another one"},
          {prefix + ".degenerate_triangles", "", "triangles with two equal corners, left out"},
          {prefix + ".duplicate_triangles", "", "triangles given twice, left out"},
          {prefix + ".unreferenced_vertices", "", "vertices without a triangle, left out"},
          {prefix + ".void_posts", "", "posts of a height grid without a height"},
          {prefix + ".filled_posts", "", "posts whose height was interpolated"}};
}

std::vector<Key> up_keys() {
  return {{"up", "", "axis that points up: x, y, z, -x, -y, -z, or earth: away from its middle"},
          {"up_guessed", "", "by the format; neither the file nor --up says it"}};
}

std::vector<Key> level_keys() {
  return {{"level_table[].level", "", "0 is the coarsest"},
          {"level_table[].cells", "", "cells of the level"},
          {"level_table[].triangles", "", "triangles of the level"},
          {"level_table[].vertices", "", "vertices of the level, a copy for each cell"},
          {"level_table[].reach.euclidean", "h_l", "reach of the level"},
          {"level_table[].reach.chebyshev", "h_l", "the same by the Chebyshev distance"},
          {"level_table[].diameter", "h_l", "largest diameter of a cell's box"},
          {"level_table[].error_ratio", "h_l", "error of the level"},
          {"level_table[].max_edge_ratio", "h_l", "longest edge"},
          {"level_table[].long_edges", "", "half-edges longer than sigma0 h_l"}};
}

std::vector<Key> distances(const std::string& prefix) {
  std::vector<Key> keys{{prefix + "diagonal", "model units", "diagonal of the bounding box of the first surface"}};
  for (const std::string way : {"forward", "backward"}) {
    const std::string from = way == "forward" ? "first surface to the second" : "second surface to the first";
    for (const auto& [name, text] : {std::pair{"max", "largest distance found from the "},
                                     {"rms", "root of the mean square distance from the "},
                                     {"mean", "mean distance from the "},
                                     {"p99", "distance that 99 % of the samples do not exceed from the "}})
      keys.push_back({prefix + way + "." + name, "model units", text + from});
    keys.push_back({prefix + way + ".samples", "", "points measured"});
  }
  return keys;
}

std::vector<Key> joined(std::vector<std::vector<Key>> lists) {
  std::vector<Key> all;
  for (const std::vector<Key>& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

std::vector<Key> build_details() {
  return joined({{{"inputs", "", "files that were built, as one mesh"},
                  {"compressed", "", "the file is a compressed one"},
                  {"lattice_bits", "", "bits of the lattice of all vertices; 0: none"},
                  {"lattice_error", "model units", "largest distance by which the lattice moves a vertex"},
                  {"sigma0", "", "displacement bound"},
                  {"half_levels", "", "levels have half of the triangles of the next finer one, not a quarter"},
                  {"refined.split_triangles", "", "triangles that --refine split"},
                  {"refined.triangles_before", "", "triangles before --refine"},
                  {"refined.triangles_after", "", "triangles after --refine"},
                  {"errors", "", "estimated or measured"},
                  {"error_excess", "h_l", "by how much a measured error may be too large, at most"},
                  {"stages.*.seconds", "s", "time of a stage"},
                  {"stages.*.cpu_seconds", "s", "its processor time, all threads"},
                  {"threads", "", "workers"},
                  {"strategy", "", "orchestration"},
                  {"simplifier", "", "simplifier"},
                  {"placement", "", "place of the vertices that remain"},
                  {"attributes.*", "", "number of attributes of the input, by kind"},
                  {"texture_copies", "", "copies of textures for coarser levels"},
                  {"warnings[]", "", "what is wrong with the input"},
                  {"memory_limit", "bytes", "limit of a build out of core"},
                  {"scratch.folder", "", "folder of the temporary files"},
                  {"scratch.expected_bytes", "bytes", "expected size of the temporary files"},
                  {"scratch.blocks", "", "blocks built"},
                  {"scratch.blocks_resumed", "", "blocks that an earlier build had left"},
                  {"trace", "", "file of --trace"}},
                 up_keys(),
                 level_keys(),
                 repairs()});
}

std::vector<Key> info_keys() {
  return joined({{{"file", "", "file described"},
                  {"input_triangles", "", "triangles of the input of a hierarchy"},
                  {"input_vertices", "", "its vertices"},
                  {"triangles", "", "triangles of a mesh, after repair"},
                  {"vertices", "", "its vertices"},
                  {"sigma0", "", "displacement bound"},
                  {"half_levels", "", "levels have half of the triangles of the next finer one, not a quarter"},
                  {"simplifier", "", "simplifier"},
                  {"placement", "", "place of the vertices that remain"},
                  {"cell_triangles", "", "mean triangles per finest cell that was asked for"},
                  {"origin[]", "model units", "origin of normalised space"},
                  {"scale", "model units", "length of one normalised unit"},
                  {"kappa0_admissible_above.euclidean", "h_l", "border of uniform radii"},
                  {"kappa0_admissible_above.chebyshev", "h_l", "the same by the Chebyshev distance"},
                  {"errors", "", "estimated or measured"},
                  {"refined", "", "long edges of the input were split"},
                  {"lattice_bits", "", "bits of the lattice of all vertices; 0: none"},
                  {"stored_triangles", "", "triangles of all levels"},
                  {"stored_vertices", "", "vertices of all levels, a copy for each cell"},
                  {"file_bytes", "bytes", "size of the file"},
                  {"bytes_per_stored_triangle", "bytes", "size of the file over its stored triangles"},
                  {"materials", "", "number of materials"},
                  {"textures[].*", "", "name, media type, bytes and copies of a texture"},
                  {"levels", "", "number of levels"},
                  {"edges", "", "edges of a mesh"},
                  {"border_edges", "", "edges of one triangle"},
                  {"non_manifold_edges", "", "edges of more than two triangles"},
                  {"inconsistent_edges", "", "edges whose two triangles face against each other"},
                  {"warnings[]", "", "what is wrong with the file"}},
                 up_keys(),
                 level_keys(),
                 repairs()});
}

std::vector<Key> progressive_details() {
  return joined({{{"input", "", "mesh that was read"},
                  {"output", "", "file written"},
                  {"metric", "", "metric that ranks collapses"},
                  {"base_error", "model units", "error of the base mesh, by the metric"},
                  {"collapse_rounds", "", "rounds of regions side by side"},
                  {"warnings[]", "", "what is wrong with the input"}},
                 repairs()});
}

std::vector<Key> spherical_details() {
  return joined(
      {{{"input", "", "mesh that was read"},
        {"output", "", "file written"},
        {"effort", "", "how long the map to the sphere was improved"},
        {"guard", "", "weight of the term that keeps triangles from shrinking to nothing"},
        {"texture", "pixels", "side of the largest component's images"},
        {"greatest_genus", "", "largest genus of a component"},
        {"loop_lengths.*", "model units", "smallest, mean and largest length of the loops that handles were cut along"},
        {"manifold.*", "", "counts of what was cut apart or turned"},
        {"warnings[]", "", "what is wrong with the input"}},
       repairs()});
}

std::vector<Key> reconstruct_details() {
  std::vector<Key> keys{{"input", "", "mesh or maps that were read"},
                        {"merge", "", "stitch or concatenate"},
                        {"backend", "", "backend that drew the maps"},
                        {"input_triangles", "", "triangles of the input"},
                        {"read_seconds", "s", "reading and welding the input"},
                        {"peak_bytes", "bytes", "largest resident set"},
                        {"levels[].file", "", "mesh written"},
                        {"levels[].resolution", "pixels", "along the longest side of the bounding box"},
                        {"levels[].wedges", "", "vertices of the file, copies at seams included"},
                        {"levels[].spacing", "model units", "spacing of the samples"},
                        {"levels[].seen", "", "pixels that see the surface"},
                        {"levels[].sampled_triangles", "", "triangles before they are simplified"},
                        {"levels[].views.*", "", "points of the surface that are visible, coverable and covered"},
                        {"levels[].mesh.*", "", "quality of the mesh: counts, border length, worst aspect"},
                        {"levels[].stitch.*", "", "work of stitching: counts, and lengths in model units"},
                        {"levels[].taken_over.*", "", "parts of the input too small for the maps"},
                        {"levels[].shell.*", "", "points of the shell's grid, those for sheets, and surfaces left out"},
                        {"levels[].sharpened.*", "", "sharp edges and corners recovered"},
                        {"levels[].stages.*.seconds", "s", "time of a stage"},
                        {"levels[].stages.*.cpu_seconds", "s", "its processor time, all threads"},
                        {"levels[].visible.*", "model units", "distance of the visible surface from the result"},
                        {"levels[].seen_pixels.*", "model units",
                         "the same of what pictures from all around show, each pixel counting once"}};
  return joined({keys, distances("levels[]."), repairs()});
}

std::vector<Key> render_details() {
  return {{"frames[].cells", "", "cells drawn"},
          {"frames[].triangles", "", "triangles drawn"},
          {"frames[].surface_triangles", "", "triangles of the whole surface, before culling"},
          {"frames[].open_edges", "", "residual edges"},
          {"frames[].gap_max", "% of the extent", "largest distance of two places at which one vertex is drawn"},
          {"frames[].jump_pixels", "pixels",
           "largest way of a vertex in the picture since the frame before, without the camera's own"},
          {"frames[].viewpoint_step", "% of the extent", "way of the viewpoint since the frame before"},
          {"frames[].jump_max", "% of the extent", "largest way of a vertex since the frame before"},
          {"frames[].jump_over_bound", "", "largest jump over its analytic bound, where there is one"},
          {"frames[].jump_bound_vacuous", "",
           "the step is so long that this bound reaches from the vertex to its parent: it tells nothing"},
          {"frames[].screen_error", "pixels", "largest distance from the full model"},
          {"frames[].milliseconds.*", "ms", "time of a stage; total: the frame"},
          {"frames[].work.*", "", "work of an effect"},
          {"frames[].drawn", "", "false: nothing has changed since the frame before"},
          {"frames[].draw_calls", "", "calls of a backend that makes any"},
          {"frames[].resident_bytes", "bytes", "payloads in memory, with --memory-budget"},
          {"frames[].complete", "", "all the detail was there, with --memory-budget"},
          {"frames[].jump_by_limits", "% of the extent",
           "largest way of a vertex since the frame before by detail limits alone, as cells came or went, with "
           "--memory-budget"},
          {"file", "", "hierarchy, mesh or scene"},
          {"backend", "", "backend that drew"},
          {"fallback", "", "reason why it is not the one asked for"},
          {"camera", "", "path"},
          {"blend", "", "blending function"},
          {"models[]", "", "names of the models"},
          {"effects[].effect", "", "name of an effect"},
          {"effects[].runs", "", "it runs"},
          {"effects[].reasons.*", "", "reason, by model"},
          {"metric", "", "distance"},
          {"radii", "", "rule for the selection radii"},
          {"first_picture_seconds", "s", "time from the start to the first picture"},
          {"samples", "", "samples per pixel"},
          {"size[]", "pixels", "width and height"}};
}

std::vector<Key> export_keys() {
  return {{"file", "", "mesh or archive written"},
          {"level", "", "level written"},
          {"triangles", "", "triangles written, of all tiles"},
          {"vertices", "", "vertices written"},
          {"folder", "", "folder of the tileset"},
          {"tiles", "", "tiles written"},
          {"tilesets", "", "tileset files written"},
          {"textures", "", "images written"},
          {"draws", "", "primitives of all tiles"},
          {"atlases", "", "images made for tiles of many materials"},
          {"finest_triangles", "", "triangles of the finest level"},
          {"bytes", "bytes", "size of all files"},
          {"seconds", "s", "writing the tileset"},
          {"cpu_seconds", "s", "its processor time, all threads"}};
}

std::vector<Key> lod_keys() {
  return {{"input", "", "progressive mesh"},
          {"output", "", "mesh written"},
          {"vertices", "", "vertices of the level"},
          {"triangles", "", "triangles of the level"},
          {"error", "model units", "bound of the distance of the level from the input, both ways, measured"},
          {"estimate", "model units", "the same by the metric, without quantization, as the file has it"},
          {"level.seconds", "s", "taking the level"},
          {"level.cpu_seconds", "s", "its processor time, all threads"},
          {"finest_vertices", "", "vertices of the finest level"},
          {"finest_triangles", "", "triangles of the finest level"},
          {"base_vertices", "", "vertices of the base mesh"}};
}

std::vector<CommandKeys> command_keys() {
  // The proof of the command is not thorough, and it draws one round.
  const std::vector<std::string> thorough{"frame_ms_min",     "frame_ms_max", "frame_cpu_ms_min",
                                          "frame_cpu_ms_max", "t_junctions",  "torn_pixels",
                                          "leak_pixels",      "jump_p99",     "jump_p99_pixels"};
  std::vector<ColumnInfo> levels = reconstruct_columns();
  for (ColumnInfo& column : levels) column.name = "levels[]." + column.name;
  return {{"build", build_columns(), build_details()},
          {"compare", distance_columns(),
           joined({{{"a", "", "first surface"},
                    {"b", "", "second surface"},
                    {"non_finite_triangles[]", "", "triangles left out of each, with a corner that is not finite"}},
                   distances("")})},
          {"export", {}, export_keys()},
          {"generate",
           {},
           {{"output", "", "file written"},
            {"shape", "", "shape"},
            {"seed", "", "seed of the displacement"},
            {"triangles", "", "triangles written"},
            {"vertices", "", "vertices written"},
            {"bytes", "bytes", "size of the file"},
            {"seconds", "s", "generating and writing"},
            {"cpu_seconds", "s", "its processor time, all threads"},
            {"peak_bytes", "bytes", "largest resident set"}}},
          {"info", {}, info_keys()},
          {"lod", {}, lod_keys()},
          {"progressive", progressive_columns(), progressive_details()},
          {"spherical", spherical_columns(), spherical_details()},
          {"reconstruct", levels, reconstruct_details()},
          {"render", without(render_columns(), thorough), render_details()},
          {"verify",
           {},
           {{"file", "", "hierarchy"},
            {"valid", "", "every check passed"},
            {"checks[].name", "", "property"},
            {"checks[].passed", "", "the hierarchy has it"},
            {"checks[].detail", "", "figures"},
            {"errors", "", "estimated or measured"},
            {"sampled_over_error[]", "",
             "by level: largest distance found between a point and the other surface, over the error of the level; at "
             "most 1 if measured"}}}};
}

std::string line(const std::string& name, const std::string& unit, const std::string& meaning) {
  return fmt::format("| `{}` | {} | {} |\n", name, unit, meaning);
}

}  // namespace

std::string schema_text() {
  std::string text =
      "# Schema\n\nThis page is printed by `lodestone experiments --schema`. A key `a.b` is b in the object a, `a[]` "
      "every element of the list a, and `*` stands for names that depend on the run. Keys of a command that are also "
      "columns of the experiment of the same subject have the same unit and meaning there.\n";
  for (const CommandKeys& keys : command_keys()) {
    text += fmt::format("\n## Command {}\n\n| key | unit | meaning |\n|---|---|---|\n", keys.command);
    for (const ColumnInfo& column : keys.row) text += line(column.name, column.unit, column.meaning);
    for (const Key& key : keys.details) text += line(key.name, key.unit, key.meaning);
  }
  for (const std::string& name : experiment_names()) {
    const Experiment& experiment = find_experiment(name);
    text += fmt::format("\n## Experiment {}\n\n| column | unit | meaning |\n|---|---|---|\n", experiment.name);
    for (const ColumnInfo& column : experiment.columns) text += line(column.name, column.unit, column.meaning);
  }
  return text;
}

}  // namespace lodestone
