#include "render/reconstruct/views/choose_views.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/spatial/triangle_bvh.h"
#include "render/position_map/rasterize_map.h"
#include "render/position_map/resolve_pixel.h"
#include "render/reconstruct/views/coarse_copy.h"

namespace lodestone {
namespace {

// Directions, spread over the sphere, that come before all of the candidates: they leave few samples for those.
constexpr int first_candidates = 64;
// Triangles for a pixel of a face, from which on a coarse copy of the mesh decides what is seen. Its cells are as large
// as a pixel: there are at most so many as those of the faces that the surface meets, whatever the mesh.
constexpr double dense = 16;
// A ray is not blocked by the triangle that it starts on, even if that exists twice; nor by the coarse copy of it.
constexpr double room_of_triangle = 1e-5, room_in_cells = 1.5;

// Samples spread over the area: every sample represents the same share of it.
std::vector<SurfacePoint> sample_surface(const IndexedMesh& mesh, std::uint64_t count) {
  std::vector<double> up_to;
  up_to.reserve(mesh.triangles.size());
  double area = 0;
  const auto corner = [&](const Triangle& t, std::size_t k) { return to_double(mesh.positions[t.v[k]]); };
  for (const Triangle& t : mesh.triangles) {
    area += length(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
    up_to.push_back(area);
  }
  std::vector<SurfacePoint> points;
  if (!(area > 0)) return points;
  for (std::uint64_t k = 0; k < count; ++k) {
    const double wanted = (static_cast<double>(k) + 0.5) / static_cast<double>(count) * area;
    const auto t = static_cast<std::size_t>(std::upper_bound(up_to.begin(), up_to.end(), wanted) - up_to.begin());
    if (t == mesh.triangles.size()) break;
    // A point of the R2 sequence, folded into the triangle.
    double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(k), 1.0),
           v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(k), 1.0);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Triangle& triangle = mesh.triangles[t];
    const Vec3d a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
    points.push_back({a + u * (b - a) + v * (c - a), unit_normal_of(a, b, c), static_cast<std::uint32_t>(t)});
  }
  return points;
}

// How well a map sees a point: the cosine between surface and view; 0 when it does not. `own`: the point's triangle in
// the mesh of the map.
float cosine_in(const PositionMap& map, const SurfacePoint& sample, std::uint32_t own) {
  const WindowPoint w = to_window(map.view, sample.point);
  if (!(w.x >= 0) || !(w.y >= 0) || !(w.x < map.view.width) || !(w.y < map.view.height)) return 0;
  const std::size_t i =
      static_cast<std::size_t>(w.y) * static_cast<std::size_t>(map.view.width) + static_cast<std::size_t>(w.x);
  if (!map.sees(i)) return 0;
  const auto cosine = static_cast<float>(std::abs(dot(to_double(sample.normal), map.view.forward)));
  const double behind = w.depth - double{map.depth[i]};
  const bool seen = map.triangle[i] == own || behind * std::max(double{cosine}, 0.1) < 0.7 * map.view.pixel;
  return seen ? cosine : 0;
}

using Cosines = std::vector<float>;  // one per sample

// Samples that a direction sees, and how steeply.
struct Sight {
  std::span<const std::uint32_t> samples;
  std::span<const float> cosine;  // of each of them
};

// Candidate directions in stages: each looks only at the samples that no stage before it sees well.
class CandidateSights {
 public:
  CandidateSights(const IndexedMesh& mesh, std::span<const SurfacePoint> samples, const ViewChoice& choice)
      : samples_(samples), well_(choice.least_cosine), resolution_(choice.resolution), best_(samples.size()) {
    const double pixel = 1.0 / choice.resolution;
    if (static_cast<double>(mesh.triangles.size()) * pixel * pixel > dense)
      copy_ = coarse_copy(mesh, pixel), room_ = room_in_cells * pixel;
    mesh_ = copy_ ? &*copy_ : &mesh;
  }
  CandidateSights(const CandidateSights&) = delete;
  CandidateSights& operator=(const CandidateSights&) = delete;

  // The six faces, by maps.
  void add_maps(Scheduler& scheduler) {
    Box3f box;
    for (const Vec3f& p : mesh_->positions) box.extend(p);
    Stage& stage = begin(face_directions());
    for (std::size_t k = 0; k < stage.cosine.size(); ++k) {
      const PositionMap map = rasterize_map(*mesh_, orthographic_view(box, face_directions()[k], 1.0 / resolution_),
                                            {.surface = false}, scheduler);
      scheduler.for_chunks(stage.samples.size(), 4096, [&](ChunkRange range) {
        for (std::size_t s = range.begin; s < range.end; ++s)
          stage.cosine[k][s] =
              cosine_in(map, samples_[stage.samples[s]], copy_ ? no_triangle : samples_[stage.samples[s]].triangle);
      });
    }
    finish(stage);
  }

  // By rays from the samples; the cosine is 0 where something is in between.
  void add_rays(const std::vector<Vec3d>& directions, Scheduler& scheduler) {
    Stage& stage = begin(directions);
    if (stage.samples.empty() || directions.empty()) return;
    if (!bvh_) make_tree();
    scheduler.for_chunks(stage.samples.size(), 16, [&](ChunkRange range) {
      for (std::size_t s = range.begin; s < range.end; ++s) {
        const SurfacePoint& sample = samples_[stage.samples[s]];
        for (std::size_t k = 0; k < directions.size(); ++k)
          if (std::isinf(bvh_->meet(sample.point, -1 * directions[k], room_, TriangleBvh::Hit::any_will_do)))
            stage.cosine[k][s] = static_cast<float>(std::abs(dot(to_double(sample.normal), directions[k])));
      }
    });
    finish(stage);
  }

  [[nodiscard]] const std::vector<Vec3d>& directions() const { return directions_; }
  // One for each direction, valid as long as this object.
  [[nodiscard]] std::vector<Sight> sights() const {
    std::vector<Sight> sights;
    for (const Stage& stage : stages_)
      for (const Cosines& cosine : stage.cosine) sights.push_back({stage.samples, cosine});
    return sights;
  }

 private:
  struct Stage {
    std::vector<std::uint32_t> samples;
    std::vector<Cosines> cosine;  // of each direction
  };

  Stage& begin(const std::vector<Vec3d>& directions) {
    directions_.insert(directions_.end(), directions.begin(), directions.end());
    Stage& stage = stages_.emplace_back();
    for (std::uint32_t s = 0; s < samples_.size(); ++s)
      if (best_[s] < well_) stage.samples.push_back(s);
    stage.cosine.assign(directions.size(), Cosines(stage.samples.size(), 0.0f));
    return stage;
  }
  void finish(const Stage& stage) {
    for (const Cosines& cosine : stage.cosine)
      for (std::size_t k = 0; k < cosine.size(); ++k)
        best_[stage.samples[k]] = std::max(best_[stage.samples[k]], cosine[k]);
  }
  void make_tree() {
    std::vector<Vec3d> positions;
    positions.reserve(mesh_->positions.size());
    for (const Vec3f& p : mesh_->positions) positions.push_back(to_double(p));
    bvh_.emplace(positions, mesh_->triangles);
  }

  std::span<const SurfacePoint> samples_;
  float well_;
  int resolution_;
  std::optional<IndexedMesh> copy_;    // of a dense mesh
  const IndexedMesh* mesh_ = nullptr;  // that is looked at: the copy or the samples' own
  double room_ = room_of_triangle;     // the way that rays go before something can be in between
  std::vector<float> best_;            // cosine of each sample in any direction so far
  std::vector<Vec3d> directions_;
  std::deque<Stage> stages_;
  std::optional<TriangleBvh> bvh_;
};

// Takes views until enough is covered. A candidate is known to see some of the samples, and how steeply.
class GreedyChoice {
 public:
  GreedyChoice(const ViewChoice& choice, std::vector<Sight> sights, std::size_t samples, Scheduler& scheduler)
      : choice_(choice), sights_(std::move(sights)), scheduler_(scheduler), quality_(samples), best_(samples) {
    for (const Sight& sight : sights_)
      for (std::size_t k = 0; k < sight.samples.size(); ++k) {
        float& best = best_[sight.samples[k]];
        best = std::max(best, sight.cosine[k]);
      }
    for (const float cosine : best_) attainable_ += quality_of(cosine);
  }

  std::vector<std::size_t> run() {
    if (choice_.least >= 6)
      for (std::size_t k = 0; k < 6; ++k) take(k);
    while (static_cast<int>(taken_.size()) < choice_.most && wants_more()) {
      const std::vector<double> gains = gain_of_each();
      const auto best = std::max_element(gains.begin(), gains.end());
      const bool worth = *best >= choice_.least_gain * static_cast<double>(quality_.size());
      if (!(*best > 0) || (!worth && static_cast<int>(taken_.size()) >= choice_.least)) break;
      take(static_cast<std::size_t>(best - gains.begin()));
    }
    return taken_;
  }

  [[nodiscard]] std::span<const float> best() const { return best_; }
  [[nodiscard]] std::size_t covered() const {
    return static_cast<std::size_t>(std::count(quality_.begin(), quality_.end(), 1.0f));
  }

 private:
  [[nodiscard]] float quality_of(float cosine) const { return std::min(cosine / choice_.least_cosine, 1.0f); }
  [[nodiscard]] bool wants_more() const {
    const double sum = std::accumulate(quality_.begin(), quality_.end(), 0.0);
    return static_cast<int>(taken_.size()) < choice_.least || sum < choice_.coverage * attainable_;
  }

  [[nodiscard]] std::vector<double> gain_of_each() const {
    std::vector<double> gains(sights_.size(), 0);
    scheduler_.for_chunks(sights_.size(), 4, [&](ChunkRange range) {
      for (std::size_t c = range.begin; c < range.end; ++c)
        for (std::size_t k = 0; k < sights_[c].samples.size(); ++k)
          gains[c] += std::max(quality_of(sights_[c].cosine[k]) - quality_[sights_[c].samples[k]], 0.0f);
    });
    return gains;
  }

  void take(std::size_t candidate) {
    taken_.push_back(candidate);
    const Sight& sight = sights_[candidate];
    for (std::size_t k = 0; k < sight.samples.size(); ++k) {
      float& quality = quality_[sight.samples[k]];
      quality = std::max(quality, quality_of(sight.cosine[k]));
    }
  }

  const ViewChoice& choice_;
  std::vector<Sight> sights_;
  Scheduler& scheduler_;
  std::vector<std::size_t> taken_;
  std::vector<float> quality_, best_;  // of each sample: by the views taken so far, in [0, 1]; cosine in any view
  double attainable_ = 0;
};

}  // namespace

std::vector<Vec3d> face_directions() { return {{0, 0, -1}, {0, 0, 1}, {0, -1, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0}}; }

std::vector<Vec3d> sphere_directions(int count) {
  std::vector<Vec3d> directions;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int k = 0; k < count; ++k) {
    const double z = 1 - (2 * k + 1.0) / count, r = std::sqrt(1 - z * z);
    directions.push_back({r * std::cos(golden * k), r * std::sin(golden * k), z});
  }
  return directions;
}

std::vector<Vec3d> even_directions(int count) {
  if (count < 6) return sphere_directions(count);
  std::vector<Vec3d> directions = face_directions();
  const std::vector<Vec3d> others = sphere_directions(count - 6);
  directions.insert(directions.end(), others.begin(), others.end());
  return directions;
}

ChosenViews choose_views(const IndexedMesh& mesh, const ViewChoice& choice, Scheduler& scheduler) {
  const std::vector<SurfacePoint> samples = sample_surface(mesh, choice.samples);
  CandidateSights candidates(mesh, samples, choice);
  candidates.add_maps(scheduler);
  if (choice.candidates > first_candidates) candidates.add_rays(sphere_directions(first_candidates), scheduler);
  candidates.add_rays(sphere_directions(choice.candidates), scheduler);
  GreedyChoice greedy(choice, candidates.sights(), samples.size(), scheduler);

  const double whole = std::max<double>(1, static_cast<double>(samples.size()));
  ChosenViews chosen;
  for (const std::size_t k : greedy.run()) chosen.directions.push_back(candidates.directions()[k]);
  std::size_t coverable = 0;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    if (greedy.best()[s] > 0) chosen.visible_points.push_back(samples[s].point);
    coverable += greedy.best()[s] >= choice.least_cosine;
  }
  chosen.samples = samples;
  chosen.visible = static_cast<double>(chosen.visible_points.size()) / whole;
  chosen.coverable = static_cast<double>(coverable) / whole;
  chosen.covered = static_cast<double>(greedy.covered()) / whole;
  return chosen;
}

}  // namespace lodestone
