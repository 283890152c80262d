#include "render/lod/verify_radii.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/hierarchy/model/find_signatures.h"
#include "parallel/hierarchy/verify_threads.h"

namespace lodestone {
namespace {

// From the corners: the distance from a box is convex, so it is largest at one of them.
double farthest(DistanceMetric metric, const Box3f& inner, const Box3f& outer) {
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const auto beyond = [](double v, double lo, double hi) { return std::max({lo - v, v - hi, 0.0}); };
    const Vec3d apart{beyond(corner & 1 ? inner.hi.x : inner.lo.x, outer.lo.x, outer.hi.x),
                      beyond(corner & 2 ? inner.hi.y : inner.lo.y, outer.lo.y, outer.hi.y),
                      beyond(corner & 4 ? inner.hi.z : inner.lo.z, outer.lo.z, outer.hi.z)};
    largest =
        std::max(largest, metric == DistanceMetric::chebyshev ? std::max({apart.x, apart.y, apart.z}) : length(apart));
  }
  return largest;
}

class RadiiCheck {
 public:
  explicit RadiiCheck(const Hierarchy& hierarchy) : hierarchy_(hierarchy) {}

  void examine(const Radii& radii, const RadiiConfig& config) {
    for (int level = 1; level <= hierarchy_.finest(); ++level)
      for (std::uint32_t s = radii.signatures->first(level); s < radii.signatures->first(level + 1); ++s)
        examine(radii, config, level, radii.signatures->users(s), radii.signatures->error(s));
  }

  [[nodiscard]] VerifyCheck result() const {
    return {"radii", failures_ == 0,
            failures_ == 0 ? std::to_string(examined_) + " examined"
                           : first_ + " (" + std::to_string(failures_) + " of " + std::to_string(examined_) + ")"};
  }

 private:
  void examine(const Radii& radii, const RadiiConfig& config, int level, const Signatures::Users& users, float error) {
    const double half = std::tan(double{config.vertical_fov} / 2), aspect = config.aspect;
    const double pixels =
        config.image_height / (2 * half * config.pixel_error) * (1 + half * half * (1 + aspect * aspect));
    const double band = (double{config.beta} + 3 * double{config.delta}) * hierarchy_.cell_size(level);
    for (const CellId parent : users.parents) {
      const double radius = radii.by_cell[parent];
      for (const CellId cell : users.cells) {
        const double beyond = farthest(config.metric, hierarchy_.cells[cell].bounds, hierarchy_.cells[parent].bounds);
        require(radius >= radii.by_cell[cell] + beyond + band, parent, "too small beside that of cell ", cell);
      }
      require(radius >= hierarchy_.cells[parent].error * pixels * (1 - 1e-6), parent,
              "too small for its error: ", parent);
    }
    for (const CellId cell : users.cells)
      require(radii.by_cell[cell] >= 0, cell,
              "below 0, so that no viewpoint reaches the places of its vertices: ", cell);
    if (level == hierarchy_.finest()) return;
    for (const CellId cell : users.cells)
      require(radii.by_cell[cell] >= error * pixels * (1 - 1e-6), cell, "too small for an error it shares with cell ",
              users.cells.front());
  }

  void require(bool holds, CellId cell, const char* fault, CellId other) {
    ++examined_;
    if (!holds && failures_++ == 0)
      first_ = "the radius of cell " + std::to_string(cell) + " is " + fault + std::to_string(other);
  }

  const Hierarchy& hierarchy_;
  std::uint64_t examined_ = 0, failures_ = 0;
  std::string first_;
};

}  // namespace

VerifyCheck verify_radii(const Hierarchy& hierarchy, const Radii& radii, const RadiiConfig& config) {
  RadiiCheck check(hierarchy);
  check.examine(radii, config);
  return check.result();
}

VerifyCheck verify_radii(const Hierarchy& hierarchy) {
  const auto signatures = signatures_of(hierarchy);
  RadiiCheck check(hierarchy);
  RadiiConfig config;
  config.rule = RadiiRule::adaptive;
  for (const DistanceMetric metric : {DistanceMetric::euclidean, DistanceMetric::chebyshev})
    for (const float tolerance : {0.1f, 0.5f, 1.0f, 2.0f, 4.0f, 16.0f, 64.0f}) {
      config.metric = metric;
      config.pixel_error = tolerance;
      check.examine(make_radii(hierarchy, config, signatures), config);
    }
  return check.result();
}

VerifyReport verify_with_radii(const Hierarchy& hierarchy, const Scheduler& scheduler, const IndexedMesh* input,
                               const VerifyProgress& progress) {
  VerifyReport report = verify_hierarchy(hierarchy, scheduler, input, progress);
  if (report.find("structure")->passed) report.checks.push_back(verify_radii(hierarchy));
  return report;
}

}  // namespace lodestone
