#include "render/viewer/session/band_tint.h"

#include <vector>

#include "core/hierarchy/model/distance_metric.h"
#include "render/lod/limits.h"
#include "render/viewer/session/projection.h"

namespace lodestone::viewer {
namespace {

constexpr Vec3f begin_colour{40 / 255.0f, 110 / 255.0f, 1}, end_colour{1, 140 / 255.0f, 30 / 255.0f};
constexpr float share = 0.65f;  // of the band's colour

std::uint8_t mixed(std::uint8_t seen, float colour) {
  return static_cast<std::uint8_t>((1 - share) * static_cast<float>(seen) + share * 255 * colour + 0.5f);
}

// A model, and the way back from the picture to its space.
struct Placed {
  const MorphContext* morph;
  Unprojection unproject;
  Box3f bounds;  // grown by what vertices move
  Placed(const ModelFrame& model, ImageSize size) : morph(&model.morph), unproject(model.view_projection, size) {
    bounds = model.morph.hierarchy->cells.front().bounds;
    const float margin = model.morph.hierarchy->displacement_bound(1) + 1e-3f;  // and by rounding
    bounds.lo = bounds.lo - Vec3f{margin, margin, margin};
    bounds.hi = bounds.hi + Vec3f{margin, margin, margin};
  }
};

std::optional<float> lambda_at(const std::vector<Placed>& models, double x, double y, float depth) {
  for (const Placed& model : models) {
    const Vec3f p = to_float(model.unproject(x, y, depth));
    if (!model.bounds.contains(p)) continue;
    if (const auto lambda = band_lambda(*model.morph, p)) return lambda;
  }
  return {};
}

// Down to the drawn cells, as the selection goes.
std::optional<float> lambda_of_drawn(const MorphContext& morph, CellId id, std::size_t level, Vec3f p) {
  const Hierarchy& hierarchy = *morph.hierarchy;
  const Cell& cell = hierarchy.cells[id];
  const Radii& radii = *morph.radii;
  if (cell.positions.empty() || distance(DistanceMetric::chebyshev, p, cell.bounds) > 0) return {};
  const bool drawn = cell.child_count == 0 ||
                     limited_distance(radii.metric, morph.viewpoint, cell.bounds, morph.limits) >= radii.of(id, level);
  if (drawn) {
    const float lambda = vertex_lambda(morph, id, VertexId(0));
    return lambda > 0 && lambda < 1 ? std::optional(lambda) : std::nullopt;
  }
  for (CellId k = cell.first_child; k < cell.end_child(); ++k)
    if (const auto lambda = lambda_of_drawn(morph, k, level + 1, p)) return lambda;
  return {};
}

}  // namespace

std::optional<float> band_lambda(const MorphContext& morph, Vec3f p) {
  const Radii& radii = *morph.radii;
  if (!radii.by_cell.empty()) return lambda_of_drawn(morph, CellId(0), 0, p);
  const float d = limited_distance(radii.metric, morph.viewpoint, p, morph.limits);
  for (std::size_t l = 1; l < radii.band_begin.size(); ++l) {
    const float a = radii.band_begin[l], c = radii.band_end[l];
    if (d > a && d < c) return 1 - blend_share(morph.blend, (d - a) / (c - a));
  }
  return {};
}

Vec3f band_colour(float lambda) { return lambda * begin_colour + (1 - lambda) * end_colour; }

void tint_band(Image& image, const Frame& frame, Scheduler& scheduler) {
  std::vector<Placed> models;
  for (const ModelFrame& model : frame.models) models.emplace_back(model, image.size);
  const auto width = static_cast<std::size_t>(image.size.width), height = static_cast<std::size_t>(image.size.height);
  constexpr std::size_t rows = 16;
  scheduler.for_chunks(height, rows, [&](ChunkRange range) {
    for (std::size_t y = range.begin; y < range.end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t pixel = y * width + x;
        if (!(image.depth[pixel] < 1)) continue;
        const std::optional<float> lambda =
            lambda_at(models, static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, image.depth[pixel]);
        if (!lambda) continue;
        const Vec3f colour = band_colour(*lambda);
        std::uint8_t* rgb = &image.rgba[4 * pixel];
        rgb[0] = mixed(rgb[0], colour.x);
        rgb[1] = mixed(rgb[1], colour.y);
        rgb[2] = mixed(rgb[2], colour.z);
      }
  });
}

}  // namespace lodestone::viewer
