#include "parallel/distributed/rank_tiles.h"

#include "core/base/error.h"
#include "parallel/distributed/rank_cells.h"

namespace lodestone {

RankTiles save_rank_tiles(const std::filesystem::path& file, AtomicFolder* folder, const RankTilesConfig& config,
                          Ranks& ranks, Scheduler& scheduler) {
  RankCells cells = load_rank_cells(file, ranks.rank(), ranks.count(), scheduler);
  Hierarchy& hierarchy = cells.hierarchy;
  if (config.up) hierarchy.transform.up = {*config.up, false};
  if (config.tiles.tileset.morph && !hierarchy.signatures)
    throw UnsupportedError(describe(file.string(), "", "has no signatures, which tiles that morph need",
                                    "build it again, or export it with lodestone, which finds them"));

  RankTiles result;
  result.finest_triangles = hierarchy.levels.back().triangles;
  for (const CellId cell : cells.own) {
    result.own_tiles += !hierarchy.cells[cell].triangles.empty();
    result.own_triangles += hierarchy.cells[cell].triangles.size();
  }
  if (folder) add_level_folders(hierarchy, *folder);
  const std::string path = ranks.from_first(folder ? std::filesystem::absolute(folder->path()).string() : "");
  TileWriter writer(hierarchy, path, scheduler, config.tiles);
  writer.write_tiles(cells.own);
  std::vector<std::vector<char>> told(static_cast<std::size_t>(ranks.count()));
  if (!folder) {
    const std::string text = writer.tell();
    told.front().assign(text.begin(), text.end());
  }
  const std::vector<std::vector<char>> heard = ranks.exchange(told);
  if (config.last_words) config.last_words(result);
  if (!folder) return result;
  for (const std::vector<char>& text : heard)
    if (!text.empty()) writer.hear({text.begin(), text.end()});
  result.saved = writer.write_rest(*folder);
  return result;
}

}  // namespace lodestone
