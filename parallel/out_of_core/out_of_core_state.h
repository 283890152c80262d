// The temporary files of an out-of-core build and the contents of their journal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/hierarchy/construct/finest_cell.h"
#include "core/mesh/indexed_mesh.h"
#include "parallel/out_of_core/build_journal.h"
#include "parallel/out_of_core/build_model.h"
#include "parallel/out_of_core/spill.h"

namespace lodestone {

// Everything that is known once the triangles are spilled, and that the blocks start from.
struct SpilledMesh {
  int level = 0;
  std::uint64_t triangles = 0;
  Transform transform;
  Repairs repairs;
  CellRuns cells;
  FinestVertices vertices;  // sharing is numbered
};

// With names and a journal if config.resume, else without.
class OutOfCoreFiles {
 public:
  OutOfCoreFiles(const MeshStream& stream, const ModelConfig& config);

  [[nodiscard]] ScratchFile& triangles() { return *triangles_; }
  [[nodiscard]] ScratchFile& cells() { return *cells_; }
  [[nodiscard]] std::uint64_t bytes() const;

  // Remains of an interrupted build: has_spilled() if its triangles were spilled, and the records of its blocks.
  [[nodiscard]] bool has_spilled() const { return !spilled_.empty(); }
  [[nodiscard]] SpilledMesh take_spilled(Scheduler& scheduler);
  [[nodiscard]] const std::vector<std::vector<std::byte>>& block_records() const { return blocks_; }

  // No effect without names.
  void record_spilled(const SpilledMesh& mesh);
  void record_block(std::span<const std::byte> record);
  [[nodiscard]] bool records() const { return journal_ != nullptr; }

  // The files are not needed any more.
  void remove();

 private:
  std::filesystem::path folder_;
  std::unique_ptr<ScratchFile> triangles_, cells_, positions_;
  std::unique_ptr<Journal> journal_;
  std::vector<std::byte> spilled_;              // the record
  std::vector<std::vector<std::byte>> blocks_;  // likewise, in the order they were written
};

}  // namespace lodestone
