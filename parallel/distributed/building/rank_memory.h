// The memory of a rank under a limit: how the steps divide it, and the least with which they work.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "parallel/distributed/messages/ranks.h"
#include "parallel/distributed/rank_input.h"
#include "parallel/hierarchy/build.h"

namespace lodestone {

struct RankLimit {
  std::uint64_t bytes = 0;          // that the process of a rank may have resident; 0: no limit
  std::filesystem::path scratch{};  // folder for temporary files, which have no names
  // The blocks that are done are in files with names in a folder there (scratch_folder), which remain when the build is
  // interrupted or fails, and are continued from, with any number of ranks.
  bool resume = false;
  // Puts cells and triangles there whatever the limit, and has so many triangles or vertices in memory at a time where
  // it can choose; 0: as the limit allows.
  std::uint64_t part = 0;
};

// Divides the limit among the steps of a build by ranks. Only compared_items() is the same at all ranks.
class RankMemory {
 public:
  // Called by all ranks. Throws ResourceError with the least limit where this one cannot be kept, and FileError where
  // the folder for temporary files is missing, or its disk too full. A mesh with attributes has to fit.
  RankMemory(const RankInput& input, const RankLimit& limit, const BuildConfig& build, Ranks& ranks, int workers);

  [[nodiscard]] bool spills() const { return spills_; }
  [[nodiscard]] bool resumes() const { return spills_ && limit_.resume; }
  [[nodiscard]] const std::filesystem::path& scratch() const { return limit_.scratch; }

  // Vertices or triangles of a slice that are compared at a time.
  [[nodiscard]] std::uint64_t compared_items() const;
  // Triangles of a rank that are sorted at a time.
  [[nodiscard]] std::uint64_t part(std::uint64_t vertices, std::uint64_t triangles) const;
  // Blocks of the finest level in memory at a time, of a rank with so much of it. Throws ResourceError with the need
  // where there is no room for one.
  struct FinestShare {
    std::uint64_t vertices = 0, shared = 0;  // shared by cells
    std::uint64_t outer = 0;                 // shared with other ranks
    std::uint64_t cells = 0, runs = 0;
    std::uint64_t largest_block = 0;  // triangles
  };
  [[nodiscard]] std::size_t lanes(const FinestShare& share) const;
  // Copies of vertices on borders of cells that a rank compares at a time, when it has so many cells of all levels, and
  // copies of the level at hand. Differs from rank to rank.
  [[nodiscard]] std::uint64_t compared_copies(std::uint64_t cells, std::uint64_t copies) const;

 private:
  [[nodiscard]] std::uint64_t in_core_bytes() const;
  [[nodiscard]] std::uint64_t stored_bytes(const BuildConfig& build) const;
  [[nodiscard]] std::uint64_t left(std::uint64_t taken) const;
  void require_limit(const BuildConfig& build);
  void require_room(Ranks& ranks) const;
  [[noreturn]] void fail(const std::string& what, std::uint64_t need) const;

  std::string input_;  // its name
  RankLimit limit_;
  std::uint64_t vertices_, triangles_;          // of the largest slices
  std::uint64_t all_vertices_, all_triangles_;  // of all of them
  std::uint64_t wedges_;                        // of the rank with the most; 0 without attributes
  std::uint64_t workers_ = 1;                   // of the rank with the most
  std::uint64_t fixed_ = 0;
  bool spills_ = false;
};

}  // namespace lodestone
