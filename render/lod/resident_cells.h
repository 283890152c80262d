// The cells of a streamed hierarchy in memory: those that the view needs, within a budget of bytes.
//
// Coarse cells come first, since a family's urgency is r_l / d of its parent Q, how far the view has outgrown it;
// families out of view wait. When the budget is full, families that the view does not need are removed; if it needs
// them all, the least urgent make room for more urgent ones, their limits rising first (render/lod/limits.h). The
// picture has neither cracks nor pops at any time.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "parallel/streaming/cell_stream.h"
#include "render/lod/limits.h"
#include "render/lod/selection.h"

namespace lodestone {

struct ResidencyConfig {
  std::uint64_t budget_bytes = std::uint64_t{1} << 30;  // of payloads in memory, those being loaded included
  float rate = 0.12f;                                   // of the limits, per frame: LimitTracker::update
};

class ResidentCells {
 public:
  // Loads the root at once. Throws InputError when the budget does not hold it, or as CellStream::load does.
  ResidentCells(CellStream& stream, const ResidencyConfig& config);

  // Missing cells have empty arrays. Always the same object; only update() changes it.
  [[nodiscard]] const Hierarchy& hierarchy() const { return hierarchy_; }

  // To be called before each frame's selection: adds loaded families, removes unused ones, and requests those that this
  // view needs. Throws what a load has thrown.
  void update(const Radii& radii, Vec3f viewpoint, const Frustum* frustum = nullptr);

  // Limits for selection and morph of the frame.
  [[nodiscard]] DetailLimits limits() const { return tracker_.limits(); }
  // Families that the last update added and removed.
  [[nodiscard]] std::span<const CellId> came() const { return came_; }
  [[nodiscard]] std::span<const CellId> went() const { return went_; }
  // True if the view has all cells that it needs.
  [[nodiscard]] bool complete() const { return tracker_.limits().empty(); }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }  // resident now
  [[nodiscard]] float rate() const { return config_.rate; }

 private:
  struct Family {
    std::unique_ptr<std::byte[]> memory;
    std::uint64_t bytes = 0;
    bool unwanted = false;
    std::uint32_t resident_children = 0;  // families whose parent is in this one
  };
  void take_in(LoadedFamily&& loaded);
  void let_go(CellId parent);
  void make_room();
  [[nodiscard]] float urgency(CellId parent) const;  // for the view of the last update
  [[nodiscard]] bool is_refined(CellId cell) const;  // in the last frame
  void choose_unwanted(float most_urgent);

  CellStream& stream_;
  ResidencyConfig config_;
  Hierarchy hierarchy_;
  std::unordered_map<CellId, Family> families_;  // resident, by parent
  LimitTracker tracker_;
  std::vector<CellId> came_, went_;
  std::uint64_t bytes_ = 0;
  std::uint64_t lacking_ = 0;  // bytes that the last update could not ask for

  // The view of the last update.
  Radii radii_;
  Vec3f viewpoint_;
  Frustum frustum_{};
  bool has_frustum_ = false;
};

}  // namespace lodestone
