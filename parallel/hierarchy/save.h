// Writing and opening .lode files with all workers: the same bytes and checks as core/hierarchy/lode/lode_file.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/hierarchy/lode/lode_file.h"
#include "core/hierarchy/model/hierarchy.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct PayloadCounts;  // core/hierarchy/lode/lode_payload.h

// The cells of a hierarchy that is written: this one has them in memory.
class CellSource {
 public:
  explicit CellSource(const Hierarchy& hierarchy) : hierarchy_(hierarchy) {}
  virtual ~CellSource() = default;

  [[nodiscard]] const Hierarchy& tables() const { return hierarchy_; }
  [[nodiscard]] virtual std::vector<PayloadCounts> counts() const;  // by cell
  // The level whose cells are visited next; coarse levels come before fine ones.
  virtual void begin_level(std::size_t /*level*/) {}
  // Calls visit(cell) with the payload, which lives as long as the call. From any thread.
  using Visit = std::function<void(const Cell&)>;
  virtual void visit(CellId id, const Visit& visit) { visit(hierarchy_.cells[id]); }
  // True if the payload lives as long as the source.
  [[nodiscard]] virtual bool keeps_payloads() const { return true; }

 private:
  const Hierarchy& hierarchy_;
};

// As write_lode; payloads are encoded, summed and written at their offsets in parallel. Working memory: about a
// mebibyte, at least one cell, for each worker; sixteen times that for a compressed file. `progress` gets the number of
// cells written, from time to time. Returns the size of the file.
std::uint64_t save_lode(CellSource& source, const std::filesystem::path& path, Scheduler& scheduler,
                        LodeForm form = LodeForm::plain, const std::function<void(std::size_t)>& progress = {});
std::uint64_t save_lode(const Hierarchy& hierarchy, const std::filesystem::path& path, Scheduler& scheduler,
                        LodeForm form = LodeForm::plain);

// As open_lode; the payloads are decompressed and checked in parallel.
[[nodiscard]] Hierarchy load_lode(const std::filesystem::path& path, Scheduler& scheduler);

}  // namespace lodestone
