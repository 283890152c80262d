#include "experiments/systems/system_flight.h"

#include <algorithm>
#include <limits>

#include "core/base/error.h"
#include "experiments/metrics/cracks/cracks.h"
#include "experiments/metrics/cracks/leaks.h"
#include "experiments/metrics/cracks/t_junctions.h"
#include "experiments/metrics/pops/pops.h"
#include "render/culling/back_faces.h"

namespace lodestone {
namespace {

// What a frame of one system leaves for the next one.
struct Past {
  std::vector<SystemModel> models;
  ErrorMap absolute, flip;
};

// What of a model all its frames share.
struct ModelBasis {
  CrackBasis cracks;
  bool closed = false;
};

class Flight {
 public:
  Flight(SceneView& scene, Renderer& renderer, const SystemFlightConfig& config, Scheduler& scheduler)
      : config_(config), scheduler_(scheduler), pictures_(scene, renderer, config.system) {
    scene.upload(renderer);
    past_.resize(config.systems.size());
    if (!config.geometry) return;
    for (std::size_t m = 0; m < scene.model_count(); ++m)
      bases_.push_back({make_crack_basis(scene.hierarchy(m), scheduler), is_closed(scene.hierarchy(m), scheduler)});
  }

  void fly(std::size_t frame, const OnSystemRow& on_row, std::vector<SystemRow>& rows) {
    const Camera& camera = config_.cameras[frame];
    SystemPicture full = pictures_.draw(LodSystem::full, camera, config_.view);
    if (full.image.depth.empty()) throw InputError("LOD systems are compared in pictures; this backend draws none");
    for (std::size_t s = 0; s < config_.systems.size(); ++s) {
      if (config_.cancel && *config_.cancel) throw Cancelled{};
      SystemPicture drawn = pictures_.draw(config_.systems[s], camera, config_.view);
      SystemRow row = start_row(frame, s, drawn);
      PictureErrors errors = picture_errors(full.image, drawn.image, scheduler_, config_.quality);
      row.quality = errors.quality;
      if (frame > 0) measure_pops(past_[s], errors, full, row);
      if (config_.geometry) measure_geometry(drawn, full.image, past_[s], row);
      rows.push_back(row);
      if (on_row) on_row(row, drawn, full.image);
      past_[s] = {std::move(drawn.models), std::move(errors.absolute), std::move(errors.flip)};
    }
    full_before_ = std::move(full);
  }

 private:
  SystemRow start_row(std::size_t frame, std::size_t system, const SystemPicture& drawn) const {
    SystemRow row;
    row.frame = frame;
    row.system = config_.systems[system];
    row.cells = drawn.stats.cells;
    row.triangles = drawn.stats.triangles;
    const auto total = drawn.stats.milliseconds.find("total");
    if (total != drawn.stats.milliseconds.end()) row.milliseconds = total->second;
    row.pictures = drawn.pictures;
    return row;
  }

  void measure_pops(const Past& past, const PictureErrors& errors, const SystemPicture& full, SystemRow& row) {
    const auto frame = [&](const ErrorMap& absolute, const ErrorMap& flip, const SystemPicture& picture) {
      ErrorFrame made{{&absolute}, &picture.image, picture.models.front().view_projection};
      if (config_.quality.with_flip) made.errors.push_back(&flip);
      return made;
    };
    const std::vector<ImagePops> pops = image_pops(frame(past.absolute, past.flip, full_before_),
                                                   frame(errors.absolute, errors.flip, full), scheduler_, config_.pops);
    row.pops = pops.front();
    if (config_.quality.with_flip) row.flip_pops = pops.back();
  }

  void measure_geometry(const SystemPicture& drawn, const Image& full, const Past& past, SystemRow& row) {
    double gap_sum = 0, pixel_sum = 0;
    std::uint64_t in_view = 0;
    row.closed = std::ranges::all_of(bases_, &ModelBasis::closed);
    for (std::size_t m = 0; m < drawn.models.size(); ++m) {
      const SystemModel& model = drawn.models[m];
      const MorphContext context = model.context();
      const Screen screen(model.view_projection, config_.view.size);
      const double unit = model.hierarchy->transform.scale;
      row.open_edges += residual_edges(context, model.whole, bases_[m].cracks, scheduler_, scratch_).open_edges;
      const GapReport gaps = vertex_gaps(context, model.whole, bases_[m].cracks, scheduler_, scratch_, &screen);
      row.gaps += gaps.gaps;
      row.gap_max = std::max(row.gap_max, unit * gaps.gap_max);
      row.gap_max_pixels = std::max(row.gap_max_pixels, gaps.gap_max_pixels);
      gap_sum += unit * gaps.gap_mean * static_cast<double>(gaps.gaps);
      pixel_sum += gaps.gap_mean_pixels * static_cast<double>(gaps.gaps_in_view);
      in_view += gaps.gaps_in_view;
      const double near = junction_tolerance * cell_size(model.hierarchy->finest());
      row.t_junctions += t_junctions(context, model.whole, near, scheduler_).vertices;
      if (config_.leaks && bases_[m].closed) add_leaks(context, model, screen, full, row);
      if (row.frame > 0 && row.system != LodSystem::cross_fade) add_jumps(past.models[m], model, screen, row);
    }
    if (row.gaps > 0) row.gap_mean = gap_sum / static_cast<double>(row.gaps);
    if (in_view > 0) row.gap_mean_pixels = pixel_sum / static_cast<double>(in_view);
  }

  // Behind several models there may be others: their silhouette is not that of one of them.
  void add_leaks(const MorphContext& context, const SystemModel& model, const Screen& screen, const Image& full,
                 SystemRow& row) {
    LeakConfig config;
    if (bases_.size() == 1) config.full_depth = full.depth;
    const LeakReport leaks = find_leaks(context, model.whole, screen, scheduler_, config);
    row.leak_pixels += leaks.leak_pixels();
    row.torn_pixels += leaks.torn;
  }

  void add_jumps(const SystemModel& before, const SystemModel& after, const Screen& screen, SystemRow& row) {
    MorphContext morph_before = before.context(), morph_after = after.context();
    morph_before.radii = &before.morph;
    morph_after.radii = &after.morph;
    morph_before.blend = morph_after.blend = config_.view.blend;  // `step` has another one of its own
    const std::vector<double> bounds = jump_bounds(morph_before, morph_after);
    const PopReport jumps = largest_jump(before.context(), before.whole, after.context(), after.whole, scheduler_,
                                         {.percentiles = true, .screen = &screen, .bounds = bounds});
    const double unit = after.hierarchy->transform.scale;
    row.step = std::max(row.step, unit * jumps.step);
    row.jump_max = std::max(row.jump_max, unit * jumps.max_jump);
    row.jump_p99 = std::max(row.jump_p99, unit * jumps.p99_jump);
    row.jump_max_pixels = std::max(row.jump_max_pixels, jumps.max_jump_pixels);
    row.jump_p99_pixels = std::max(row.jump_p99_pixels, jumps.p99_jump_pixels);
    row.jump_over_bound =
        std::max(row.jump_over_bound, jumps.bounded ? jumps.jump_over_bound : std::numeric_limits<double>::infinity());
  }

  const SystemFlightConfig& config_;
  Scheduler& scheduler_;
  SystemPictures pictures_;
  std::vector<ModelBasis> bases_;
  CrackScratch scratch_;
  std::vector<Past> past_;  // by system
  SystemPicture full_before_;
};

void check(const SystemFlightConfig& config) {
  if (config.cameras.empty()) throw InputError("a flight needs at least one camera");
  if (config.systems.empty()) throw InputError("no LOD system is named; there is nothing to compare");
  if (std::ranges::find(config.systems, LodSystem::full) != config.systems.end())
    throw InputError("the full model is what LOD systems are compared with; it cannot be one of them");
}

}  // namespace

std::vector<SystemRow> fly_systems(SceneView& scene, Renderer& renderer, const SystemFlightConfig& config,
                                   Scheduler& scheduler, const OnSystemRow& on_row) {
  check(config);
  Flight flight(scene, renderer, config, scheduler);
  std::vector<SystemRow> rows;
  for (std::size_t i = 0; i < config.cameras.size(); ++i) flight.fly(i, on_row, rows);
  return rows;
}

}  // namespace lodestone
