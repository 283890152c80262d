#include "render/reconstruct/views/inside_views.h"

#include <algorithm>
#include <cmath>

#include "core/spatial/triangle_bvh.h"
#include "render/position_map/map_view.h"
#include "render/reconstruct/views/choose_views.h"

namespace lodestone {
namespace {

constexpr int candidate_directions = 92;  // besides the faces
constexpr std::size_t most_samples = 4000;

// A direction sees a sample when it is cut off at a depth in (from, to).
struct Stretch {
  std::uint32_t sample = 0;
  double from = 0, to = 0;
  float quality = 0;  // in (0, 1], by how steeply the view meets the surface
};

struct Plane {
  double gain = 0, depth = 0;
};

// The depth that serves the largest sum of quality of the stretches; the first of equally good ones.
Plane best_plane(std::span<const Stretch> stretches, std::span<const float> quality) {
  struct End {
    double depth, change;
  };
  std::vector<End> ends;
  for (const Stretch& s : stretches) {
    const double gain = std::max(s.quality - quality[s.sample], 0.0f);
    if (gain > 0) ends.push_back({s.from, gain}), ends.push_back({s.to, -gain});
  }
  // Stretches that end where another begins do not overlap.
  std::sort(ends.begin(), ends.end(),
            [](const End& a, const End& b) { return a.depth != b.depth ? a.depth < b.depth : a.change < b.change; });
  Plane best;
  double sum = 0;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    sum += ends[k].change;
    if (sum > best.gain + 1e-9 && ends[k + 1].depth > ends[k].depth)
      best = {sum, 0.5 * (ends[k].depth + ends[k + 1].depth)};
  }
  return best;
}

class InsideChoice {
 public:
  InsideChoice(const IndexedMesh& mesh, const ViewChoice& choice, const std::function<MapView(Vec3d)>& view_along,
               Scheduler& scheduler)
      : mesh_(mesh), choice_(choice), scheduler_(scheduler) {
    for (const Vec3d& d : face_directions()) views_.push_back(view_along(d));
    for (const Vec3d& d : sphere_directions(candidate_directions)) views_.push_back(view_along(d));
  }

  std::vector<MapView> run(std::span<const SurfacePoint> missed, double least_gain) {
    find_stretches(missed);
    std::vector<float> quality(missed.size(), 0.0f);
    std::vector<MapView> taken;
    while (static_cast<int>(taken.size()) < choice_.inside) {
      std::vector<Plane> planes(views_.size());
      scheduler_.for_chunks(views_.size(), 4, [&](ChunkRange range) {
        for (std::size_t k = range.begin; k < range.end; ++k) planes[k] = best_plane(stretches_[k], quality);
      });
      const auto best = std::max_element(planes.begin(), planes.end(),
                                         [](const Plane& a, const Plane& b) { return a.gain < b.gain; });
      if (!(best->gain >= least_gain)) break;
      const auto k = static_cast<std::size_t>(best - planes.begin());
      taken.push_back(views_[k]);
      taken.back().nearest = best->depth;
      for (const Stretch& s : stretches_[k])
        if (s.from < best->depth && best->depth < s.to) quality[s.sample] = std::max(quality[s.sample], s.quality);
    }
    return taken;
  }

 private:
  void find_stretches(std::span<const SurfacePoint> missed) {
    std::vector<Vec3d> positions;
    positions.reserve(mesh_.positions.size());
    for (const Vec3f& p : mesh_.positions) positions.push_back(to_double(p));
    const TriangleBvh bvh(positions, mesh_.triangles);
    stretches_.resize(views_.size());
    scheduler_.for_chunks(views_.size(), 1, [&](ChunkRange range) {
      const MapView& view = views_[range.index];
      for (std::uint32_t s = 0; s < missed.size(); ++s) {
        const double facing = -dot(to_double(missed[s].normal), view.forward);
        // A surface seen from behind obstructs the model that it belongs to.
        const float quality = std::min(static_cast<float>(facing) / choice_.least_cosine, 1.0f);
        if (!(quality > 0.3f)) continue;
        const double depth = view.depth(missed[s].point), room = 0.5 * view.pixel;
        const double free = bvh.meet(missed[s].point, -1 * view.forward, 1e-5);
        const double from = std::isinf(free) ? 0.0 : depth - free + room, to = depth - 2 * room;
        if (from < to) stretches_[range.index].push_back({s, from, to, quality});
      }
    });
  }

  const IndexedMesh& mesh_;
  const ViewChoice& choice_;
  Scheduler& scheduler_;
  std::vector<MapView> views_;                   // the candidates
  std::vector<std::vector<Stretch>> stretches_;  // of each of them
};

}  // namespace

bool holds_sample(const PositionMap& map, const SurfacePoint& sample) {
  const WindowPoint w = to_window(map.view, sample.point);
  const double fx = w.x - 0.5, fy = w.y - 0.5;
  if (!(fx >= 0) || !(fy >= 0) || fx >= map.view.width - 1 || fy >= map.view.height - 1) return false;
  const auto width = static_cast<std::size_t>(map.view.width);
  const std::size_t p = static_cast<std::size_t>(fy) * width + static_cast<std::size_t>(fx);
  const auto h = static_cast<float>(map.view.spacing(w.depth));
  const Vec3f point = to_float(sample.point);
  for (const std::size_t i : {p, p + 1, p + width, p + width + 1}) {
    if (!map.sees(i) || !(dot(map.normal[i], sample.normal) > 0.3f)) continue;
    const Vec3f away = map.position[i] - point;
    if (std::abs(dot(away, sample.normal)) < 0.7f * h && dot(away, away) < 9 * h * h) return true;
  }
  return false;
}

std::vector<MapView> choose_inside_views(const IndexedMesh& mesh, std::span<const SurfacePoint> samples,
                                         std::span<const PositionMap> maps, const ViewChoice& choice,
                                         const std::function<MapView(Vec3d)>& view_along, Scheduler& scheduler) {
  if (choice.inside < 1 || samples.empty()) return {};
  std::vector<std::uint8_t> held(samples.size(), 0);
  scheduler.for_chunks(samples.size(), 1024, [&](ChunkRange range) {
    for (std::size_t s = range.begin; s < range.end; ++s)
      held[s] =
          std::any_of(maps.begin(), maps.end(), [&](const PositionMap& m) { return holds_sample(m, samples[s]); });
  });
  std::vector<SurfacePoint> missed;
  for (std::size_t s = 0; s < samples.size(); ++s)
    if (!held[s]) missed.push_back(samples[s]);
  const double least_gain = choice.least_gain * static_cast<double>(samples.size());
  if (static_cast<double>(missed.size()) < least_gain) return {};
  if (missed.size() > most_samples) {  // evenly: each then represents more of the surface
    const std::size_t all = missed.size();
    for (std::size_t k = 0; k < most_samples; ++k) missed[k] = missed[k * all / most_samples];
    missed.resize(most_samples);
  }
  return InsideChoice(mesh, choice, view_along, scheduler).run(missed, least_gain);
}

}  // namespace lodestone
