#include "render/lod/residency.h"

#include <algorithm>
#include <utility>

#include "render/lod/family_choice.h"
#include "render/lod/limits.h"

namespace lodestone {

Residency::Residency(const Hierarchy& tables, std::vector<std::uint64_t> family_bytes, std::uint64_t root_bytes,
                     std::uint64_t budget_bytes, float rate)
    : hierarchy_(tables),
      family_bytes_(std::move(family_bytes)),
      root_bytes_(root_bytes),
      budget_bytes_(budget_bytes),
      rate_(rate),
      is_chosen_(tables.cells.size()),
      is_resident_(tables.cells.size()),
      bytes_(root_bytes) {}

bool Residency::is_refined(CellId cell) const {
  return limited_distance(radii_.metric, viewpoint_, hierarchy_.cells[cell].bounds, tracker_.limits()) <
         radii_.of(cell, static_cast<std::size_t>(hierarchy_.level_of(cell)));
}

ChildState Residency::state_of(CellId cell) const {
  if (!is_resident_[cell]) return ChildState::missing;
  return is_chosen_[cell] ? ChildState::there : ChildState::unwanted;
}

// Those of the least excess first. Children have less than their parents, and neither they are chosen nor drawn where
// their parents are not.
std::vector<CellId> Residency::make_room() {
  std::vector<CellId> gone;
  if (lacking_ == 0) return gone;
  std::vector<CellId> idle;
  for (const CellId cell : resident_)
    if (!is_chosen_[cell] && !is_refined(cell)) idle.push_back(cell);
  idle = sorted_by_excess(hierarchy_, radii_, viewpoint_, idle);
  std::ranges::reverse(idle);
  for (const CellId cell : idle) {
    if (lacking_ == 0) break;
    lacking_ -= std::min(lacking_, family_bytes_[cell]);
    bytes_ -= family_bytes_[cell];
    is_resident_[cell] = 0;
    gone.push_back(cell);
  }
  changing_ = changing_ || !gone.empty();
  std::erase_if(resident_, [&](CellId cell) { return !is_resident_[cell]; });
  return gone;
}

bool Residency::take_in(CellId parent) {
  const CellId above = hierarchy_.cells[parent].parent;
  if (above != no_cell && !is_resident_[above]) return false;
  changing_ = true;
  is_resident_[parent] = 1;
  resident_.push_back(parent);
  bytes_ += family_bytes_[parent];
  return true;
}

bool Residency::update(const Radii& radii, Vec3f viewpoint) {
  const bool rests = viewpoint == viewpoint_ && radii.metric == radii_.metric && radii.select == radii_.select &&
                     radii.band_begin == radii_.band_begin && radii.by_cell == radii_.by_cell;
  if (rests && !changing_) return false;
  radii_ = radii;
  viewpoint_ = viewpoint;
  if (!rests) choose();
  changing_ = tracker_.update(
      hierarchy_, radii_, viewpoint_, [this](CellId cell) { return state_of(cell); }, rate_);
  wish();
  return true;
}

void Residency::choose() {
  for (const CellId cell : chosen_) is_chosen_[cell] = 0;
  chosen_ = choose_families(hierarchy_, radii_, viewpoint_, {family_bytes_, budget_bytes_ - root_bytes_});
  for (const CellId cell : chosen_) is_chosen_[cell] = 1;
}

void Residency::wish() {
  std::vector<CellId> missing;
  std::uint64_t bytes = 0;
  for (const CellId cell : tracker_.missing()) {
    if (!is_chosen_[cell]) continue;
    missing.push_back(cell);
    bytes += family_bytes_[cell];
  }
  wanted_ = sorted_by_excess(hierarchy_, radii_, viewpoint_, missing);
  lacking_ = bytes > room() ? bytes - room() : 0;
}

}  // namespace lodestone
