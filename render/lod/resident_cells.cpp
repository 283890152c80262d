#include "render/lod/resident_cells.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_payload.h"

namespace lodestone {
namespace {

// Factor by which a drawn family must be less urgent than a missing one to make room for it: without a difference two
// of them would take turns.
constexpr float contrast = 1.25f;
// Urgency of families out of view.
constexpr float unseen = 1.0f / 16;

}  // namespace

ResidentCells::ResidentCells(CellStream& stream, const ResidencyConfig& config)
    : stream_(stream), config_(config), hierarchy_(stream.tables()) {
  const std::uint64_t root_bytes = stream.family_bytes(no_cell);
  if (root_bytes > config.budget_bytes)
    throw InputError(describe("", "memory budget", std::to_string(config.budget_bytes) + " bytes do not hold the root",
                              "allow at least " + std::to_string(root_bytes)));
  for (Cell& cell : hierarchy_.cells) drop_arrays(cell);
  take_in(stream.load(no_cell));
}

void ResidentCells::take_in(LoadedFamily&& loaded) {
  std::move(loaded.cells.begin(), loaded.cells.end(),
            hierarchy_.cells.begin() + family_cells(hierarchy_, loaded.parent).begin);
  bytes_ += loaded.bytes;
  if (loaded.parent != no_cell) ++families_.at(hierarchy_.cells[loaded.parent].parent).resident_children;
  families_.emplace(loaded.parent, Family{std::move(loaded.memory), loaded.bytes, false, 0});
  came_.push_back(loaded.parent);
}

void ResidentCells::let_go(CellId parent) {
  const FamilyCells cells = family_cells(hierarchy_, parent);
  for (CellId c = cells.begin; c < cells.end; ++c) drop_arrays(hierarchy_.cells[c]);
  --families_.at(hierarchy_.cells[parent].parent).resident_children;
  bytes_ -= families_.at(parent).bytes;
  families_.erase(parent);
  went_.push_back(parent);
}

float ResidentCells::urgency(CellId parent) const {
  if (parent == no_cell) return std::numeric_limits<float>::infinity();
  const Cell& cell = hierarchy_.cells[parent];
  const int level = hierarchy_.level_of(parent);
  const float d = std::max(distance(radii_.metric, viewpoint_, cell.bounds), cell_size(hierarchy_.finest()) / 2);
  const bool seen =
      !has_frustum_ || !outside(frustum_, cell.bounds, displacement_bound(hierarchy_.sigma0, std::max(level, 1)));
  return radii_.select[static_cast<std::size_t>(level)] / d * (seen ? 1 : unseen);
}

bool ResidentCells::is_refined(CellId cell) const {
  if (cell == no_cell) return true;  // the root is always drawn or refined
  return limited_distance(radii_.metric, viewpoint_, hierarchy_.cells[cell].bounds, tracker_.limits()) <
         radii_.select[static_cast<std::size_t>(hierarchy_.level_of(cell))];
}

// Removes families that the last frame did not draw, descendants first, until there is room for those it lacked.
void ResidentCells::make_room() {
  while (lacking_ > 0) {
    std::vector<std::pair<float, CellId>> idle;
    for (const auto& [parent, family] : families_)
      if (family.resident_children == 0 && !is_refined(parent)) idle.emplace_back(urgency(parent), parent);
    if (idle.empty()) return;
    std::sort(idle.begin(), idle.end());
    for (const auto& [urgency, parent] : idle) {
      if (lacking_ == 0) return;
      lacking_ -= std::min(lacking_, families_.at(parent).bytes);
      let_go(parent);
    }
  }
}

// Families that are drawn but less urgent than missing ones: their limits rise from the next frame on.
void ResidentCells::choose_unwanted(float most_urgent) {
  std::vector<std::pair<float, CellId>> candidates;
  for (auto& [parent, family] : families_) {
    family.unwanted = false;
    if (family.resident_children > 0) continue;
    const float own = urgency(parent);
    if (own * contrast < most_urgent) candidates.emplace_back(own, parent);
  }
  std::sort(candidates.begin(), candidates.end());
  std::uint64_t freed = 0;
  for (const auto& [own, parent] : candidates) {
    if (freed >= lacking_) return;
    families_.at(parent).unwanted = true;
    freed += families_.at(parent).bytes;
  }
}

void ResidentCells::update(const Radii& radii, Vec3f viewpoint, const Frustum* frustum) {
  came_.clear();
  went_.clear();
  if (lacking_ > 0) make_room();
  // The family above may have been removed while this one was loading.
  for (LoadedFamily& loaded : stream_.collect())
    if (families_.contains(hierarchy_.cells[loaded.parent].parent)) take_in(std::move(loaded));

  radii_ = radii;
  viewpoint_ = viewpoint;
  has_frustum_ = frustum != nullptr;
  if (frustum) frustum_ = *frustum;
  tracker_.update(
      hierarchy_, radii_, viewpoint_,
      [&](CellId cell) {
        const auto found = families_.find(cell);
        if (found == families_.end()) return ChildState::missing;
        return found->second.unwanted ? ChildState::unwanted : ChildState::there;
      },
      config_.rate);

  std::vector<std::pair<float, CellId>> missing;
  std::uint64_t wanted = 0;
  for (const CellId cell : tracker_.missing()) {
    missing.emplace_back(urgency(cell), cell);
    wanted += stream_.family_bytes(cell);
  }
  std::sort(missing.begin(), missing.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  std::vector<CellId> parents;
  for (const auto& [urgency, cell] : missing) parents.push_back(cell);
  const std::uint64_t room = config_.budget_bytes - bytes_;
  stream_.request(parents, room);
  lacking_ = wanted > room ? wanted - room : 0;
  choose_unwanted(lacking_ > 0 ? missing.front().first : 0);
}

}  // namespace lodestone
