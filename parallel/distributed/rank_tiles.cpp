#include "parallel/distributed/rank_tiles.h"

#include "core/base/error.h"
#include "parallel/distributed/rank_cells.h"

namespace lodestone {
namespace {

Message message_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::string text_of(const Message& message) { return {reinterpret_cast<const char*>(message.data()), message.size()}; }

}  // namespace

RankTiles save_rank_tiles(const std::filesystem::path& file, const UpAxis* up, AtomicFolder* folder,
                          const SaveTilesConfig& config, Ranks& ranks, Scheduler& scheduler) {
  RankCells cells = load_rank_cells(file, ranks.rank(), ranks.count(), scheduler);
  Hierarchy& hierarchy = cells.hierarchy;
  if (up) hierarchy.transform.up = {*up, false};
  if (config.tileset.morph && !hierarchy.signatures)
    throw UnsupportedError(describe(file.string(), "", "has no signatures, which tiles that morph need",
                                    "build it again, or export it with lodestone, which finds them"));

  if (folder) add_level_folders(hierarchy, *folder);
  const std::string path =
      text_of(ranks.from_first(message_of(folder ? std::filesystem::absolute(folder->path()).string() : "")));
  TileWriter writer(hierarchy, path, scheduler, config);
  writer.write_tiles(cells.own);

  std::vector<Message> told(static_cast<std::size_t>(ranks.count()));
  if (!folder) told.front() = message_of(writer.tell());
  const std::vector<Message> heard = ranks.exchange(std::move(told));
  RankTiles result;
  result.finest_triangles = hierarchy.levels.back().triangles;
  for (const CellId cell : cells.own) {
    result.own_tiles += !hierarchy.cells[cell].triangles.empty();
    result.own_triangles += hierarchy.cells[cell].triangles.size();
  }
  if (folder) {
    for (const Message& message : heard)
      if (!message.empty()) writer.hear(text_of(message));
    result.saved = writer.write_rest(*folder);
  }
  return result;
}

}  // namespace lodestone
