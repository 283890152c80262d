// The input of the ranks: one mesh, and the part of it that each of them reads.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "core/mesh/indexed_mesh.h"
#include "parallel/distributed/messages/ranks.h"
#include "parallel/distributed/messages/slices.h"
#include "parallel/distributed/rank_surface.h"
#include "parallel/mesh/mesh_stream.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct RankInput {
  std::shared_ptr<const MeshStream> stream;  // each rank reads its own slices of it alone
  Slices vertices, triangles;
  Repairs reading{};  // of the readers, of all ranks
  std::vector<std::string> warnings{};
  std::uint64_t held_bytes = 0;          // memory of the files that this rank has as wholes
  std::optional<RankSurface> surface{};  // if any file has attributes that the configuration asks for
};

// The same share for each rank.
[[nodiscard]] RankInput shared_out(std::shared_ptr<const MeshStream> stream, int ranks);

// Called by all ranks with the same files, at least one, which are one mesh in their order, as load_meshes reads them.
// Files that are read in pieces are cut where the ranks' shares meet; other files, and the tiles of a tileset, are
// dealt out as wholes by their bytes, and each is in the memory of its rank alone: 24 bytes per vertex and 12 per
// triangle. If any has attributes, all files are dealt out as wholes. Throws what load_meshes throws, and InputError
// for a PLY file whose faces are triangles at first and others later, and where ranks see different files.
[[nodiscard]] RankInput open_rank_input(std::span<const std::filesystem::path> files, const ReadConfig& config,
                                        Ranks& ranks, Scheduler& scheduler);

}  // namespace lodestone
