#include "render/reconstruct/reconstruct.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/base/error.h"
#include "parallel/scheduler/clock.h"
#include "render/backends/make_renderer.h"
#include "render/position_map/map_files.h"
#include "render/position_map/map_view.h"
#include "render/position_map/position_map.h"
#include "render/reconstruct/finish/label_parts.h"
#include "render/reconstruct/finish/lost_parts.h"
#include "render/reconstruct/finish/resample_attributes.h"
#include "render/reconstruct/finish/sharpen.h"
#include "render/reconstruct/finish/simplify_merged.h"
#include "render/reconstruct/finish/survey.h"
#include "render/reconstruct/finish/turn_normals.h"
#include "render/reconstruct/from_maps.h"
#include "render/reconstruct/merge/gather.h"
#include "render/reconstruct/outside/shell.h"
#include "render/reconstruct/sampling.h"
#include "render/reconstruct/views/choose_views.h"
#include "render/reconstruct/views/condense_map.h"
#include "render/reconstruct/views/inside_views.h"

namespace lodestone {
namespace {

void check_config(const ReconstructConfig& config) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw InputError(what);
  };
  require(config.resolution >= 2 && config.resolution <= largest_map_side, "resolution: give 2 to 16384 pixels");
  require(config.detail >= 1 && config.detail <= 16, "detail: give a factor from 1 to 16");
  require(config.max_slope > 0 && std::isfinite(config.max_slope), "max slope: give a number above 0");
  require(config.slack >= 0 && std::isfinite(config.slack), "slack: give a number of pixels, 0 or more");
  require(config.sharp_degrees >= 0 && config.sharp_degrees < 180, "sharp: give an angle from 0 to below 180 degrees");
  require(config.views.most >= 1 && config.views.most <= 1000, "views: give 1 to 1000");
}

Box3f box_of(const IndexedMesh& mesh) {
  Box3f box;
  for (const Vec3f& p : mesh.positions) box.extend(p);
  return box;
}

// A strip of an open surface of fewer samples across falls to pieces: at its outline only every second pixel is in a
// triangle, and where it turns another view takes over. Maps of less than 512 pixels are drawn up to four times finer
// for it; the mesh is simplified to as many triangles as ever.
double spacing_for_width(double width, double spacing) {
  constexpr double samples_across = 6, most_finer = 4, most_pixels = 512;
  const double finer = std::clamp(samples_across * spacing / width, 1.0, most_finer);
  return std::min(spacing, std::max(spacing / finer, 1 / most_pixels));
}

MapView view_towards(const Box3f& box, Vec3d direction, double spacing, const ReconstructConfig& config) {
  if (config.projection == Projection::orthographic) return orthographic_view(box, direction, spacing);
  // Four radii away nearer parts are sampled at most two thirds denser than farther ones.
  const Vec3d lo = to_double(box.lo), hi = to_double(box.hi);
  const Vec3d eye = 0.5 * (lo + hi) - (2 * length(hi - lo) / length(direction)) * direction;
  return perspective_view(box, eye, spacing);
}

// Filled pixels may be connected with all their neighbours.
void allow_links(const PositionMap& map, std::span<const std::uint32_t> filled, PixelArray<std::uint8_t>& links) {
  const auto width = static_cast<std::uint32_t>(map.view.width);
  for (const std::uint32_t i : filled) {
    links[i] = link_all;
    if (i >= 1) links[i - 1] |= link_right | link_across;
    if (i >= width) links[i - width] |= link_down | link_across;
    if (i >= width + 1) links[i - width - 1] |= link_diagonal;
  }
}

void prepare_map(DrawnMaps& drawn, std::size_t view, const ReconstructConfig& config) {
  PositionMap& map = drawn.maps[view];
  if (map.normal.empty()) estimate_normals(map);
  if (!config.extend) return;
  const std::vector<std::uint32_t> filled = extend_to_silhouette(map, config.max_slope);
  map = without_gaps(map);  // with memory beside the filled pixels, too
  if (drawn.links[view].empty()) return;
  drawn.links[view] = drawn.links[view].in(map.triangle);
  drawn.vertices[view] = drawn.vertices[view].in(map.triangle);
  allow_links(map, filled, drawn.links[view]);
  for (const std::uint32_t i : filled) drawn.vertices[view][i] = map.position[i];
}

// The map of a view, condensed from a finer one where that is wanted.
void draw_map(MapRenderer& renderer, const MapView& view, const ReconstructConfig& config, DrawnMaps& drawn,
              Scheduler& scheduler) {
  const MapChannels channels{.uv = config.attributes, .colour = config.attributes};
  if (!config.condense) {
    drawn.maps.push_back(renderer.draw(view, channels));
    drawn.links.emplace_back();
    drawn.vertices.emplace_back();
    return;
  }
  const PositionMap fine = renderer.draw(finer_view(view), channels);
  CondensedMap condensed = condensed_like(fine, view);
  CondenseConfig condense_config;
  condense_config.connect = {config.max_slope, config.slack, drawn.oriented, drawn.parts};
  scheduler.for_chunks(static_cast<std::size_t>(view.height), block_rows, [&](ChunkRange range) {
    condense_rows(fine, condense_config, static_cast<int>(range.begin), static_cast<int>(range.end), condensed);
  });
  drawn.maps.push_back(std::move(condensed.map));
  drawn.links.push_back(std::move(condensed.links));
  drawn.vertices.push_back(std::move(condensed.vertex));
}

std::vector<MergeView> connect_maps(DrawnMaps& drawn, const ReconstructConfig& config, ReconstructReport& report,
                                    Scheduler& scheduler) {
  scheduler.for_chunks(drawn.maps.size(), 1, [&](ChunkRange range) { prepare_map(drawn, range.index, config); });
  std::vector<MergeView> views(drawn.maps.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    views[v].map = &drawn.maps[v];
    if (!drawn.vertices[v].empty()) views[v].vertex = &drawn.vertices[v];
    if (!drawn.links[v].empty()) views[v].links = &drawn.links[v];
    views[v].mesh.cells = drawn.maps[v].triangle.like<std::uint8_t>();
  }
  std::atomic<std::uint64_t> triangles{0}, seen{0};
  for_blocks(row_blocks(views), scheduler, [&](const RowBlock& block, std::size_t) {
    MergeView& view = views[block.view];
    const ConnectConfig connect_config{config.max_slope, config.slack, drawn.oriented, drawn.parts, view.links};
    connect_rows(*view.map, connect_config, block.first, block.last, view.mesh);
    std::uint64_t own = 0, own_seen = 0;
    for_pixels(view, block.first, block.last, [&](std::size_t i) {
      own += static_cast<std::uint64_t>(__builtin_popcount(view.mesh.cells[i] & cell_triangles));
      own_seen += view.map->sees(i);
    });
    triangles += own, seen += own_seen;
  });
  report.view_triangles = triangles, report.seen = seen;
  for (const PositionMap& map : drawn.maps) report.pixels += map.view.pixels();
  return views;
}

// A choice of views that is no finer than what will be drawn: two samples for a pixel of a face, up to what the
// choice asks for.
ViewChoice sampled_for(const ReconstructConfig& config) {
  ViewChoice choice = config.views;
  const double pixels = config.resolution * config.resolution;
  choice.samples = std::min(choice.samples, std::max<std::uint64_t>(4000, static_cast<std::uint64_t>(2 * pixels)));
  choice.resolution = std::min(choice.resolution, static_cast<int>(std::lround(2 * config.resolution)));
  return choice;
}

// Maps for a shell: the space that they see to be free is the same for any parts, borders and orientation.
DrawnMaps draw_even_maps(const IndexedMesh& mesh, const ReconstructConfig& config, ReconstructReport& report,
                         Scheduler& scheduler) {
  DrawnMaps drawn;
  report.spacing = 1 / config.resolution, report.drawn_resolution = config.resolution;
  drawn.spacing = report.map_spacing = map_spacing(config);
  report.views.directions = even_directions(config.views.most);
  const CpuClock draw_clock;
  scheduler.name_work("draw maps");
  const Box3f box = box_of(mesh);
  const auto renderer = make_map_renderer(config.backend, mesh, scheduler);
  const MapChannels channels{.uv = config.attributes, .colour = config.attributes};
  for (const Vec3d& direction : report.views.directions) {
    drawn.maps.push_back(renderer->draw(orthographic_view(box, direction, drawn.spacing), channels));
    report.pixels += drawn.maps.back().view.pixels();
  }
  report.draw = draw_clock.elapsed();
  return drawn;
}

// The triangle that each vertex saw.
std::vector<std::uint32_t> sources_of(const MergedMesh& merged, std::span<const PositionMap> maps) {
  std::vector<std::uint32_t> source(merged.position.size(), no_source);
  for (std::size_t v = 0; v < source.size(); ++v)
    if (merged.view[v] != no_view) source[v] = maps[merged.view[v]].triangle[merged.pixel[v]];
  return source;
}

// Sharpening and simplifying need memory of their own.
void release_pixels(DrawnMaps& drawn) {
  drawn.links.clear(), drawn.vertices.clear();
  for (PositionMap& map : drawn.maps) {
    PositionMap rest;
    rest.view = map.view, rest.transform = map.transform;
    map = std::move(rest);
  }
}

// The mesh of all views; `spacing`: of the maps.
MergedMesh merge_maps(DrawnMaps& drawn, double spacing, const ReconstructConfig& config, ReconstructReport& report,
                      Scheduler& scheduler) {
  if (config.merge == MergeKind::shell) {
    const CpuClock clock;
    scheduler.name_work("make the shell");
    MergedMesh merged = make_shell(drawn.maps, report.spacing, report.shell, scheduler);
    report.merge = clock.elapsed();
    return merged;
  }
  const CpuClock connect_clock;
  scheduler.name_work("connect");
  std::vector<MergeView> views = connect_maps(drawn, config, report, scheduler);
  report.connect = connect_clock.elapsed();

  const CpuClock merge_clock;
  scheduler.name_work("merge");
  MergedMesh merged;
  if (config.merge == MergeKind::concatenate) {
    merged = concatenate(views, scheduler);
  } else {
    MergeConfig merge;
    merge.ownership.reference_spacing = spacing;
    merge.ownership.parts = drawn.parts;
    merge.closed = drawn.closed;
    merge.border = drawn.border;
    merge.longest_hole = config.longest_hole;
    merge.most_handles = drawn.most_handles;
    merged = stitch(views, merge, report.stitch, scheduler);
  }
  report.merge = merge_clock.elapsed();
  return merged;
}

// To as many triangles as the resolution stands for, or as are requested. Sets the spacing that they stand for.
SimplifyMergedConfig simplify_config(const MergedMesh& merged, double spacing, const ReconstructConfig& config,
                                     ReconstructReport& report) {
  const auto made = static_cast<double>(merged.triangles.size());
  const double excess = excess_of(config, report.spacing / spacing);
  SimplifyMergedConfig simplify;
  simplify.triangles = static_cast<std::size_t>(made / excess);
  if (config.triangles > 0 && config.triangles < merged.triangles.size()) {
    // The spacing of samples that would make so many.
    report.spacing = report.spacing * std::sqrt(made / excess / static_cast<double>(config.triangles));
    simplify.triangles = config.triangles;
  }
  // Farther than this flat parts would be cut into slivers (docs/decisions/0020).
  simplify.farthest = static_cast<float>(1.5 * report.spacing);
  return simplify;
}

void put_mesh(const MergedMesh& merged, const Transform& transform, RawMesh& raw) {
  raw.up = transform.up;
  raw.positions.clear();
  raw.positions.reserve(merged.position.size());
  for (const Vec3f& p : merged.position) raw.positions.push_back(transform.to_model(p));
  raw.triangles = merged.triangles;
}

// Vertices that are no longer where put_mesh() has put them.
void take_moved(const RawMesh& raw, const Transform& transform, MergedMesh& merged) {
  for (std::size_t v = 0; v < merged.position.size(); ++v)
    if (raw.positions[v] != transform.to_model(merged.position[v]))
      merged.position[v] = transform.to_normalised(raw.positions[v]);
}

}  // namespace

const ChosenViews& LastChoice::views(const IndexedMesh& mesh, const ViewChoice& choice, Scheduler& scheduler) {
  if (choice_ != choice) chosen_ = choose_views(mesh, choice, scheduler), choice_ = choice;
  return chosen_;
}

DrawnMaps draw_maps(const IndexedMesh& mesh, const ReconstructConfig& config, LastChoice& last,
                    ReconstructReport& report, Scheduler& scheduler) {
  check_config(config);
  if (config.merge == MergeKind::shell) return draw_even_maps(mesh, config, report, scheduler);
  const CpuClock choose_clock;
  DrawnMaps drawn;
  Survey surveyed;
  scheduler.name_work("survey");
  scheduler.for_chunks(2, 1, [&](ChunkRange range) {
    if (range.index == 0)
      surveyed = survey(mesh);
    else if (config.separate_parts)
      drawn.parts = label_parts(mesh);
  });
  const auto& [census, handles] = surveyed;
  drawn.closed = census.border == 0;
  drawn.oriented = census.inconsistent == 0;
  drawn.most_handles = handles.value_or(any_number);
  report.closed = drawn.closed, report.oriented = drawn.oriented;
  report.spacing = 1 / config.resolution, report.drawn_resolution = config.resolution;
  drawn.spacing = map_spacing(config);
  if (!drawn.closed) {
    const std::vector<LoneEdge> border = border_edges(mesh);
    if (config.merge == MergeKind::stitch && config.detail > 1)
      drawn.spacing = spacing_for_width(narrowest_width(mesh, drawn.parts, border), drawn.spacing);
    drawn.border = border_points(mesh, border, 0.5 * drawn.spacing);
  }
  report.map_spacing = drawn.spacing;
  scheduler.name_work("choose views");
  if (config.views.prescribes_faces())
    report.views.directions = face_directions();
  else
    report.views = last.views(mesh, sampled_for(config), scheduler);
  report.choose = choose_clock.elapsed();

  const CpuClock draw_clock;
  scheduler.name_work("draw maps");
  const Box3f box = box_of(mesh);
  const auto renderer = make_map_renderer(config.backend, mesh, scheduler);
  for (const Vec3d& direction : report.views.directions)
    draw_map(*renderer, view_towards(box, direction, drawn.spacing, config), config, drawn, scheduler);
  const auto along = [&](Vec3d direction) { return orthographic_view(box, direction, drawn.spacing); };
  scheduler.name_work("choose inside views");
  report.views.inside = choose_inside_views(mesh, report.views.samples, drawn.maps, config.views, along, scheduler);
  scheduler.name_work("draw maps");
  for (const MapView& view : report.views.inside) draw_map(*renderer, view, config, drawn, scheduler);
  report.draw = draw_clock.elapsed();
  return drawn;
}

RawMesh mesh_from_maps(DrawnMaps& drawn, const IndexedMesh* mesh, const ReconstructConfig& config,
                       ReconstructReport& report, Scheduler& scheduler) {
  check_config(config);
  if (drawn.maps.empty()) return {};
  const double spacing = drawn.spacing > 0 ? drawn.spacing : report.spacing;
  MergedMesh merged = merge_maps(drawn, spacing, config, report, scheduler);
  std::vector<std::uint32_t> source = sources_of(merged, drawn.maps);
  release_pixels(drawn);

  const bool one_surface = config.merge != MergeKind::concatenate;
  const CpuClock sharpen_clock;
  scheduler.name_work("sharpen");
  if (one_surface && config.sharp_degrees > 0) {
    const double of_samples = config.merge == MergeKind::shell ? report.spacing : spacing;
    report.sharpen = sharpen(merged, {static_cast<float>(of_samples), config.sharp_degrees}, scheduler);
  }
  source.resize(merged.position.size(), no_source);
  report.sharpen_time = sharpen_clock.elapsed();

  scheduler.name_work("take over lost parts");
  if (config.merge == MergeKind::stitch && config.lost_parts && mesh)
    report.lost = take_over_lost_parts(*mesh, spacing, merged, source, drawn.closed, scheduler);
  RawMesh raw;
  put_mesh(merged, drawn.maps.front().transform, raw);
  if (config.attributes && mesh) {
    const CpuClock attributes_clock;
    resample_attributes(*mesh, std::move(source), raw);
    take_moved(raw, drawn.maps.front().transform, merged);
    report.attributes = attributes_clock.elapsed();
  }
  report.sampled_triangles = merged.triangles.size();
  if (one_surface) {
    const CpuClock simplify_clock;
    scheduler.name_work("simplify");
    simplify_merged(merged, raw.wedges, simplify_config(merged, spacing, config, report), scheduler);
    put_mesh(merged, drawn.maps.front().transform, raw);
    report.simplify = simplify_clock.elapsed();
  }
  turn_normals(raw);
  return raw;
}

DrawnMaps drawn_maps(MapSet&& set, ReconstructReport& report) {
  DrawnMaps drawn;
  drawn.maps = std::move(set.maps);
  drawn.links.resize(drawn.maps.size());
  drawn.vertices.resize(drawn.maps.size());
  drawn.closed = report.closed = set.closed;
  drawn.oriented = set.oriented;
  // The middle one of the views' spacings in the middle of what they see.
  std::vector<double> spacings;
  for (const PositionMap& map : drawn.maps) {
    double sum = 0;
    std::size_t count = 0;
    map.groups().for_pixels(0, map.view.pixels(), [&](std::size_t i) {
      if (map.sees(i)) sum += map.depth[i], ++count;
    });
    if (count > 0) spacings.push_back(map.view.spacing(sum / static_cast<double>(count)));
  }
  std::sort(spacings.begin(), spacings.end());
  report.spacing = spacings.empty() ? 1 : spacings[spacings.size() / 2];
  return drawn;
}

Reconstruction reconstruct(const IndexedMesh& mesh, const ReconstructConfig& config, Scheduler& scheduler) {
  LastChoice last;
  return reconstruct(mesh, config, last, scheduler);
}

Reconstruction reconstruct(const IndexedMesh& mesh, const ReconstructConfig& config, LastChoice& last,
                           Scheduler& scheduler) {
  Reconstruction result;
  DrawnMaps drawn = draw_maps(mesh, config, last, result.report, scheduler);
  if (config.keep_maps) result.maps = std::make_shared<const std::vector<PositionMap>>(drawn.maps);
  result.mesh = mesh_from_maps(drawn, &mesh, config, result.report, scheduler);
  return result;
}

double resolution_at_distance(const IndexedMesh& mesh, double distance, int rows) {
  if (!(distance > 0) || !std::isfinite(distance)) throw InputError("distance: give a number above 0, in model units");
  const double pixel = 2 * distance * std::tan(std::numbers::pi / 8) / rows;
  return std::clamp(mesh.transform.scale / pixel, 2.0, double{largest_map_side} / 2);
}

}  // namespace lodestone
