// Figures, signatures, atlases and thumbnails of tilesets, made for viewers.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "core/hierarchy/model/find_signatures.h"
#include "core/texture/image_codec.h"
#include "tests/parallel/saved_tiles.h"

namespace lodestone {
namespace {

using nlohmann::json;

json json_of_glb(const std::string& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, sizeof length);
  return json::parse(glb.substr(20, length));
}

// A viewer decides by the figures in the tileset what fits into its memory.
TEST_F(SaveTiles, FiguresForViewersAreThoseOfTheFiles) {
  Hierarchy h = built(surface(), *scheduler_);
  h.texture_copies = {{0, 1, 64, 32, {'\xff', '\xd8', '\xff', '2'}}};
  (void)save(h, {.tileset = {.morph = true}, .progress = {}});
  const auto found = files();
  const json tileset = json::parse(found.at("tileset.json"));
  EXPECT_EQ(tileset["extras"]["lodestone"]["texels"], (json{{"textures/0.jpg", 0}, {"textures/0_1.jpg", 2048}}));
  EXPECT_TRUE(tileset["extras"]["lodestone"]["thumbnails"].empty());  // this image cannot be decoded
  std::size_t textured = 0;
  const std::function<void(const json&)> visit = [&](const json& tile) {
    const json glb = json_of_glb(found.at(tile["content"]["uri"].get<std::string>()));
    const json& attributes = glb["meshes"][0]["primitives"][0]["attributes"];
    EXPECT_EQ(tile["extras"]["vertices"], glb["accessors"][attributes["POSITION"].get<std::size_t>()]["count"]);
    std::set<std::string> linked, told;
    for (const json& m : glb["materials"]) {
      if (!m["pbrMetallicRoughness"].contains("baseColorTexture")) continue;
      const json& texture = glb["textures"][m["pbrMetallicRoughness"]["baseColorTexture"]["index"].get<std::size_t>()];
      linked.insert(glb["images"][texture["source"].get<std::size_t>()]["uri"].get<std::string>().substr(3));
    }
    for (const json& path : tile["extras"].value("textures", json::array())) told.insert(path.get<std::string>());
    EXPECT_EQ(linked, told);
    textured += told.empty() ? 0 : 1;
    for (const json& child : tile.value("children", json::array())) visit(child);
  };
  visit(tileset["root"]);
  EXPECT_GT(textured, 5u);
}

// The places of vertices with their signatures in the hierarchy.
std::set<std::pair<std::array<float, 3>, std::size_t>> signed_places(const Cell& cell,
                                                                     std::span<const std::uint8_t> shared) {
  std::set<std::pair<std::array<float, 3>, std::size_t>> places;
  const std::size_t first = cell.first_shared();
  for (std::size_t v = 0; v < cell.positions.size(); ++v) {
    const Vec3f p = cell.positions[v];
    places.insert({{p.x, p.y, p.z}, v < first ? std::size_t{0} : shared[v - first]});
  }
  return places;
}

// The counts in each tile give its vertices the signatures that their places have in the hierarchy.
TEST_F(SaveTiles, VerticesAreSortedBySignature) {
  const Hierarchy h = built(surface(), *scheduler_);
  const Signatures signatures = find_signatures(h);
  (void)save(h, {.tileset = {.morph = true}, .progress = {}});
  const auto found = files();
  EXPECT_EQ(json::parse(found.at("tileset.json"))["extras"]["lodestone"]["signatures"], "signatures.json");
  EXPECT_EQ(found.at("signatures.json"), encode_signatures(h, signatures));
  std::size_t shared = 0;
  for (CellId c{1}; c < h.cells.size(); ++c) {
    const std::string& glb = found.at(tile_path(h, c));
    const json document = json_of_glb(glb), &mesh = document["meshes"][0];
    const json& positions = document["accessors"][mesh["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()];
    const json& view = document["bufferViews"][positions["bufferView"].get<std::size_t>()];
    const auto counts = mesh["extras"]["signatures"].get<std::vector<std::size_t>>();
    ASSERT_EQ(counts.size(), signatures.of(c).size());
    EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t{0}), positions["count"]);
    const auto places = signed_places(h.cells[c], signatures.places(c));
    std::uint32_t length = 0;
    std::memcpy(&length, glb.data() + 12, sizeof length);
    const char* next = glb.data() + 28 + length + view.value("byteOffset", 0) + positions.value("byteOffset", 0);
    for (std::size_t place = 0; place < counts.size(); ++place)
      for (std::size_t k = 0; k < counts[place]; ++k, next += sizeof(Vec3f)) {
        std::array<float, 3> position{};
        std::memcpy(position.data(), next, sizeof position);
        EXPECT_TRUE(places.contains({position, place})) << tile_path(h, c);
        shared += place > 0;
      }
  }
  EXPECT_GT(shared, 300u);
  (void)save(h);
  EXPECT_EQ(files().count("signatures.json"), 0u);  // other viewers have no use for it
}

// Tiles that morph are drawn at once, too, and viewers know the size of their atlases.
TEST_F(SaveTiles, MorphingTilesOfManyMaterialsHaveAnAtlas) {
  RawMesh raw = surface();
  const PixelImage grey{{16, 16}, 1, std::vector<std::uint8_t>(256, 200)};
  raw.textures = {{.name = "grey", .media_type = "image/png", .bytes = encode_image(grey, "image/png")}};
  raw.materials.assign(6, Material{});
  for (std::size_t m = 0; m < 6; ++m) {
    raw.materials[m].texture = 0;
    raw.materials[m].base_colour = {0.1f * static_cast<float>(m), 1, 1, 1};
  }
  for (std::size_t t = 0; t < raw.triangles.size(); ++t) raw.wedges.material[t] = static_cast<std::uint32_t>(t / 2 % 6);
  const Hierarchy h = built(std::move(raw), *scheduler_);
  const SavedTiles saved = save(h, {.tileset = {.morph = true}, .progress = {}});
  EXPECT_GT(saved.atlases, 50u);
  EXPECT_LE(saved.draws, saved.atlases + 4 * (saved.tiles - saved.atlases));
  const auto found = files();
  const json tileset = json::parse(found.at("tileset.json")), &texels = tileset["extras"]["lodestone"]["texels"];
  EXPECT_EQ(texels.size(), saved.atlases + 1);  // tiles of few materials share the texture itself
  for (const auto& [path, count] : texels.items()) {
    const PixelSize size = image_size(found.at(path), "image/png");
    EXPECT_EQ(count, size.width * size.height) << path;
  }
  const json glb = json_of_glb(found.at("1/0_0_0.glb")), root = json_of_glb(found.at("0/0_0_0.glb"));
  EXPECT_EQ(tileset["root"]["extras"]["textures"], json({"0/0_0_0_0.png"}));
  EXPECT_EQ(root["images"][0]["uri"], "0_0_0_0.png");
  EXPECT_EQ(root["meshes"][0]["primitives"].size(), 1u);
  EXPECT_TRUE(glb["meshes"][0]["primitives"][0]["attributes"].contains("_PARENTTEXCOORD"));
}

TEST_F(SaveTiles, ViewersHaveThumbnails) {
  Hierarchy h = built(surface(), *scheduler_);
  h.materials[0].texture = 1;
  const PixelImage large{{256, 128}, 3, std::vector<std::uint8_t>(std::size_t{256} * 128 * 3, 90)};
  for (const bool is_large : {false, true}) {
    if (is_large) h.textures[1].bytes = encode_image(large, "image/png");
    (void)save(h, {.tileset = {.morph = true}, .progress = {}});
    const auto found = files();
    const json figures = json::parse(found.at("tileset.json"))["extras"]["lodestone"];
    EXPECT_EQ(figures["thumbnails"],
              is_large ? json({{"textures/1.png", "textures/1_thumbnail.webp"}}) : json::object());
    if (is_large) {
      const std::string& small = found.at("textures/1_thumbnail.webp");
      EXPECT_EQ(image_size(small, "image/webp").width, 64u);
    }
  }
  EXPECT_EQ((save(h), files().count("textures/1_thumbnail.webp")), 0u);  // other viewers have no use for it
}

}  // namespace
}  // namespace lodestone
