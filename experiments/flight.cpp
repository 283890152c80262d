#include "experiments/flight.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include "core/base/error.h"
#include "experiments/metrics/cracks.h"
#include "experiments/metrics/pops.h"
#include "render/lod/selection.h"

namespace lodestone {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Towards the camera, in normalised space, which is the model's space up to a uniform scale.
Vec3f head_light(const Camera& camera) {
  const Vec3d back = camera.position - camera.target;
  return to_float((1 / length(back)) * back);
}

// What measuring a frame needs to remember from the one before.
class Prover {
 public:
  // `limit_rate`: of the detail limits of a streamed hierarchy, which is measured on the whole one.
  Prover(const Hierarchy& hierarchy, double limit_rate, Scheduler& scheduler)
      : hierarchy_(hierarchy),
        limit_rate_(limit_rate),
        scheduler_(scheduler),
        basis_(make_crack_basis(hierarchy, scheduler)) {}

  void measure(MorphContext morph, FrameRow& row) {
    morph.hierarchy = &hierarchy_;
    Selection whole;
    select_cells(hierarchy_, *morph.radii, morph.viewpoint, {.limits = morph.limits}, whole);
    for (const SelectedCell& s : whole.cells) row.selected_triangles += hierarchy_.cells[s.cell].triangles.size();
    row.open_edges = residual_edges(morph, whole, basis_, scheduler_, crack_scratch_).open_edges;
    row.gap_max = vertex_gaps(morph, whole, basis_, scheduler_, crack_scratch_).gap_max;
    if (previous_radii_) {
      MorphContext before = morph;
      before.viewpoint = previous_viewpoint_;
      before.radii = &*previous_radii_;
      before.limits = previous_limits_;
      const PopReport pop = largest_jump(before, previous_, morph, whole, scheduler_, limit_rate_);
      row.max_jump = pop.max_jump;
      row.jump_over_bound = pop.jump_over_bound;
    }
    previous_ = std::move(whole);
    previous_viewpoint_ = morph.viewpoint;
    previous_radii_ = *morph.radii;
    previous_limits_.assign(morph.limits.begin(), morph.limits.end());
  }

 private:
  const Hierarchy& hierarchy_;
  double limit_rate_;
  Scheduler& scheduler_;
  CrackBasis basis_;
  CrackScratch crack_scratch_;
  Selection previous_;
  Vec3f previous_viewpoint_;
  std::optional<Radii> previous_radii_;
  std::vector<DetailLimit> previous_limits_;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

FlightResult fly(const Hierarchy& hierarchy, Renderer& renderer, const FlightConfig& config, Scheduler& scheduler,
                 const OnFrame& on_frame) {
  if (config.cameras.empty()) throw InputError("a flight needs at least one camera");
  ResidentCells* const resident = config.resident;
  const Hierarchy& drawn = resident ? resident->hierarchy() : hierarchy;
  renderer.upload(drawn);
  std::optional<Prover> prover;
  if (config.measure) prover.emplace(hierarchy, resident ? resident->rate() : 0, scheduler);

  FlightResult result;
  result.admissible = true;
  std::vector<double> totals;
  Selection visible;
  for (std::size_t i = 0; i < config.cameras.size(); ++i) {
    if (config.cancel && *config.cancel) throw Cancelled{};
    const Camera& camera = config.cameras[i];
    RadiiConfig radii_config = config.radii;
    radii_config.image_height = config.size.height;
    radii_config.aspect = static_cast<float>(config.size.width) / static_cast<float>(config.size.height);
    radii_config.vertical_fov = static_cast<float>(camera.vertical_fov);
    const Radii radii = make_radii(drawn, radii_config);
    result.admissible = result.admissible && radii.admissible;

    FrameRow row;
    const Clock::time_point start = Clock::now();
    Frame frame;
    frame.only().morph = {&drawn, &radii, config.blend, viewpoint(camera, drawn.transform)};
    frame.only().view_projection = view_projection(camera, drawn, config.size);
    frame.only().towards_eye = head_light(camera);
    frame.size = config.size;
    frame.samples = config.samples;
    frame.setting.level_tint = config.tint_by_level ? 1.0f : 0.0f;
    frame.only().effects.set(Effect::level_tint, config.tint_by_level);
    const Frustum frustum = frustum_of(frame.only().view_projection);
    if (resident) {
      resident->update(radii, frame.only().morph.viewpoint, &frustum);
      renderer.refresh(0, resident->went(), resident->came());
      frame.only().morph.limits = resident->limits();
      row.resident_bytes = resident->bytes();
      row.complete = resident->complete();
    }
    const double stream = milliseconds_since(start);
    select_cells(drawn, radii, frame.only().morph.viewpoint, {&frustum, false, frame.only().morph.limits}, visible);
    frame.only().selection = &visible;
    const double select = milliseconds_since(start) - stream;
    const FrameStats stats = renderer.draw(frame);
    row.cells = stats.cells;
    row.triangles = stats.triangles;
    row.milliseconds = stats.milliseconds;
    row.milliseconds["select"] = select;
    if (resident) row.milliseconds["stream"] = stream;
    row.milliseconds["total"] = milliseconds_since(start);
    totals.push_back(row.milliseconds["total"]);
    if (on_frame) on_frame(i, renderer);
    if (prover) prover->measure(frame.only().morph, row);

    result.open_edges_max = std::max(result.open_edges_max, row.open_edges);
    result.gap_max = std::max(result.gap_max, row.gap_max);
    result.jump_over_bound_max = std::max(result.jump_over_bound_max, row.jump_over_bound);
    result.frames.push_back(std::move(row));
  }
  result.milliseconds_median = median(totals);
  return result;
}

}  // namespace lodestone
