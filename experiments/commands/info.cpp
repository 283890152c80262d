// lodestone info: what a .lode file or a mesh file holds.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/formats/mesh_file.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/mesh/edge_census.h"
#include "core/mesh/up_axis.h"
#include "core/simplify/contract/simplifier.h"
#include "experiments/commands/build_notes.h"
#include "experiments/commands/command.h"
#include "experiments/commands/input.h"
#include "experiments/subjects/build.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/save.h"
#include "parallel/mesh/load.h"
#include "render/lod/radii.h"

namespace lodestone {
namespace {

const char* name_of_errors(const Hierarchy& h) { return h.provenance.measured_errors ? "measured" : "estimated"; }

struct Stored {
  std::uint64_t triangles = 0, vertices = 0, bytes = 0;
  [[nodiscard]] double bytes_per_triangle() const {
    return static_cast<double>(bytes) / static_cast<double>(std::max<std::uint64_t>(triangles, 1));
  }
};

Stored stored_in(const Hierarchy& h, const std::string& file) {
  Stored stored{0, 0, std::filesystem::file_size(file)};
  for (const Level& level : h.levels) stored.triangles += level.triangles, stored.vertices += level.vertices;
  return stored;
}

Json describe_textures(const Hierarchy& h) {
  Json textures = Json::array();
  for (const Texture& t : h.textures)
    textures.push_back(
        {{"name", t.name}, {"media_type", t.media_type}, {"bytes", t.bytes.size()}, {"copies", Json::array()}});
  for (const TextureCopy& c : h.texture_copies)
    textures[c.texture]["copies"].push_back({{"width", c.width}, {"height", c.height}, {"bytes", c.bytes.size()}});
  return textures;
}

void print_textures(const Hierarchy& h) {
  if (h.textures.empty()) return;
  std::uint64_t bytes = 0, copies = 0;
  for (const Texture& t : h.textures) bytes += t.bytes.size();
  for (const TextureCopy& c : h.texture_copies) copies += c.bytes.size();
  fmt::print("{} materials, {} textures of {} bytes", h.materials.size(), h.textures.size(), bytes);
  if (!h.texture_copies.empty())
    fmt::print(", {} copies for coarser levels of {} bytes", h.texture_copies.size(), copies);
  fmt::print("\n");
}

void print_edges(const EdgeCensus& edges) {
  fmt::print("{} edges\n", edges.edges);
  if (edges.border > 0) fmt::print("note: {} edges of one triangle: the surface is open there\n", edges.border);
  if (edges.non_manifold > 0)
    fmt::print("note: {} edges of more than two triangles: simplification keeps them as they are\n",
               edges.non_manifold);
  if (edges.inconsistent > 0)
    fmt::print("note: {} edges whose two triangles face against each other: simplification keeps them as they are\n",
               edges.inconsistent);
}

struct InfoOptions {
  std::string file;
  InputOptions reading;
};

bool is_mesh(const InfoOptions& options) {
  return has_mesh_extension(options.file) || !options.reading.grid.empty() || !is_lode_file(options.file);
}

void describe_mesh(const InfoOptions& options, Scheduler& scheduler, const CommonOptions& common) {
  const std::string& file = options.file;
  ReadConfig reading = read_config(options.reading, {file});
  reading.attributes = false;  // edges are those of the shape
  RawMesh raw = load_mesh(file, scheduler, reading);
  const std::vector<std::string> warnings = std::move(raw.warnings);
  Repairs repairs;
  const IndexedMesh mesh = prepare_mesh(std::move(raw), repairs, scheduler, file);
  const EdgeCensus edges = count_edges(mesh.triangles, mesh.positions.size());
  const Vec3d o = mesh.transform.origin;
  write_result(common, {{"file", file},
                        {"triangles", mesh.triangles.size()},
                        {"vertices", mesh.positions.size()},
                        {"origin", {o.x, o.y, o.z}},
                        {"scale", mesh.transform.scale},
                        {"up", name_of(mesh.transform.up.axis)},
                        {"up_guessed", mesh.transform.up.guessed},
                        {"repairs", to_json(repairs)},
                        {"warnings", warnings},
                        {"edges", edges.edges},
                        {"border_edges", edges.border},
                        {"non_manifold_edges", edges.non_manifold},
                        {"inconsistent_edges", edges.inconsistent}});
  if (!common.prints()) return;
  fmt::print("{}: {} triangles, {} vertices\n", file, mesh.triangles.size(), mesh.positions.size());
  fmt::print("origin ({:g}, {:g}, {:g}), longest extent {:g}, up {}\n", o.x, o.y, o.z, mesh.transform.scale,
             text_of(mesh.transform.up));
  print_warnings(warnings);
  print_repairs(repairs);
  print_edges(edges);
}

void describe_hierarchy(const std::string& file, Scheduler& scheduler, const CommonOptions& common) {
  const Hierarchy h = load_lode(file, scheduler);
  const Vec3d o = h.transform.origin;
  const Stored stored = stored_in(h, file);
  const Json result{{"file", file},
                    {"input_triangles", h.provenance.input_triangles},
                    {"input_vertices", h.provenance.input_vertices},
                    {"repairs", to_json(h.provenance.repairs)},
                    {"sigma0", h.sigma0},
                    {"half_levels", h.grids.halves},
                    {"simplifier", h.provenance.simplifier},
                    {"placement", name_of(static_cast<Placement>(h.provenance.placement))},
                    {"cell_triangles", h.provenance.cell_triangles},
                    {"origin", {o.x, o.y, o.z}},
                    {"scale", h.transform.scale},
                    {"up", name_of(h.transform.up.axis)},
                    {"up_guessed", h.transform.up.guessed},
                    {"kappa0_admissible_above",
                     {{"euclidean", greatest_reach(h, DistanceMetric::euclidean)},
                      {"chebyshev", greatest_reach(h, DistanceMetric::chebyshev)}}},
                    {"errors", name_of_errors(h)},
                    {"refined", h.provenance.refined},
                    {"lattice_bits", h.transform.lattice.bits},
                    {"stored_triangles", stored.triangles},
                    {"stored_vertices", stored.vertices},
                    {"file_bytes", stored.bytes},
                    {"bytes_per_stored_triangle", stored.bytes_per_triangle()},
                    {"materials", h.materials.size()},
                    {"textures", describe_textures(h)},
                    {"levels", h.levels.size()},
                    {"level_table", level_table(h)}};
  write_result(common, result);
  if (!common.prints()) return;
  fmt::print("{}: {} triangles, {} vertices, sigma0 {}, simplifier {}{}\n", file, h.provenance.input_triangles,
             h.provenance.input_vertices, h.sigma0, h.provenance.simplifier, h.grids.halves ? ", half levels" : "");
  fmt::print("{} triangles and {} vertices stored in {} bytes, {:.2f} per triangle{}\n", stored.triangles,
             stored.vertices, stored.bytes, stored.bytes_per_triangle(),
             h.transform.lattice ? fmt::format(", on a lattice of {} bits", h.transform.lattice.bits) : "");
  print_textures(h);
  fmt::print("origin ({:g}, {:g}, {:g}), longest extent {:g}, up {}\n", o.x, o.y, o.z, h.transform.scale,
             text_of(h.transform.up));
  fmt::print("errors {}{}\n", nature_of_errors(h),
             h.provenance.refined ? "; edges of the input beyond sigma0 h were split" : "");
  fmt::print("uniform kappa0 is admissible above {:.4f} (euclidean), {:.4f} (chebyshev)\n\n",
             greatest_reach(h, DistanceMetric::euclidean), greatest_reach(h, DistanceMetric::chebyshev));
  fmt::print("{:>5} {:>9} {:>12} {:>12} {:>8} {:>8} {:>9} {:>9} {:>10}\n", "level", "cells", "triangles", "vertices",
             "reach", "diam", "error/h", "edge/h", "long edges");
  for (std::size_t l = 0; l < h.levels.size(); ++l) {
    const Level& v = h.levels[l];
    fmt::print("{:>5} {:>9} {:>12} {:>12} {:>8.4f} {:>8.4f} {:>9.5f} {:>9.5f} {:>10}\n", l, v.cell_count, v.triangles,
               v.vertices, v.reach[0], v.diameter, v.error, v.max_edge, v.long_edges);
  }
}

void run(const InfoOptions& options, const CommonOptions& common) {
  check_files(common, {{"FILE", options.file}});
  const auto scheduler = make_scheduler(common);
  is_mesh(options) ? describe_mesh(options, *scheduler, common) : describe_hierarchy(options.file, *scheduler, common);
}

OptionTable declare(InfoOptions& o) {
  return with_input_options(
      {OptionSpec{"FILE", &o.file, std::string("Hierarchy (.lode), or mesh: ") + mesh_formats}.must()}, o.reading);
}

}  // namespace

void add_info(CommandTable& commands) {
  define_command<InfoOptions>(
      commands,
      {"info", "Show the levels of a .lode file and the figures the guarantee rests on, or the edges of a mesh",
       "  lodestone info scan.lode\n"
       "  lodestone info scan.lode --json -\n"
       "  lodestone info scan.ply\n"},
      declare, run);
}

}  // namespace lodestone
