#include "render/lod/limits.h"

#include <algorithm>
#include <utility>

#include "core/hierarchy/model/distance_metric.h"

namespace lodestone {
namespace {

// Largest and smallest distance of a point of `box` from `target`. Axis by axis, as every norm here is monotone in
// each.
float farthest_from(DistanceMetric metric, const Box3f& box, const Box3f& target) {
  const auto far = [](float lo, float hi, float target_lo, float target_hi) {
    return std::max(std::max(target_lo - lo, hi - target_hi), 0.0f);
  };
  return norm(metric, far(box.lo.x, box.hi.x, target.lo.x, target.hi.x),
              far(box.lo.y, box.hi.y, target.lo.y, target.hi.y), far(box.lo.z, box.hi.z, target.lo.z, target.hi.z));
}
float nearest_to(DistanceMetric metric, const Box3f& box, const Box3f& target) {
  const auto apart = [](float lo, float hi, float target_lo, float target_hi) {
    return std::max(std::max(target_lo - hi, lo - target_hi), 0.0f);
  };
  return norm(metric, apart(box.lo.x, box.hi.x, target.lo.x, target.hi.x),
              apart(box.lo.y, box.hi.y, target.lo.y, target.hi.y), apart(box.lo.z, box.hi.z, target.lo.z, target.hi.z));
}

}  // namespace

float limited_distance(DistanceMetric metric, Vec3f viewpoint, Vec3f p, DetailLimits limits) {
  float d = distance(metric, viewpoint, p);
  for (const DetailLimit& limit : limits) d = std::max(d, limit.radius - distance(metric, p, limit.box));
  return d;
}

float limited_distance(DistanceMetric metric, Vec3f viewpoint, const Box3f& box, DetailLimits limits) {
  float d = distance(metric, viewpoint, box);
  for (const DetailLimit& limit : limits) d = std::max(d, limit.radius - farthest_from(metric, box, limit.box));
  return d;
}

float limited_farthest_distance(DistanceMetric metric, Vec3f viewpoint, const Box3f& box, DetailLimits limits) {
  float d = farthest_corner_distance(metric, viewpoint, box);
  for (const DetailLimit& limit : limits) d = std::max(d, limit.radius - nearest_to(metric, box, limit.box));
  return d;
}

void limits_near(DistanceMetric metric, Vec3f viewpoint, const Box3f& box, DetailLimits limits,
                 std::vector<DetailLimit>& out) {
  const float nearest = distance(metric, viewpoint, box);
  for (const DetailLimit& limit : limits) {
    const float apart = nearest_to(metric, box, limit.box);
    // The guard is several times what rounding does to the three terms.
    const float guard = rounding_guard * (limit.radius + apart + nearest);
    if (limit.radius - apart > nearest - guard) out.push_back(limit);
  }
}

class LimitTracker::Update {
 public:
  Update(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, const ChildStateOf& child_state, float rate,
         LimitTracker& tracker)
      : hierarchy_(hierarchy),
        radii_(radii),
        viewpoint_(viewpoint),
        child_state_(child_state),
        rate_(rate),
        least_(rate * near_band(radii)),
        tracker_(tracker) {}

  void visit(CellId id, std::size_t level) {
    if (static_cast<int>(level) == hierarchy_.finest()) return;
    const Cell& cell = hierarchy_.cells[id];
    const float full = radii_.of(id, level);
    const float d = distance(radii_.metric, viewpoint_, cell.bounds);
    if (d >= full) return;  // drawn as it is; no limit up to `full` would change d' anywhere
    const ChildState state = child_state_(id);
    const float radius = next_radius(id, state, d, full);
    if (radius > d) {
      tracker_.limits_.push_back({cell.bounds, radius});
      tracker_.limited_.push_back(id);
    }
    if (state == ChildState::missing) tracker_.missing_.push_back(id);
    if (radius >= full) return;  // never refined
    for (CellId k = cell.first_child; k < cell.end_child(); ++k) visit(k, level + 1);
  }

 private:
  // A distance of which a share changes no vertex by more than its share of the way. No band begins below that of the
  // finest level; where that begins at 0, a part of its width serves, or limits would sink for ever. Bands of radii by
  // cell may begin at 0 anywhere, and all have a width.
  [[nodiscard]] static float near_band(const Radii& radii) {
    const std::size_t levels = radii.select.size();
    if (!radii.by_cell.empty()) return radii.band_end.back() - radii.band_begin.back();
    return std::max(radii.band_begin.back(), levels > 1 ? radii.select[levels - 2] / 16 : 0);
  }

  // A limit of d or less changes nothing: that is where rising ones start and sinking ones end.
  [[nodiscard]] float next_radius(CellId id, ChildState state, float d, float full) const {
    const float excess = std::max(std::min(tracker_.radius_[id], full) - d, 0.0f);
    switch (state) {
      case ChildState::missing:
        return full;
      case ChildState::unwanted:
        return rate_ < 1 ? std::min(d + std::max(excess / (1 - rate_), least_), full) : full;
      case ChildState::there:
        return excess * (1 - rate_) > least_ || rate_ == 0 ? d + excess * (1 - rate_) : d;
    }
    return full;
  }

  const Hierarchy& hierarchy_;
  const Radii& radii_;
  Vec3f viewpoint_;
  const ChildStateOf& child_state_;
  float rate_, least_;
  LimitTracker& tracker_;
};

bool LimitTracker::update(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint,
                          const ChildStateOf& child_state, float rate) {
  const std::vector<DetailLimit> limits_before = std::exchange(limits_, {});
  const std::vector<CellId> limited_before = std::exchange(limited_, {});
  missing_.clear();
  radius_.resize(hierarchy.cells.size());
  Update update(hierarchy, radii, viewpoint, child_state, rate, *this);
  if (!hierarchy.cells.empty()) update.visit(CellId(0), 0);
  for (const CellId cell : limited_before) radius_[cell] = 0;
  for (std::size_t k = 0; k < limited_.size(); ++k) radius_[limited_[k]] = limits_[k].radius;
  return limited_ != limited_before || limits_ != limits_before;
}

}  // namespace lodestone
