// prepare_mesh (parallel/clean/prepare.h) for a mesh whose triangles remain in their file: same repairs and numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/mesh/indexed_mesh.h"
#include "parallel/mesh/mesh_stream.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// A bit for each of many things.
class BitSet {
 public:
  explicit BitSet(std::size_t count = 0) : words_((count + 63) / 64, 0) {}
  [[nodiscard]] bool operator[](std::size_t i) const { return words_[i / 64] >> (i % 64) & 1; }
  // For one thread at a time for each run of 64.
  void set(std::size_t i) { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
  // For any thread at any time, if all use it.
  void set_shared(std::size_t i);
  [[nodiscard]] std::vector<std::uint64_t>& words() { return words_; }

 private:
  std::vector<std::uint64_t> words_;
};

// The clean mesh, except for its triangles.
struct CleanStream {
  std::vector<Vec3f> positions;        // of the vertices that are left, as in IndexedMesh
  std::vector<std::uint32_t> numbers;  // of each vertex of the stream, among these; empty: all are left
  BitSet dropped;                      // triangles of the stream that go
  std::uint64_t triangles = 0;         // that are left
  Transform transform;
  Repairs repairs;

  // Returns what is left of triangles [first, first + count) of the stream, with the new numbers.
  [[nodiscard]] std::vector<Triangle> read(const MeshStream& stream, std::uint64_t first, std::size_t count) const;
};

// The file is read two to four times, once more where vertices meet or triangles are dropped, and twice for each part
// of the triangles whose hashes (8 bytes each) fit into `working_bytes`. Memory: 17 bytes per vertex, a bit per
// triangle, working_bytes, and two mebibytes per worker. `progress` gets the share that is done, from time to time.
// Throws as prepare_mesh and the stream do.
[[nodiscard]] CleanStream clean_stream(const MeshStream& stream, Lattice lattice, std::size_t working_bytes,
                                       Scheduler& scheduler, const std::function<void(double)>& progress = {});

}  // namespace lodestone
