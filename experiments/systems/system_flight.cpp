#include "experiments/systems/system_flight.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/base/error.h"
#include "experiments/metrics/cracks/t_junctions.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/metrics/drawn/screen_error.h"
#include "experiments/systems/patch_proof.h"
#include "experiments/systems/place_jumps.h"

namespace lodestone {
namespace {

// State that a frame of one system leaves for the next one.
struct Past {
  PopTracker pops;
  std::vector<std::unique_ptr<FrameProof>> proofs;  // of the models
  std::vector<std::unique_ptr<MeasuredSurface>> surfaces;
  std::vector<PlacedFrame> placed;  // points of patches
};

class Flight {
 public:
  Flight(SceneView& scene, Renderer& renderer, const SystemFlightConfig& config, Scheduler& scheduler)
      : config_(config), scheduler_(scheduler), pictures_(scene, renderer, scheduler, config.system) {
    for (std::size_t s = 0; s < config.systems.size(); ++s)
      past_.push_back({.pops = PopTracker(scheduler, config.pops),
                       .proofs = {},
                       .surfaces = std::vector<std::unique_ptr<MeasuredSurface>>(scene.model_count()),
                       .placed = std::vector<PlacedFrame>(scene.model_count())});
    const bool patches = config.geometry &&
                         std::ranges::any_of(config.systems, [](auto& name) { return bool(lod_system(name).patches); });
    for (std::size_t m = 0; (patches || config.screen) && m < scene.model_count(); ++m) {
      DrawnMesh finest = finest_mesh(scene.hierarchy(m));
      const double junction = junction_tolerance * scene.hierarchy(m).cell_size(scene.hierarchy(m).finest());
      if (patches) patch_proofs_.emplace_back(finest, junction, scheduler);
      if (config.screen) full_.push_back(std::make_unique<MeasuredSurface>(std::move(finest)));
    }
    if (!config.geometry) return;
    for (Past& past : past_)
      for (std::size_t m = 0; m < scene.model_count(); ++m)
        past.proofs.push_back(std::make_unique<FrameProof>(scene.hierarchy(m), scheduler));
  }

  void fly(std::size_t frame, const OnSystemRow& on_row, std::vector<SystemRow>& rows) {
    const Camera& camera = config_.cameras[frame];
    SystemPicture whole = pictures_.draw(full_system, camera, config_.view);
    const auto full = std::make_shared<const Image>(std::move(whole.image));
    if (full->depth.empty()) throw InputError("LOD systems are compared in pictures; this backend draws none");
    for (std::size_t s = 0; s < config_.systems.size(); ++s) {
      if (config_.cancel && *config_.cancel) throw Cancelled{};
      SystemPicture drawn = pictures_.draw(config_.systems[s], camera, config_.view);
      SystemRow row = start_row(frame, s, drawn);
      PictureErrors errors = picture_errors(*full, drawn.image, scheduler_, config_.quality);
      row.quality = errors.quality;
      row.pops = past_[s].pops.next(picture_frame(errors, drawn.image, full, whole.models.front().view_projection));
      if (config_.geometry) row.surface = measure_surface(drawn, *full, past_[s], row);
      if (config_.screen) measure_screen(drawn, past_[s], row);
      rows.push_back(row);
      if (on_row) on_row(row, drawn, *full);
    }
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

  SurfaceSample measure_surface(const SystemPicture& drawn, const Image& full, Past& past, const SystemRow& row) const {
    SurfaceSample all;
    for (std::size_t m = 0; m < drawn.models.size(); ++m) {
      const SystemModel& model = drawn.models[m];
      // Several models may lie behind each other: their silhouette is not that of one of them.
      const bool alone = drawn.models.size() == 1;
      std::optional<std::span<const float>> depth;
      if (config_.leaks) depth = alone ? std::span<const float>(full.depth) : std::span<const float>();
      if (model.patches) {
        add(all, measure_patches(model, patch_proofs_[m], depth, past.placed[m]));
        continue;
      }
      MorphContext promise = model.context();
      promise.radii = &model.morph;
      promise.blend = config_.view.blend;  // `step` has another one of its own
      ProofFrame frame{model.context(), model.view_projection, config_.view.size};
      frame.follows = row.frame > 0 && lod_system(row.system).moves_vertices;
      frame.promise = &promise;
      frame.full_depth = depth;
      add(all, past.proofs[m]->measure(frame));
    }
    return all;
  }

  SurfaceSample measure_patches(const SystemModel& model, const PatchProof& proof,
                                std::optional<std::span<const float>> depth, PlacedFrame& before) const {
    const Screen screen(model.view_projection, config_.view.size);
    DrawnPoints points = model.patches->drawn_points();
    SurfaceSample sample = proof.measure(
        {drawn_mesh(model.context(), model.whole), drawn_mesh(model.context(), model.skirts), points}, screen, depth);
    PlacedFrame placed{std::move(points.places), model.viewpoint};
    if (!placed.places.empty() && !before.places.empty()) sample.jump = place_jumps(before, placed, screen);
    before = std::move(placed);
    return sample;
  }

  void measure_screen(const SystemPicture& drawn, Past& past, SystemRow& row) {
    for (std::size_t m = 0; m < drawn.models.size(); ++m) {
      const SystemModel& model = drawn.models[m];
      const Screen screen(model.view_projection, config_.view.size);
      auto surface = std::make_unique<MeasuredSurface>(drawn_mesh(model.context(), model.whole));
      const double error = screen_error(*surface, *full_[m], screen, scheduler_).largest();
      row.screen_error = std::max(row.screen_error.value_or(0), error);
      if (past.surfaces[m]) {
        const double shift = screen_error(*surface, *past.surfaces[m], screen, scheduler_).largest();
        row.shift_pixels = std::max(row.shift_pixels.value_or(0), shift);
      }
      past.surfaces[m] = std::move(surface);
    }
  }

  const SystemFlightConfig& config_;
  Scheduler& scheduler_;
  SystemPictures pictures_;
  std::vector<std::unique_ptr<MeasuredSurface>> full_;  // by model
  std::vector<PatchProof> patch_proofs_;                // by model, where a system has patches
  std::vector<Past> past_;                              // by system
};

void check(const SystemFlightConfig& config) {
  if (config.cameras.empty()) throw InputError("a flight needs at least one camera");
  if (config.systems.empty()) throw InputError("no LOD system is named; there is nothing to compare");
  if (std::ranges::find(config.systems, full_system) != config.systems.end())
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
