// Decides, frame by frame, which families to load and to remove and which limits to draw with: families in memory move
// towards those that belong there (family_choice.h), and to nothing else. A camera at rest hence comes to rest: once
// all of them have arrived and limits have moved to their ends, no frame differs from the one before.
//
// A family that is needed but not chosen is as good as missing: its limit rises, and it is removed where its bytes are
// wanted. What the view does not need at all is kept as long as there is room. Knows neither files nor memory: the
// caller loads and removes (resident_cells.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/lod/limits.h"
#include "render/lod/radii.h"

namespace lodestone {

class Residency {
 public:
  // The hierarchy, of which the tables are enough, outlives this. `family_bytes` by the family's parent; the root,
  // which is always there, counts into the budget with `root_bytes`. The rate of the limits: LimitTracker::update.
  Residency(const Hierarchy& tables, std::vector<std::uint64_t> family_bytes, std::uint64_t root_bytes,
            std::uint64_t budget_bytes, float rate);

  // The steps of a frame, in this order.
  // 1. Families that the last frame did not draw and whose room is wanted, children before their parents; they are no
  //    longer resident.
  [[nodiscard]] std::vector<CellId> make_room();
  // 2. For each that has been loaded: true if it is resident from now on, false if the one above it has gone meanwhile.
  [[nodiscard]] bool take_in(CellId parent);
  // 3. Limits and wishes for this view. Returns false if it is that of the last frame and nothing has changed since:
  //    a camera that has come to rest costs nothing.
  bool update(const Radii& radii, Vec3f viewpoint);

  [[nodiscard]] DetailLimits limits() const { return tracker_.limits(); }
  // Families to be loaded, the most urgent first. Together with `bytes()` they may exceed the budget for some frames.
  [[nodiscard]] std::span<const CellId> wanted() const { return wanted_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }  // resident
  [[nodiscard]] std::uint64_t room() const { return budget_bytes_ - bytes_; }
  [[nodiscard]] float rate() const { return rate_; }

 private:
  [[nodiscard]] bool is_refined(CellId cell) const;  // in the last frame
  [[nodiscard]] ChildState state_of(CellId cell) const;
  void choose();
  void wish();

  const Hierarchy& hierarchy_;
  std::vector<std::uint64_t> family_bytes_;
  std::uint64_t root_bytes_ = 0;
  std::uint64_t budget_bytes_ = 0;
  float rate_ = 0;
  LimitTracker tracker_;
  std::vector<std::uint8_t> is_chosen_, is_resident_;  // by parent
  std::vector<CellId> chosen_, resident_, wanted_;
  std::uint64_t bytes_ = 0;
  std::uint64_t lacking_ = 0;  // bytes of those wanted beyond the room
  bool changing_ = true;       // families or limits have changed in the last frame, or families since

  // The view of the last update.
  Radii radii_;
  Vec3f viewpoint_;
};

}  // namespace lodestone
