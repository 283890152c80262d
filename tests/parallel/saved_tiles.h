// A surface with materials and textures, and tilesets of it in a folder.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save_tiles.h"
#include "tests/core/formats/io_test_util.h"

namespace lodestone {

namespace fs = std::filesystem;

// Terrain in the sky over Tokyo, with texture coordinates, colours, and materials that meet along seams.
inline RawMesh surface() {
  RawMesh raw = generate_mesh({Shape::terrain, 6000, 3});
  for (Vec3d& p : raw.positions) {
    raw.wedges.uv.push_back({static_cast<float>(p.x), static_cast<float>(-p.y)});
    raw.wedges.colour.push_back({static_cast<std::uint8_t>(255 * p.x), static_cast<std::uint8_t>(255 * p.y), 7, 200});
    p = Vec3d{-3957000, 3351000, 3697000} + 100.0 * p;
  }
  for (std::size_t t = 0; t < raw.triangles.size(); ++t)
    raw.wedges.material.push_back(t < 1000 ? no_material : t < 3000 ? 0u : 1u);
  raw.textures = {{.name = "photo", .media_type = "image/jpeg", .bytes = {'\xff', '\xd8', '\xff', '1'}},
                  {.name = "bumps", .media_type = "image/png", .bytes = {}}};
  const std::string png = png_bytes();
  raw.textures[1].bytes.assign(png.begin(), png.end());
  raw.materials = {{.name = "a", .texture = 0, .normal_map = 1}, {.name = "b", .base_colour = {1, 0, 0.5f, 1}}};
  return raw;
}

inline Hierarchy built(RawMesh&& raw, Scheduler& scheduler, int levels = 3) {
  Repairs repairs;
  BuildConfig config;
  config.finest_level = levels;
  return build_hierarchy(prepare_mesh(std::move(raw), repairs, scheduler), config, scheduler);
}

class SaveTiles : public testing::Test {
 protected:
  SavedTiles save(const Hierarchy& h, const SaveTilesConfig& config = {}, int threads = 2) {
    const auto scheduler = make_tbb_scheduler(threads);
    fs::remove_all(path());
    AtomicFolder folder(path());
    const SavedTiles saved = save_tiles(h, folder, *scheduler, config);
    folder.commit();
    std::uint64_t bytes = 0;
    for (const auto& [path, content] : files()) bytes += content.size();
    EXPECT_EQ(saved.bytes, bytes);
    return saved;
  }
  [[nodiscard]] fs::path path() const { return folder_.path() / "tiles"; }
  [[nodiscard]] std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> contents;
    for (const auto& entry : fs::recursive_directory_iterator(path())) {
      if (entry.is_regular_file()) contents[fs::relative(entry.path(), path()).string()] = content(entry.path());
    }
    return contents;
  }
  std::unique_ptr<Scheduler> scheduler_ = make_tbb_scheduler(2);
  TestFolder folder_;
};

}  // namespace lodestone
