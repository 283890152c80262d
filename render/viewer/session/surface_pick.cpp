// Triangles are met as by moeller1997, in double.
#include "render/viewer/session/surface_pick.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/hierarchy/model/material_of.h"
#include "render/camera/placement.h"
#include "render/effects/cut_face.h"
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

// The point at which the line of the sight meets the plane of a triangle.
struct Crossing {
  double way = 0;
  CornerShares at;
  bool front = false;  // the triangle turns anticlockwise as seen from the eye
  [[nodiscard]] bool inside() const { return at.b >= 0 && at.c >= 0 && at.b + at.c <= 1; }
};
std::optional<Crossing> crossing(const Sight& sight, const std::array<Vec3f, 3>& corners) {
  const auto& [a, b, c] = corners;
  const Vec3d edge = to_double(b) - to_double(a), other = to_double(c) - to_double(a);
  const Vec3d across = cross(sight.along, other);
  const double determinant = dot(edge, across);
  if (determinant == 0) return {};
  const Vec3d apart = sight.from - to_double(a), over = cross(apart, edge);
  return Crossing{dot(other, over) / determinant,
                  {dot(apart, across) / determinant, dot(sight.along, over) / determinant},
                  determinant > 0};
}

// The surfaces that a pixel may show, up to the nearest opaque one.
class Layers {
 public:
  [[nodiscard]] double end() const { return end_; }
  void add(const SurfacePoint& point, float opacity) {
    if (opacity <= 0) return;
    layers_.push_back({point, opacity});
    if (opacity >= 1) end_ = point.way;
  }
  // The layer with the largest share of the pixel, the nearest of equal ones.
  [[nodiscard]] std::optional<SurfacePoint> most_seen() {
    std::ranges::stable_sort(layers_, {}, [](const Layer& layer) { return layer.point.way; });
    std::optional<SurfacePoint> most;
    float through = 1, largest = 0;
    for (const auto& [point, opacity] : layers_) {
      if (through * opacity > largest) {
        largest = through * opacity;
        most = point;
      }
      through *= 1 - opacity;
    }
    return most;
  }

 private:
  struct Layer {
    SurfacePoint point;
    float opacity = 1;
  };
  std::vector<Layer> layers_;
  double end_ = 1;
};

// A point of the picture, and those beside it.
struct PixelSights {
  Sight here, right, below;
  Sight off_edges;  // by a fraction of a pixel: edges that run through the middles of pixels are met once
};

// The drawn triangles of one model.
class DrawnModel {
 public:
  DrawnModel(const Frame& frame, const ModelFrame& model, const SurfaceAlpha& alpha, const PixelSights& sights)
      : frame_(frame),
        model_(model),
        alpha_(alpha),
        hierarchy_(*model.morph.hierarchy),
        sights_(sights),
        one_side_(effects::has_one_side(model)) {}

  void meet(Layers& layers) {
    for_each_cell(*model_.selection, sights_.here, layers, [&](const SelectedCell& selected) {
      for_each_crossing(sights_.here, selected, [&](std::uint32_t t, const Crossing& met) {
        if (met.way > layers.end() || (!met.front && one_side_ && is_one_sided(selected, t))) return;
        layers.add(point_of(sights_.here, selected, t, met.way), opacity(selected, t, met));
      });
    });
  }

  // Adds the cut, if the surface winds around the point at which the plane is met.
  void meet_cut(Layers& layers) {
    const Sight& sight = sights_.off_edges;
    const double way = -distance_from_clip(sight.from) / dot(to_double(model_.clip->n), sight.along);
    if (!(way >= 0 && way <= layers.end())) return;
    int winding = 0;
    std::optional<SurfacePoint> behind;
    for_each_cell(*model_.solid, sight, Layers{}, [&](const SelectedCell& selected) {
      for_each_crossing(sight, selected, [&](std::uint32_t t, const Crossing& met) {
        winding += met.front ? 1 : -1;
        if (!behind || met.way < behind->way) behind = point_of(sight, selected, t, met.way);
      });
    });
    if (winding == 0) return;
    behind->way = way;
    behind->point = sight.from + way * sight.along;
    behind->cut = true;
    layers.add(*behind, 1);
  }

 private:
  // Calls visit(selected) for the cells that the sight enters before the layers' end, the nearest ones first.
  template <class Visit>
  void for_each_cell(const Selection& selection, const Sight& sight, const Layers& layers, const Visit& visit) const {
    struct Candidate {
      double from;
      SelectedCell cell;
    };
    std::vector<Candidate> candidates;
    for (const SelectedCell& selected : selection.cells) {
      if (!selected.visible) continue;
      const Box3f box = drawn_bounds(hierarchy_, selected.cell, selected.level);
      if (const auto from = entry(sight, box, layers.end())) candidates.push_back({*from, selected});
    }
    std::ranges::stable_sort(candidates, {}, &Candidate::from);
    for (const auto& [from, selected] : candidates) {
      if (from > layers.end()) return;
      visit(selected);
    }
  }

  // Calls visit(triangle, crossing) for the triangles of a cell that the sight meets, and the plane keeps there.
  template <class Visit>
  void for_each_crossing(const Sight& sight, const SelectedCell& selected, const Visit& visit) {
    const Cell& cell = hierarchy_.cells[selected.cell];
    positions_ = cell.positions;
    if (is_morphing(selected)) {
      morphed_.resize(cell.positions.size());
      morph_cell(model_.morph, selected.cell, morphed_);
      positions_ = morphed_;
    }
    for (std::uint32_t t = 0; t < cell.triangles.size(); ++t) {
      const auto met = crossing(sight, corners_of(cell, t));
      if (!met || !met->inside() || met->way < 0 || met->way > 1) continue;
      if (model_.clip && distance_from_clip(sight.from + met->way * sight.along) < 0) continue;
      visit(t, *met);
    }
  }

  [[nodiscard]] float opacity(const SelectedCell& selected, std::uint32_t triangle, const Crossing& met) const {
    const Cell& cell = hierarchy_.cells[selected.cell];
    const auto beside = [&](const Sight& sight) {
      const auto there = crossing(sight, corners_of(cell, triangle));
      return there ? there->at : met.at;
    };
    return alpha_.opacity(frame_, model_,
                          {selected.cell, selected.level, is_morphing(selected), cell.triangles[triangle].v, met.at,
                           beside(sights_.right), beside(sights_.below)});
  }

  [[nodiscard]] SurfacePoint point_of(const Sight& sight, const SelectedCell& selected, std::uint32_t triangle,
                                      double way) const {
    return {static_cast<std::size_t>(&model_ - frame_.models.data()),
            selected.cell,
            selected.level,
            is_morphing(selected),
            triangle,
            sight.from + way * sight.along,
            way};
  }
  [[nodiscard]] double distance_from_clip(Vec3d point) const {
    return dot(to_double(model_.clip->n), point) + double{model_.clip->d};
  }
  [[nodiscard]] std::array<Vec3f, 3> corners_of(const Cell& cell, std::uint32_t triangle) const {
    const auto& v = cell.triangles[triangle].v;
    return {positions_[v[0]], positions_[v[1]], positions_[v[2]]};
  }
  [[nodiscard]] bool is_morphing(const SelectedCell& selected) const {
    return selected.morphing && hierarchy_.cells[selected.cell].parent != no_cell &&
           model_.effects.contains(Effect::geomorph);
  }
  [[nodiscard]] bool is_one_sided(const SelectedCell& selected, std::uint32_t triangle) const {
    const Cell& cell = hierarchy_.cells[selected.cell];
    const std::uint32_t material = material_of(hierarchy_, cell, cell.triangles[triangle].v[0]);
    return material != no_material && !hierarchy_.materials[material].double_sided;
  }

  const Frame& frame_;
  const ModelFrame& model_;
  const SurfaceAlpha& alpha_;
  const Hierarchy& hierarchy_;
  const PixelSights& sights_;
  bool one_side_;
  std::vector<Vec3f> morphed_;
  std::span<const Vec3f> positions_;  // of the cell at hand, as they are drawn
};

}  // namespace

std::optional<SurfacePoint> surface_at(const Frame& frame, const SurfaceAlpha& alpha, double x, double y) {
  if (!(x >= 0 && y >= 0 && x < frame.size.width && y < frame.size.height)) return {};
  const std::vector<effects::CutFace> cuts = effects::cut_faces(frame);
  Layers layers;
  for (const ModelFrame& model : frame.models) {
    if (!model.selection) continue;
    const Unprojection unproject(model.view_projection, frame.size);
    const auto sight_at = [&](double at_x, double at_y) {
      const Vec3d near = unproject(at_x, at_y, 0);
      return Sight{near, unproject(at_x, at_y, 1) - near};
    };
    const PixelSights sights{sight_at(x, y), sight_at(x + 1, y), sight_at(x, y + 1), sight_at(x + 1.7e-4, y + 1.1e-4)};
    if (!is_finite(sights.here.from) || !is_finite(sights.here.along)) continue;
    DrawnModel drawn(frame, model, alpha, sights);
    if (std::ranges::find(cuts, &model, &effects::CutFace::model) != cuts.end()) drawn.meet_cut(layers);
    drawn.meet(layers);
  }
  return layers.most_seen();
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
