// Tilesets by several ranks, which are threads here: the files of save_tiles.
#include <gtest/gtest.h>

#include <optional>

#include "core/base/error.h"
#include "parallel/distributed/messages/local_transport.h"
#include "parallel/distributed/rank_cells.h"
#include "parallel/distributed/rank_tiles.h"
#include "parallel/hierarchy/save.h"
#include "tests/expect_error.h"
#include "tests/old_lode.h"
#include "tests/parallel/saved_tiles.h"

namespace lodestone {
namespace {

class RankTilesets : public SaveTiles {
 protected:
  // A hierarchy with materials, images and seams, plain or on a lattice.
  fs::path file(LodeForm form = LodeForm::plain) {
    Repairs repairs;
    BuildConfig config;
    config.finest_level = 4;
    const Lattice lattice = form == LodeForm::plain ? Lattice{} : Lattice{Lattice::automatic};
    const Hierarchy h =
        build_hierarchy(prepare_mesh(surface(), repairs, *scheduler_, "m", lattice), config, *scheduler_);
    (void)save_lode(h, name_, *scheduler_, form);
    return name_;
  }

  SavedTiles save_by(int ranks, int threads, const SaveTilesConfig& config = {}, std::optional<UpAxis> up = {}) {
    fs::remove_all(path());
    SavedTiles saved;
    std::atomic<std::uint64_t> own_tiles{0};
    run_local_ranks(ranks, [&](Transport& transport) {
      const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
      std::optional<AtomicFolder> folder;
      if (transport.rank() == 0) folder.emplace(path());
      Ranks all(transport);
      const RankTiles result =
          save_rank_tiles(name_, folder ? &*folder : nullptr,
                          {config, up, [&](const RankTiles& own) { own_tiles += own.own_tiles; }}, all, *scheduler);
      if (!folder) return;
      folder->commit();
      saved = result.saved;
    });
    EXPECT_EQ(own_tiles, saved.tiles);
    return saved;
  }

  const fs::path name_ = folder_.path() / "m.lode";
};

TEST_F(RankTilesets, HaveTheFilesOfOneProcess) {
  for (const LodeForm form : {LodeForm::plain, LodeForm::compressed}) {
    (void)file(form);
    for (const bool morph : {false, true}) {
      SaveTilesConfig config;
      config.tileset.morph = morph;
      const SavedTiles expected = save(load_lode(name_, *scheduler_), config);
      const auto expected_files = files();
      ASSERT_GT(expected.tiles, 20u);
      for (const int ranks : {1, 2, 3, 5, 8})
        for (const int threads : {0, 2}) {
          EXPECT_TRUE(save_by(ranks, threads, config) == expected);
          EXPECT_TRUE(files() == expected_files) << ranks << " ranks, " << threads << " threads, morph " << morph;
        }
    }
  }
}

TEST_F(RankTilesets, TurnTheModelAsTheyAreTold) {
  const UpAxis up = UpAxis::y;
  Hierarchy h = load_lode(file(), *scheduler_);
  h.transform.up = {up, false};
  (void)save(h);
  const auto expected = files();
  (void)save_by(3, 2, {}, up);
  EXPECT_TRUE(files() == expected);
}

TEST_F(RankTilesets, NeedSignaturesToMorph) {
  RawMesh raw = generate_mesh({Shape::terrain, 6000, 3});
  (void)save_lode(built(std::move(raw), *scheduler_), name_, *scheduler_);
  test::drop_signatures(name_);
  SaveTilesConfig config;
  config.tileset.morph = true;
  expect_error_of<UnsupportedError>([&] { return save_by(2, 0, config); }, {"rank ", "m.lode: has no signatures"});
  EXPECT_FALSE(fs::exists(path()));
  EXPECT_GT(save_by(2, 0).tiles, 0u);
}

TEST_F(RankTilesets, HearOfTilesInTheirOwnWordsAlone) {
  const Hierarchy h = load_lode(file(), *scheduler_);
  TileWriter writer(h, path(), *scheduler_, {});
  for (const char* told : {"", "{}", R"({"cells": [[1000000, 0.5]], "linked": [], "counts": [0, 0, 0, 0, 0, 0, 0]})",
                           R"({"cells": [], "linked": [], "counts": [0]})"})
    EXPECT_THROW(writer.hear(told), Error) << told;
}

TEST_F(RankTilesets, LeaveNothingWhenARankFails) {
  fs::path altered = file();
  const std::string bytes = content(altered);
  // Somewhere in the last payload, which the last rank reads.
  std::string broken = bytes;
  broken[broken.size() - 100] = static_cast<char>(~broken[broken.size() - 100]);
  std::ofstream(altered, std::ios::binary) << broken;
  EXPECT_THROW((void)save_by(3, 2), InputError);
  EXPECT_FALSE(fs::exists(path()));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

TEST_F(RankTilesets, ReadTheirOwnCellsAndParentsAlone) {
  const Hierarchy whole = load_lode(file(), *scheduler_);
  std::vector<int> owners(whole.cells.size());
  for (int rank = 0; rank < 5; ++rank) {
    const RankCells part = load_rank_cells(name_, rank, 5, *scheduler_);
    EXPECT_TRUE(std::ranges::is_sorted(part.own));
    for (const CellId c : part.own) {
      ++owners[c];
      for (const CellId read : {c, whole.cells[c].parent}) {
        if (read == no_cell) continue;
        const Cell &a = part.hierarchy.cells[read], &b = whole.cells[read];
        ASSERT_TRUE(std::ranges::equal(a.positions, b.positions));
        ASSERT_TRUE(std::ranges::equal(a.attributes.uv, b.attributes.uv));
      }
    }
  }
  EXPECT_EQ(std::ranges::count(owners, 1), static_cast<std::ptrdiff_t>(owners.size()));
}

}  // namespace
}  // namespace lodestone
