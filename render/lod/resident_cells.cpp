#include "render/lod/resident_cells.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_payload.h"
#include "render/lod/residency.h"

namespace lodestone {
namespace {

std::vector<std::uint64_t> bytes_of_families(const CellStream& stream) {
  std::vector<std::uint64_t> bytes(stream.tables().cells.size());
  for (CellId c{0}; c < bytes.size(); ++c) bytes[c] = stream.family_bytes(c);
  return bytes;
}

}  // namespace

ResidentCells::ResidentCells(CellStream& stream, const ResidencyConfig& config)
    : stream_(stream),
      hierarchy_(stream.tables()),
      residency_(std::make_unique<Residency>(hierarchy_, bytes_of_families(stream), stream.family_bytes(no_cell),
                                             config.budget_bytes, config.rate)) {
  if (bytes() > config.budget_bytes)
    throw InputError(describe("", "memory budget", std::to_string(config.budget_bytes) + " bytes do not hold the root",
                              "allow at least " + std::to_string(bytes())));
  for (Cell& cell : hierarchy_.cells) drop_arrays(cell);
  take_in(stream.load(no_cell));
}

ResidentCells::~ResidentCells() = default;

DetailLimits ResidentCells::limits() const { return residency_->limits(); }

std::uint64_t ResidentCells::bytes() const { return residency_->bytes(); }

float ResidentCells::rate() const { return residency_->rate(); }

void ResidentCells::take_in(LoadedFamily&& loaded) {
  std::move(loaded.cells.begin(), loaded.cells.end(),
            hierarchy_.cells.begin() + family_cells(hierarchy_, loaded.parent).begin);
  memory_.emplace(loaded.parent, std::move(loaded.memory));
  came_.push_back(loaded.parent);
}

void ResidentCells::let_go(CellId parent) {
  const FamilyCells cells = family_cells(hierarchy_, parent);
  for (CellId c = cells.begin; c < cells.end; ++c) drop_arrays(hierarchy_.cells[c]);
  memory_.erase(parent);
  went_.push_back(parent);
}

void ResidentCells::update(const Radii& radii, Vec3f viewpoint) {
  came_.clear();
  went_.clear();
  for (const CellId parent : residency_->make_room()) let_go(parent);
  std::vector<LoadedFamily> loaded = stream_.collect();
  for (LoadedFamily& family : loaded)
    if (residency_->take_in(family.parent)) take_in(std::move(family));
  const bool updated = residency_->update(radii, viewpoint);
  if (updated) ++revision_;
  // Refused families have taken room from the queue.
  if (updated || !loaded.empty()) stream_.request(residency_->wanted(), residency_->room());
}

}  // namespace lodestone
