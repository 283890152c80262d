#include "render/reconstruct/merge/merge.h"

#include <algorithm>
#include <limits>

#include "parallel/scheduler/clock.h"
#include "render/reconstruct/merge/cut_out.h"

namespace lodestone {
namespace {

void score_views(std::span<MergeView> views, const OwnershipConfig& config, Scheduler& scheduler) {
  const std::vector<RowBlock> blocks = row_blocks(views);
  std::vector<PixelArray<float>> before(views.size());
  scheduler.for_chunks(2 * views.size(), 1, [&](ChunkRange range) {
    const std::size_t v = range.index / 2;
    (range.index % 2 == 0 ? views[v].score : before[v]) = views[v].map->triangle.like<float>();
  });
  for_blocks(blocks, scheduler, [&](const RowBlock& b, std::size_t) {
    score_rows(views[b.view], config, b.first, b.last, views[b.view].score);
  });
  for (int round = 0; round < config.spread; ++round) {
    for (std::size_t v = 0; v < views.size(); ++v) std::swap(before[v], views[v].score);
    for_blocks(blocks, scheduler, [&](const RowBlock& b, std::size_t) {
      spread_rows(views[b.view], b.first, b.last, before[b.view], views[b.view].score);
    });
  }
}

void keep_views(std::span<MergeView> views, std::span<const RowBlock> blocks, Scheduler& scheduler) {
  for_blocks(blocks, scheduler,
             [&](const RowBlock& b, std::size_t) { keep_rows(views[b.view], b.view, b.first, b.last); });
}

std::size_t own_views(std::span<MergeView> views, const OwnershipConfig& config, Scheduler& scheduler) {
  const std::vector<RowBlock> blocks = row_blocks(views);
  scheduler.for_chunks(views.size(), 1, [&](ChunkRange range) {
    MergeView& view = views[range.index];
    view.owner = view.map->triangle.like<ViewNumber>(no_view);
    view.kept = view.map->triangle.like<std::uint8_t>();
  });
  for_blocks(blocks, scheduler,
             [&](const RowBlock& b, std::size_t) { own_rows(views, b.view, config, b.first, b.last); });
  keep_views(views, blocks, scheduler);
  // Owners that are left when all lone pixels have been given up by all views at once.
  std::vector<std::size_t> dropped(blocks.size());
  for_blocks(blocks, scheduler, [&](const RowBlock& b, std::size_t k) {
    dropped[k] = drop_lone_rows(views[b.view], b.view, b.first, b.last);
  });
  for_blocks(blocks, scheduler,
             [&](const RowBlock& b, std::size_t) { own_dropped_rows(views, b.view, config, b.first, b.last); });
  keep_views(views, blocks, scheduler);
  std::size_t sum = 0;
  for (const std::size_t n : dropped) sum += n;
  return sum;
}

void sew(SeamMesh& seam, const ViewPatches& patches, const MergeConfig& config, StitchReport& report,
         Scheduler& scheduler) {
  const auto spacing = static_cast<float>(config.ownership.reference_spacing);
  ZipConfig zip{.spacing = spacing, .rims = config.closed, .most_handles = config.most_handles};
  report.zipped = zip_seams(seam, zip, scheduler);
  // The remaining holes of a solid are ends of thin parts, where the surface turns back within a sample or two.
  if (config.closed || !config.border.empty()) {
    zip.least_cosine = -0.5f;
    report.zipped += zip_seams(seam, zip, scheduler);
  }
  report.handles = seam.borders.handles();
  report.vertices_split = split_vertices(seam);
  report.crumbs = drop_crumbs(seam, patches.triangles,
                              {.least = config.closed ? config.least_solid : config.least_piece,
                               .least_beside = config.border.empty() ? 0 : config.least_solid,
                               .rest = !config.ownership.parts.empty()});
  const bool all = config.closed && config.longest_hole > 0;
  const FillResult filled =
      fill_holes(seam, {.spacing = spacing,
                        .longest = all ? std::numeric_limits<float>::infinity() : config.longest_hole,
                        .rims = config.closed});
  report.holes_filled = filled.filled, report.hole_triangles = filled.triangles, report.holes_open = filled.open;
  report.longest_filled = filled.longest;
  report.open_length = filled.open_length;
  const TidyResult tidied = tidy_seams(seam, {.spacing = spacing}, scheduler);
  report.collapsed = tidied.collapsed, report.flipped = tidied.flipped;
}

}  // namespace

MergedMesh concatenate(std::span<const MergeView> views, Scheduler& scheduler) {
  return std::move(gather(views, all_cells, {}, scheduler).mesh);
}

MergedMesh stitch(std::span<MergeView> views, const MergeConfig& config, StitchReport& report, Scheduler& scheduler) {
  const CpuClock own_clock;
  const ModelBorder border(config.border, 1.5f * static_cast<float>(config.ownership.reference_spacing));
  OwnershipConfig ownership = config.ownership;
  if (!config.border.empty()) ownership.border = &border;
  score_views(views, ownership, scheduler);
  report.islands = own_views(views, ownership, scheduler);
  const PixelFlags flags = find_borders(views, scheduler);
  Gathered gathered = gather(views, kept_cells, flags, scheduler);
  const ViewPatches patches = label_patches(views, scheduler);
  report.own = own_clock.elapsed();
  const CpuClock zip_clock;
  SeamMesh seam = cut_out_seams(views, config.ownership.parts, flags, patches, gathered, scheduler);
  if (!config.border.empty()) mark_rims(border, seam, scheduler);
  sew(seam, patches, config, report, scheduler);
  put_back(seam, gathered);
  report.zip = zip_clock.elapsed();
  return std::move(gathered.mesh);
}

}  // namespace lodestone
