// A .lode file from cells that are in a scratch file: the same bytes as save_lode (parallel/build/save.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/model/hierarchy.h"
#include "parallel/out_of_core/cell_store.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct StoredHierarchy {
  Hierarchy tables;                            // payloads are left empty
  std::vector<std::vector<StoredCell>> cells;  // by level, by rank
};

// `order`: cells in the order for compression (BuildConfig::order_cells). Memory: about a mebibyte per worker; with
// `order` four bytes per vertex of the two levels at hand besides. Returns the size of the file. `done` is called with
// how many cells are written, from time to time.
std::uint64_t save_stored(const StoredHierarchy& hierarchy, const CellStore& store, const std::filesystem::path& path,
                          LodeForm form, bool order, Scheduler& scheduler,
                          const std::function<void(std::size_t)>& done = {});

}  // namespace lodestone
