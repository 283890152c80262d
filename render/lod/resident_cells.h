// The cells of a streamed hierarchy in memory: those that the view needs, within a budget of bytes.
//
// Residency (render/lod/residency.h) decides; this loads, holds and removes. The picture has neither cracks nor pops at
// any time, and a camera at rest has one picture in the end.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "parallel/streaming/cell_stream.h"
#include "render/lod/radii.h"

namespace lodestone {

struct ResidencyConfig {
  std::uint64_t budget_bytes = std::uint64_t{1} << 30;  // of families in memory, those being loaded included
  float rate = 0.12f;  // of the limits, per frame: LimitTracker::update (render/lod/limits.h)
};

class Residency;

class ResidentCells {
 public:
  // Loads the root at once. Throws InputError when the budget does not hold it, or as CellStream::load does.
  ResidentCells(CellStream& stream, const ResidencyConfig& config);
  ~ResidentCells();
  ResidentCells(const ResidentCells&) = delete;
  ResidentCells& operator=(const ResidentCells&) = delete;

  // Missing cells have empty arrays. Always the same object; only update() changes it.
  [[nodiscard]] const Hierarchy& hierarchy() const { return hierarchy_; }

  // To be called before each frame's selection: adds loaded families, removes unused ones, and requests those that this
  // view needs. Throws what a load has thrown.
  void update(const Radii& radii, Vec3f viewpoint);
  // The number of updates that have changed cells or limits: at rest it stays, and an update costs nothing.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  // Limits for selection and morph of the frame.
  [[nodiscard]] DetailLimits limits() const;
  // Families that the last update added and removed.
  [[nodiscard]] std::span<const CellId> came() const { return came_; }
  [[nodiscard]] std::span<const CellId> went() const { return went_; }
  // True if the view has all cells that it needs.
  [[nodiscard]] bool complete() const { return limits().empty(); }
  [[nodiscard]] std::uint64_t bytes() const;  // resident now
  [[nodiscard]] float rate() const;

 private:
  void take_in(LoadedFamily&& loaded);
  void let_go(CellId parent);

  CellStream& stream_;
  Hierarchy hierarchy_;
  std::unique_ptr<Residency> residency_;
  std::unordered_map<CellId, std::unique_ptr<std::byte[]>> memory_;  // of resident families, by parent
  std::vector<CellId> came_, went_;
  std::uint64_t revision_ = 0;
};

}  // namespace lodestone
