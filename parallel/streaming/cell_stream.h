// Cells of a .lode file, loaded in the background: the tables are there at once, payloads come when they are asked for.
//
// The unit is a family (core/hierarchy/lode/lode_payload.h), named by its parent.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

class LodeReader;
class MappedFile;

// The cells of a family, their arrays in `memory`.
struct LoadedFamily {
  CellId parent = no_cell;
  std::vector<Cell> cells;
  std::unique_ptr<std::byte[]> memory;
  std::uint64_t bytes = 0;  // of memory
};

struct CellStreamConfig {
  int threads = 1;  // that load; at least 1
  // Called by a loading thread before it loads a family, for tests: slow disks, failing ones.
  std::function<void(CellId parent)> before_load = {};
};

class CellStream {
 public:
  // Maps the file and checks its tables (LodeReader); no payload is touched. Throws as load_lode does.
  explicit CellStream(const std::filesystem::path& path, CellStreamConfig config = {});
  ~CellStream();  // waits for loads under way, forgets those that have not begun
  CellStream(const CellStream&) = delete;
  CellStream& operator=(const CellStream&) = delete;

  // All cells, their arrays as long as they will be, but not to be read.
  [[nodiscard]] const Hierarchy& tables() const { return tables_; }
  // Bytes that a family takes in memory, whatever the form of the file.
  [[nodiscard]] std::uint64_t family_bytes(CellId parent) const;

  // Loads a family on the calling thread. Throws InputError for an altered file.
  [[nodiscard]] LoadedFamily load(CellId parent) const;

  // The families to load, the most urgent first, in place of earlier requests that have not begun. Those under way or
  // not yet collected count into `room` bytes; what does not fit is left out, and so is all after it.
  void request(std::span<const CellId> parents, std::uint64_t room);

  // Returns what has been loaded since the last call. Rethrows what a load has thrown.
  [[nodiscard]] std::vector<LoadedFamily> collect();

  // Waits until everything requested is loaded; for batch work and tests.
  void wait();

 private:
  void work();
  [[nodiscard]] std::uint64_t busy_bytes() const;  // under way and not collected; with the lock held

  std::shared_ptr<const MappedFile> map_;
  std::unique_ptr<const LodeReader> reader_;
  const Hierarchy& tables_;  // of the reader
  CellStreamConfig config_;

  std::mutex mutex_;
  std::condition_variable changed_;
  bool ending_ = false;
  std::deque<CellId> queue_;
  std::vector<CellId> loading_;
  std::vector<LoadedFamily> loaded_;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;
};

}  // namespace lodestone
