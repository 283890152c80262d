// Triangles are met as by moeller1997, in double.
#include "render/viewer/session/surface_pick.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/hierarchy/model/material_of.h"
#include "render/effects/transparency.h"
#include "render/viewer/session/projection.h"

namespace lodestone::viewer {
namespace {

// from + way (to - from), way in [0, 1]: the points of normalised model space that are seen at a point of the picture.
struct Sight {
  Vec3d from, along;
};

// Where the sight enters the box, if it does before `end`.
std::optional<double> entry(const Sight& sight, const Box3f& box, double end) {
  double first = 0, last = end;
  const auto narrow = [&](double from, double along, double lo, double hi) {
    if (along == 0) {
      if (from < lo || from > hi) last = -1;
      return;
    }
    const auto [a, b] = std::minmax({(lo - from) / along, (hi - from) / along});
    first = std::max(first, a);
    last = std::min(last, b);
  };
  narrow(sight.from.x, sight.along.x, box.lo.x, box.hi.x);
  narrow(sight.from.y, sight.along.y, box.lo.y, box.hi.y);
  narrow(sight.from.z, sight.along.z, box.lo.z, box.hi.z);
  return first <= last ? std::optional(first) : std::nullopt;
}

struct Crossing {
  double way;
  bool front;  // the triangle turns anticlockwise as seen from the eye
};
std::optional<Crossing> crossing(const Sight& sight, Vec3f a, Vec3f b, Vec3f c) {
  const Vec3d edge = to_double(b) - to_double(a), other = to_double(c) - to_double(a);
  const Vec3d across = cross(sight.along, other);
  const double determinant = dot(edge, across);
  if (determinant == 0) return {};
  const Vec3d apart = sight.from - to_double(a);
  const double u = dot(apart, across) / determinant;
  if (!(u >= 0 && u <= 1)) return {};
  const Vec3d over = cross(apart, edge);
  const double v = dot(sight.along, over) / determinant;
  if (!(v >= 0 && u + v <= 1)) return {};
  return Crossing{dot(other, over) / determinant, determinant > 0};
}

// The drawn triangles of one model.
class DrawnModel {
 public:
  DrawnModel(const ModelFrame& model, const Sight& sight)
      : model_(model), hierarchy_(*model.morph.hierarchy), sight_(sight), one_side_(effects::has_one_side(model)) {}

  // Replaces `nearest` by what is met before it.
  void meet(std::size_t number, std::optional<SurfacePoint>& nearest) {
    struct Candidate {
      double from;
      SelectedCell cell;
    };
    std::vector<Candidate> candidates;
    for (const SelectedCell& selected : model_.selection->cells) {
      if (!selected.visible) continue;
      const Box3f box = drawn_bounds(hierarchy_, selected.cell, selected.level);
      if (const auto from = entry(sight_, box, nearest ? nearest->way : 1)) candidates.push_back({*from, selected});
    }
    std::ranges::stable_sort(candidates, {}, &Candidate::from);
    for (const auto& [from, selected] : candidates) {
      if (nearest && from > nearest->way) return;
      meet_cell(number, selected, nearest);
    }
  }

 private:
  void meet_cell(std::size_t number, const SelectedCell& selected, std::optional<SurfacePoint>& nearest) {
    const Cell& cell = hierarchy_.cells[selected.cell];
    const bool morphing = selected.morphing && cell.parent != no_cell && model_.effects.contains(Effect::geomorph);
    std::span<const Vec3f> positions = cell.positions;
    if (morphing) {
      morphed_.resize(positions.size());
      morph_cell(model_.morph, selected.cell, morphed_);
      positions = morphed_;
    }
    for (std::uint32_t t = 0; t < cell.triangles.size(); ++t) {
      const auto& v = cell.triangles[t].v;
      const auto met = crossing(sight_, positions[v[0]], positions[v[1]], positions[v[2]]);
      if (!met || met->way < 0 || met->way > (nearest ? nearest->way : 1)) continue;
      if (model_.clip && distance_from(*model_.clip, to_float(sight_.from + met->way * sight_.along)) < 0) continue;
      if (!met->front && one_side_ && is_one_sided(cell, v[0])) continue;
      nearest = SurfacePoint{number,  selected.cell, selected.level, morphing, t, sight_.from + met->way * sight_.along,
                             met->way};
    }
  }
  [[nodiscard]] bool is_one_sided(const Cell& cell, std::uint32_t corner) const {
    const std::uint32_t material = material_of(hierarchy_, cell, corner);
    return material != no_material && !hierarchy_.materials[material].double_sided;
  }

  const ModelFrame& model_;
  const Hierarchy& hierarchy_;
  const Sight& sight_;
  bool one_side_;
  std::vector<Vec3f> morphed_;
};

}  // namespace

std::optional<SurfacePoint> surface_at(const Frame& frame, double x, double y) {
  if (!(x >= 0 && y >= 0 && x < frame.size.width && y < frame.size.height)) return {};
  std::optional<SurfacePoint> nearest;
  for (std::size_t m = 0; m < frame.models.size(); ++m) {
    const ModelFrame& model = frame.models[m];
    if (!model.selection) continue;
    const Unprojection unproject(model.view_projection, frame.size);
    const Vec3d near = unproject(x, y, 0);
    const Sight sight{near, unproject(x, y, 1) - near};
    if (is_finite(sight.from) && is_finite(sight.along)) DrawnModel(model, sight).meet(m, nearest);
  }
  return nearest;
}

SurfaceFacts facts_of(const SurfacePoint& surface, const SceneView& scene, const Camera& camera) {
  const Similarity& placement = scene.placement(surface.model);
  const Hierarchy& hierarchy = scene.hierarchy(surface.model);
  const Cell& cell = hierarchy.cells[surface.cell];
  SurfaceFacts facts{.model = scene.scene().models[surface.model].name,
                     .cell = surface.cell,
                     .level = surface.level,
                     .morphing = surface.morphing,
                     .triangles = cell.triangles.size(),
                     .error = double{cell.error} * placement.scale,
                     .measured = hierarchy.provenance.measured_errors,
                     .point = placement(surface.point)};
  const Vec3d forward = camera.target - camera.position;
  const double depth = dot(facts.point - camera.position, forward) / length(forward);
  facts.error_pixels = facts.error / depth * scene.frame().size.height / (2 * std::tan(0.5 * camera.vertical_fov));
  return facts;
}

}  // namespace lodestone::viewer
