// Triangles that the ranks have sent to one of them, in a scratch file, in the order of the input.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/files/scratch_file.h"
#include "parallel/distributed/messages/pieces.h"
#include "parallel/mesh/mesh_stream.h"

namespace lodestone {

// Some of the numbers below `count`, and the place of each among them. Memory: 9 bits for every 8 numbers.
class NumberSet {
 public:
  explicit NumberSet(std::uint64_t count) : words_((count + 63) / 64, 0) {}
  void add(std::uint32_t number) { words_[number / 64] |= std::uint64_t{1} << (number % 64); }
  // After the last add(): those that are in it, ascending.
  [[nodiscard]] std::vector<std::uint32_t> finish();
  // The number is in the set, which is finished.
  [[nodiscard]] std::uint32_t place(std::uint32_t number) const;

 private:
  static constexpr std::size_t words_per_count = 8;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_;  // by words_per_count words: how many are in those before
};

// A stream of triangles of consecutive vertices, once all have come. Memory: the set, and 24 bytes for what a rank
// sends in a round.
class ReceivedTriangles final : public MeshStream {
 public:
  // `vertices`: of the whole clean mesh, whose numbers the triangles have that come. The file is in `folder`.
  ReceivedTriangles(const std::filesystem::path& folder, int ranks, std::uint64_t vertices);

  void append(const ByRank<Triangle>& came);
  // After the last append(): by vertex of the stream, its number in the whole mesh.
  [[nodiscard]] std::vector<std::uint32_t> finish();
  // Positions by vertex of the stream, which have to stay there.
  void set_positions(std::span<const Vec3f> positions) { positions_ = positions; }

  [[nodiscard]] const std::string& name() const override { return name_; }
  void read_vertices(std::uint64_t first, std::span<Vec3d> out, RawWedges* wedges = nullptr) const override;
  void read_triangles(std::uint64_t first, std::span<Triangle> out) const override;
  [[nodiscard]] std::uint64_t identity() const override { return 0; }

 private:
  struct Extent {
    std::uint64_t first = 0;    // triangle of the stream
    std::uint64_t in_file = 0;  // likewise
    std::uint64_t count = 0;
  };
  std::unique_ptr<ScratchFile> file_;
  std::vector<std::vector<Extent>> by_source_;  // while they come
  std::vector<Extent> extents_;                 // ascending
  NumberSet numbers_;
  std::span<const Vec3f> positions_;
  std::string name_ = "triangles of a rank";
};

}  // namespace lodestone
