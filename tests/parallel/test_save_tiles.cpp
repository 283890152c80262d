// Tilesets written from hierarchies, read back by our own reader.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/texture/image_codec.h"
#include "parallel/mesh/load.h"
#include "tests/parallel/saved_tiles.h"

namespace lodestone {
namespace {

using nlohmann::json;

// Every triangle with all that its corners have, in an order of its own.
using Corner = std::tuple<double, double, double, float, float, int, int, std::string>;
std::vector<std::array<Corner, 3>> triangles_of(const RawMesh& mesh, Vec3d origin) {
  std::vector<std::array<Corner, 3>> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Corner, 3> corners;
    const std::uint32_t material = mesh.wedges.material[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = mesh.positions[mesh.triangles[t].v[k]] - origin;
      const CornerValues v = values_at(mesh, t, k);
      // To a micrometre: doubles are half of one apart here.
      const auto round = [](double x) { return std::round(x * 1e6) + 0.0; };
      corners[k] = {round(p.x), round(p.y),
                    round(p.z), v.uv.x,
                    v.uv.y,     v.colour.r * 256 + v.colour.g,
                    v.colour.a, material == no_material ? "none" : mesh.materials[material].name};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    triangles.push_back(corners);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

TEST_F(SaveTiles, GiveTheFinestLevelBackWithAllItHas) {
  const Hierarchy h = built(surface(), *scheduler_);
  const SavedTiles saved = save(h);
  EXPECT_EQ(saved.tilesets, 1u);
  EXPECT_EQ(saved.textures, 2u);
  EXPECT_EQ(saved.tiles, h.cells.size());
  const RawMesh mesh = level_mesh(h, h.finest()), read = load_mesh(path(), *scheduler_);
  EXPECT_EQ(wedge_mistake(read), "");
  EXPECT_EQ(read.warnings, std::vector<std::string>{});
  EXPECT_TRUE(triangles_of(mesh, h.transform.origin) == triangles_of(read, h.transform.origin));
  ASSERT_EQ(read.materials.size(), 2u);
  ASSERT_EQ(read.textures.size(), 2u);
  const Material& a = read.materials[read.materials[0].name == "a" ? 0 : 1];
  EXPECT_EQ(read.textures[a.texture].bytes, h.textures[0].bytes);
  EXPECT_EQ(read.textures[a.normal_map].bytes, h.textures[1].bytes);
  for (std::size_t t = 0; t < read.triangles.size(); ++t)
    for (const std::uint32_t v : read.triangles[t].v) ASSERT_GT(length(read.wedges.normal[v]), 0.999f);
}

TEST_F(SaveTiles, AreTheSameForAnyNumberOfThreads) {
  const Hierarchy h = built(surface(), *scheduler_);
  SaveTilesConfig config;
  config.tileset.max_tiles = 1;
  (void)save(h, config, 1);
  const auto first = files();
  for (const int threads : {2, 3, 7}) {
    (void)save(h, config, threads);
    EXPECT_TRUE(files() == first) << threads;
  }
}

// However the tree is cut into files, the tiles are the same.
TEST_F(SaveTiles, LargeTreesAreCutIntoTilesets) {
  const Hierarchy h = built(surface(), *scheduler_, 4);
  (void)save(h);
  const auto whole = triangles_of(load_mesh(path(), *scheduler_), h.transform.origin);
  const auto count = [&](const auto& cut) {
    std::uint64_t files = 1;
    for (int level = 1; level < h.finest(); ++level)
      if (cut(level)) files += h.cells_of(level).size();
    return files;
  };
  for (const int levels : {1, 2, 3, 4}) {
    SaveTilesConfig config;
    config.tileset.max_tiles = 8;
    config.tileset.levels_per_file = levels;
    const SavedTiles saved = save(h, config);
    EXPECT_EQ(saved.tilesets, count([&](int level) { return (h.finest() - level) % levels == 0; })) << levels;
    EXPECT_TRUE(triangles_of(load_mesh(path(), *scheduler_), h.transform.origin) == whole) << levels;
    for (const auto& [name, text] : files()) {
      if (!name.ends_with(".json")) continue;
      EXPECT_EQ(json::parse(text)["root"]["refine"], "REPLACE") << name;
    }
  }
}

// Cells that fill space are cut more often than those of a surface.
TEST_F(SaveTiles, NoTilesetHasTensOfThousandsOfTiles) {
  RawMesh raw;
  for (std::uint32_t k = 0; k < 8000; ++k) {
    const Vec3d p{double(k % 20), double(k / 20 % 20), double(k / 400)};
    for (const Vec3d& d : {Vec3d{}, Vec3d{0.3, 0, 0}, Vec3d{0, 0.3, 0}}) raw.positions.push_back(p + d);
    raw.triangles.push_back({{3 * k, 3 * k + 1, 3 * k + 2}});
  }
  const Hierarchy h = built(std::move(raw), *scheduler_, 5);
  ASSERT_GT(h.cells.size(), 8000u);
  const std::vector<double> errors(h.cells.size(), 0.0);
  const std::vector<TilesetFile> files = encode_tilesets(h, errors);
  EXPECT_EQ(files.size(), 1 + h.cells_of(1).size());
  for (const TilesetFile& file : files) {
    std::size_t tiles = 0;
    for (std::size_t at = 0; (at = file.json.find(".glb", at)) != std::string::npos; ++at) ++tiles;
    EXPECT_LT(tiles, 4096u) << file.path;
  }
}

TEST_F(SaveTiles, ErrorsCoverThoseOfCoarseTextures) {
  Hierarchy h = built(surface(), *scheduler_);
  const auto errors = [&] {
    const TileErrors of_cells(h);
    std::vector<double> all;
    for (CellId c{0}; c < h.cells.size(); ++c) all.push_back(of_cells.of(c));
    return all;
  };
  const std::vector<double> plain = errors();
  for (CellId c{0}; c < h.cells.size(); ++c)
    EXPECT_FLOAT_EQ(static_cast<float>(plain[c]), static_cast<float>(h.cells[c].error * h.transform.scale));
  // uv runs over the model's unit, 100 metres: a texel of a copy of 40 pixels is 2.5 metres where it is flat.
  h.texture_copies = {{0, 1, 40, 40, {}}};
  const std::vector<double> textured = errors();
  std::size_t larger = 0;
  for (CellId c{0}; c < h.cells.size(); ++c) {
    if (h.level_of(c) == h.finest()) {
      EXPECT_EQ(textured[c], 0);
    }
    EXPECT_GE(textured[c], plain[c]);
    if (textured[c] > plain[c]) {
      EXPECT_NEAR(textured[c], 3.1, 0.75);
    }
    larger += textured[c] > plain[c];
  }
  EXPECT_GT(larger, 0u);
}

// A flat surface loses nothing of its shape; every inner tile has an error nevertheless, which its texture gives.
TEST_F(SaveTiles, FlatTexturedTilesHaveErrors) {
  RawMesh raw = generate_mesh({Shape::terrain, 6000, 3});
  for (Vec3d& p : raw.positions) {
    raw.wedges.uv.push_back({static_cast<float>(p.x), static_cast<float>(p.y)});
    p.z = 0;
  }
  raw.wedges.material.assign(raw.triangles.size(), 0);
  const PixelImage image{.size = {400, 100}, .channels = 1, .pixels = std::vector<std::uint8_t>(40000)};
  raw.textures = {{.name = "t", .media_type = "image/png", .bytes = encode_image(image, "image/png")}};
  for (std::uint32_t Material::*use : {&Material::texture, &Material::normal_map}) {
    RawMesh copy = raw;
    copy.materials = {{.name = "m"}};
    copy.materials[0].*use = 0;
    const Hierarchy h = built(std::move(copy), *scheduler_);
    const TileErrors errors(h);
    std::size_t flat = 0;
    for (CellId c{0}; c < h.cells.size(); ++c) {
      const bool leaf = h.level_of(c) == h.finest();
      const double own = h.transform.scale * double{h.cells[c].error}, texel = std::sqrt(1.0 / 40000);
      flat += !leaf && own < texel;
      EXPECT_NEAR(errors.of(c), leaf ? 0 : std::max(own, texel), leaf ? 0 : 0.1 * texel) << h.level_of(c);
    }
    EXPECT_GT(flat, 0u);
  }
}

TEST_F(SaveTiles, CoarseLevelsLinkTheirCopies) {
  Hierarchy h = built(surface(), *scheduler_);
  h.texture_copies = {{0, 1, 64, 64, {'\xff', '\xd8', '\xff', '2'}}, {0, 2, 32, 32, {'\xff', '\xd8', '\xff', '3'}}};
  EXPECT_EQ(save(h).textures, 4u);
  const auto found = files();
  for (const auto& [name, bytes] : {std::pair{"0.jpg", '1'}, {"0_1.jpg", '2'}, {"0_2.jpg", '3'}})
    EXPECT_EQ(found.at(std::string("textures/") + name).back(), bytes);
  for (CellId c{0}; c < h.cells.size(); ++c) {
    const std::array links{"textures/0_2.jpg", "textures/0_2.jpg", "textures/0_1.jpg", "textures/0.jpg"};
    const std::string& glb = found.at(tile_path(h, c));
    if (glb.find("textures/0") == std::string::npos) continue;  // a cell of the other material
    EXPECT_NE(glb.find(links[static_cast<std::size_t>(h.level_of(c))]), std::string::npos) << tile_path(h, c);
  }
}

TEST_F(SaveTiles, OneCellIsOneTile) {
  RawMesh raw;
  raw.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  raw.triangles = {{{0, 1, 2}}};
  const Hierarchy h = built(std::move(raw), *scheduler_, 0);
  EXPECT_EQ(save(h).tiles, 1u);
  EXPECT_EQ(load_mesh(path(), *scheduler_).positions, (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST_F(SaveTiles, RefuseWhatFloatsCannotHold) {
  Hierarchy h = built(surface(), *scheduler_);
  h.transform.scale = 1e39;
  expect_error_of<InputError>([&] { return save(h); }, {"tiles", "so large", "scale the model"});
}

TEST_F(SaveTiles, NothingIsLeftWhenTheyEndEarly) {
  const Hierarchy h = built(surface(), *scheduler_);
  const CancelFlag cancel{true};
  SaveTilesConfig config;
  config.cancel = &cancel;
  EXPECT_THROW((void)save(h, config), Cancelled);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(SaveTiles, ProgressGoesToTheEnd) {
  const Hierarchy h = built(surface(), *scheduler_);
  double latest = 0;
  SaveTilesConfig config;
  config.progress = [&](double share) { latest = std::max(latest, share); };
  (void)save(h, config, 1);
  EXPECT_EQ(latest, 1);
}

TEST_F(SaveTiles, FoldersAreWholeOrNotThere) {
  const fs::path target = folder_.path() / "folder";
  { const AtomicFolder folder(target); }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
  {
    AtomicFolder folder(target);
    folder.add_folder("a/b");
    EXPECT_FALSE(fs::exists(target));
    folder.commit();
  }
  EXPECT_TRUE(fs::is_directory(target / "a/b"));
  EXPECT_THROW(AtomicFolder{target}, FileError);
  EXPECT_THROW(AtomicFolder{folder_.path() / "none" / "x"}, FileError);
  EXPECT_THROW(AtomicFolder{folder_.write("file", "x")}, FileError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 2);
}

}  // namespace
}  // namespace lodestone
