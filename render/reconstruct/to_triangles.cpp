// A reconstruction of about a given number of triangles: the resolution is searched for.
#include <algorithm>
#include <cmath>
#include <limits>

#include "render/reconstruct/from_maps.h"
#include "render/reconstruct/sampling.h"

namespace lodestone {
namespace {

// Surfaces of less, in a unit cube, are wires and specks: pictures that give them as many triangles are too large.
constexpr double least_area = 2e-3;
// Limits of the triangles sampled over those wanted, within which a mesh to be simplified is as fine as it should be.
constexpr double least_finer = 0.6, most_finer = 2.5;
constexpr double near_enough = 0.02;  // of the logarithm of triangles made over triangles wanted
constexpr int most_rounds = 4;

double area_of(const IndexedMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = to_double(mesh.positions[t.v[0]]), b = to_double(mesh.positions[t.v[1]]),
                c = to_double(mesh.positions[t.v[2]]);
    area += 0.5 * length(cross(b - a, c - a));
  }
  return area;
}

bool is_simplified(const ReconstructConfig& config) {
  return config.merge == MergeKind::shell || (config.merge == MergeKind::stitch && config.detail > 1);
}

// True if the surface is smaller than anything that is made of maps of a resolution, or taken over beside them
// (lost_parts.h): they need not be drawn.
bool is_invisible(double area, double resolution, ReconstructConfig config) {
  config.resolution = resolution;
  const double spacing = map_spacing(config);
  return area < 0.25 * spacing * spacing;
}

// The resolutions between which the wanted one lies. What is sampled grows by their square, but for surfaces of about a
// pixel's width, which appear at some resolution all at once.
class Bracket {
 public:
  explicit Bracket(double most) : most_(most) {}
  // After a resolution that samples `finer` times as much as is wanted.
  [[nodiscard]] double next(double resolution, double finer) {
    (finer < 1 ? coarse_ : fine_) = resolution;
    const double next = std::clamp(resolution / std::sqrt(finer), 2.0, most_);
    return next > coarse_ && next < fine_ ? next
           : std::isinf(fine_)            ? most_
                                          : std::sqrt(std::max(coarse_, 2.0) * fine_);
  }

 private:
  double most_, coarse_ = 0, fine_ = std::numeric_limits<double>::infinity();
};

// The distance of a trial from what is wanted.
struct Miss {
  double finer = 1;      // sampled over wanted
  double triangles = 0;  // logarithm of made over wanted, without its sign
};

Miss miss_of(const Reconstruction& tried, const ReconstructConfig& config, double wanted) {
  const auto made = static_cast<double>(std::max<std::size_t>(tried.mesh.triangles.size(), 1));
  const auto sampled = static_cast<double>(std::max<std::size_t>(tried.report.sampled_triangles, 1));
  const double detail = 1 / (config.resolution * tried.report.map_spacing);
  return {is_simplified(config) ? sampled / (wanted * excess_of(config, detail)) : made / wanted,
          std::abs(std::log(made / wanted))};
}

// A mesh to be simplified may be finer than necessary once it is there. If it is sampled as it should be, and has more
// than twice the triangles, it consists of parts that cannot be made of fewer.
bool is_good(const Miss& miss, bool simplified) {
  if (!simplified) return miss.triangles < near_enough;
  if (miss.finer <= least_finer) return false;
  return miss.triangles < near_enough || (miss.finer < most_finer && miss.triangles > std::log(2.0));
}

}  // namespace

Reconstruction reconstruct_to_triangles(const IndexedMesh& mesh, ReconstructConfig config, std::uint64_t triangles,
                                        Scheduler& scheduler) {
  const double area = area_of(mesh);
  const auto wanted = static_cast<double>(triangles);
  const bool simplified = is_simplified(config);
  if (simplified) config.triangles = triangles;
  // Two triangles a pixel, on surfaces that are tilted by a third on the average.
  const double finest = finest_resolution(config);
  config.resolution = std::clamp(std::sqrt(wanted * 1.25 / (2 * std::max(area, least_area))), 4.0, finest);
  // Scattered parts give fewer triangles than pixels promise, however fine these are.
  const double most = std::min(2 * config.resolution, finest);
  if (is_invisible(area, most, config)) return {};
  Bracket bracket(most);
  LastChoice last;
  Reconstruction best;
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round < most_rounds; ++round) {
    Reconstruction tried = reconstruct(mesh, config, last, scheduler);
    const Miss miss = miss_of(tried, config, wanted);
    const double distance = simplified ? std::abs(std::log(miss.finer)) : miss.triangles;
    if (distance < least) least = distance, best = std::move(tried);
    if (is_good(miss, simplified)) break;
    const double next = bracket.next(config.resolution, miss.finer);
    if (next == config.resolution) break;
    config.resolution = next;
  }
  return best;
}

}  // namespace lodestone
