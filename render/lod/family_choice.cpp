#include "render/lod/family_choice.h"

#include <algorithm>
#include <optional>

#include "core/hierarchy/model/distance_metric.h"
#include "render/lod/limits.h"

namespace lodestone {
namespace {

struct Candidate {
  float excess = 0;
  CellId parent;
  std::size_t level = 0;
};

// Exact but for the sums, so that the page orders cells alike.
double square_distance(Vec3f p, const Box3f& box) {
  double sum = 0;
  for (float Vec3f::*axis : {&Vec3f::x, &Vec3f::y, &Vec3f::z}) {
    const double apart = std::max({box.lo.*axis - p.*axis, p.*axis - box.hi.*axis, 0.0f});
    sum += apart * apart;
  }
  return sum;
}

struct ByExcess {
  const Hierarchy& hierarchy;
  Vec3f viewpoint;
  bool operator()(const Candidate& a, const Candidate& b) const {
    if (a.excess != b.excess) return a.excess > b.excess;
    const double near_a = square_distance(viewpoint, hierarchy.cells[a.parent].bounds);
    const double near_b = square_distance(viewpoint, hierarchy.cells[b.parent].bounds);
    return near_a != near_b ? near_a < near_b : a.parent < b.parent;
  }
};

class Choice {
 public:
  Choice(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, const FamilyBudget& budget)
      : hierarchy_(hierarchy), radii_(radii), viewpoint_(viewpoint), budget_(budget), room_(budget.room) {}

  // All that are needed; nothing when they do not fit. The order of the levels saves sorting.
  std::optional<std::vector<CellId>> choose_all() {
    add_candidate(CellId(0), 0);
    for (std::size_t i = 0; i < candidates_.size(); ++i)
      if (!take(candidates_[i])) return std::nullopt;
    return std::move(chosen_);
  }

  std::vector<CellId> choose_by_excess() {
    std::vector<DetailLimit> limits;
    // Heaps have the largest on top.
    const auto later = [by_excess = ByExcess{hierarchy_, viewpoint_}](const Candidate& a, const Candidate& b) {
      return by_excess(b, a);
    };
    add_candidate(CellId(0), 0);
    while (!candidates_.empty() && limits.size() < passed_over_at_most) {
      std::pop_heap(candidates_.begin(), candidates_.end(), later);
      const Candidate next = candidates_.back();
      candidates_.pop_back();
      const Box3f& box = hierarchy_.cells[next.parent].bounds;
      const float radius = radii_.of(next.parent, next.level);
      if (!limits.empty() && limited_distance(radii_.metric, viewpoint_, box, limits) >= radius) continue;
      const std::size_t children = candidates_.size();
      if (!take(next)) limits.push_back({box, radius});
      for (std::size_t i = children; i < candidates_.size(); ++i)
        std::push_heap(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(i) + 1, later);
    }
    return std::move(chosen_);
  }

 private:
  void add_candidate(CellId cell, std::size_t level) {
    if (static_cast<int>(level) == hierarchy_.finest()) return;
    const float radius = radii_.of(cell, level);
    const float d = distance(radii_.metric, viewpoint_, hierarchy_.cells[cell].bounds);
    if (d < radius) candidates_.push_back({radius - d, cell, level});
  }

  // False if there is no room for it.
  bool take(Candidate candidate) {
    const std::uint64_t bytes = budget_.bytes[candidate.parent];
    if (bytes > room_) return false;
    room_ -= bytes;
    chosen_.push_back(candidate.parent);
    const Cell& cell = hierarchy_.cells[candidate.parent];
    for (CellId k = cell.first_child; k < cell.end_child(); ++k) add_candidate(k, candidate.level + 1);
    return true;
  }

  const Hierarchy& hierarchy_;
  const Radii& radii_;
  Vec3f viewpoint_;
  const FamilyBudget& budget_;
  std::uint64_t room_;
  std::vector<Candidate> candidates_;
  std::vector<CellId> chosen_;
};

}  // namespace

float excess(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, CellId cell) {
  return radii.of(cell, static_cast<std::size_t>(hierarchy.level_of(cell))) -
         distance(radii.metric, viewpoint, hierarchy.cells[cell].bounds);
}

std::vector<CellId> sorted_by_excess(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint,
                                     std::span<const CellId> cells) {
  std::vector<Candidate> candidates;
  for (const CellId c : cells) candidates.push_back({excess(hierarchy, radii, viewpoint, c), c});
  std::sort(candidates.begin(), candidates.end(), ByExcess{hierarchy, viewpoint});
  std::vector<CellId> sorted;
  for (const Candidate& c : candidates) sorted.push_back(c.parent);
  return sorted;
}

std::vector<CellId> choose_families(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint,
                                    const FamilyBudget& budget) {
  if (auto all = Choice(hierarchy, radii, viewpoint, budget).choose_all()) return std::move(*all);
  return Choice(hierarchy, radii, viewpoint, budget).choose_by_excess();
}

}  // namespace lodestone
