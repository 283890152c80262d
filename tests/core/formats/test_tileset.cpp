// 3D Tiles: which tiles are the surface, and where they lie.
#include <gtest/gtest.h>

#include <map>

#include "core/formats/tiles/tileset.h"
#include "tests/core/formats/gltf_test_util.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

using nlohmann::json;

json tile(const std::string& uri, const std::vector<json>& children = {}, const json& more = json::object()) {
  json result = {{"geometricError", 1}};
  if (!uri.empty()) result["content"] = {{"uri", uri}};
  if (!children.empty()) result["children"] = children;
  result.update(more);
  return result;
}

std::string tileset(const json& root, const json& asset = {{"version", "1.1"}}) {
  return json{{"asset", asset}, {"geometricError", 2}, {"root", root}}.dump();
}

json translation(double x, double y, double z) {
  return {{"transform", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1}}};
}

class TilesetTest : public testing::Test {
 protected:
  TilesetTest() {
    for (const char* name : {"a.glb", "b.glb", "c.glb", "sub/d.glb"}) folder_.write(name, triangle_file().glb());
  }
  // Names of the chosen tiles, in order.
  std::vector<std::string> chosen(const std::string& text) {
    ByteReader input(folder_.write("tileset.json", text));
    std::vector<std::string> names;
    for (const Tile& t : list_tiles(input).tiles) names.push_back(t.file.filename().string());
    return names;
  }
  template <class E>
  void expect_refusal(const std::string& text, std::initializer_list<std::string_view> parts) {
    const auto path = folder_.write("tileset.json", text);
    expect_error_of<E>([&] { return read_mesh(path); }, parts, text);
  }
  TestFolder folder_;
};

using Names = std::vector<std::string>;

TEST_F(TilesetTest, TheFinestTilesAreTheSurface) {
  const std::vector<json> leaves = {tile("b.glb"), tile("c.glb")};
  EXPECT_EQ(chosen(tileset(tile("a.glb"))), (Names{"a.glb"}));
  EXPECT_EQ(chosen(tileset(tile("a.glb", leaves))), (Names{"b.glb", "c.glb"}));
  EXPECT_EQ(chosen(tileset(tile("a.glb", leaves, {{"refine", "ADD"}}))), (Names{"a.glb", "b.glb", "c.glb"}));
  EXPECT_EQ(chosen(tileset(tile("", leaves, {{"refine", "REPLACE"}}))), (Names{"b.glb", "c.glb"}));
  // Children without content refine nothing; those of a child without content do.
  EXPECT_EQ(chosen(tileset(tile("a.glb", {tile(""), tile("")}))), (Names{"a.glb"}));
  EXPECT_EQ(chosen(tileset(tile("a.glb", {tile("", {tile("b.glb")})}))), (Names{"b.glb"}));
  // Refinement is inherited, and may change on the way.
  EXPECT_EQ(
      chosen(tileset(tile("a.glb", {tile("b.glb", {tile("c.glb")}, {{"refine", "REPLACE"}})}, {{"refine", "ADD"}}))),
      (Names{"a.glb", "c.glb"}));
  EXPECT_EQ(chosen(tileset(tile("", {}, {{"contents", {{{"uri", "a.glb"}}, {{"uri", "b.glb?v=2"}}}}}))),
            (Names{"a.glb", "b.glb"}));
  EXPECT_EQ(chosen(tileset({{"content", {{"url", "sub/d.glb"}}}})), (Names{"d.glb"})) << "as 3D Tiles 0.0 wrote it";
}

TEST_F(TilesetTest, TransformsMultiplyDownTheTreeAndYBecomesZ) {
  // Scaled by 2 and moved far away, as on the Earth.
  const json far = {{"transform", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 4e6, 0, 0, 1}}};
  const auto path = folder_.write("tileset.json", tileset(tile("", {tile("a.glb", {}, translation(1, 2, 3))}, far)));
  const std::vector<Vec3d> expected{{4e6 + 2, 4, 6}, {4e6 + 4, 4, 6}, {4e6 + 2, 4, 8}};
  EXPECT_EQ(read_mesh(path).positions, expected);
  EXPECT_EQ(read_mesh(folder_.path()).positions, expected) << "a folder with a tileset.json";
  const auto positions_of = [&](const char* axis) {
    return read_mesh(folder_.write("t.json", tileset(tile("a.glb"), {{"version", "1.0"}, {"gltfUpAxis", axis}})))
        .positions;
  };
  EXPECT_EQ(positions_of("Z"), (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(positions_of("X"), (std::vector<Vec3d>{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}}));
}

TEST_F(TilesetTest, ExternalTilesetsAreFollowed) {
  folder_.write("sub/inner.json", tileset(tile("d.glb", {}, translation(0, 0, 5))));
  const auto path = folder_.write(
      "tileset.json", tileset(tile("", {tile("sub/inner.json", {}, translation(10, 0, 0)), tile("a.glb")})));
  const RawMesh mesh = read_mesh(path);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.positions[0], (Vec3d{10, 0, 5}));
}

std::string b3dm(const std::string& features, const std::string& model) {
  Bytes bytes("b3dm");
  bytes.put(std::uint32_t{1}).put(static_cast<std::uint32_t>(28 + features.size() + 4 + model.size()));
  bytes.put(static_cast<std::uint32_t>(features.size()))
      .put(std::uint32_t{0})
      .put(std::uint32_t{4})
      .put(std::uint32_t{0});
  return bytes.str() + features + "{}  " + model;
}

TEST_F(TilesetTest, BatchedModels) {
  const std::string model = triangle_file().glb();
  folder_.write("a.b3dm", b3dm(R"({"BATCH_LENGTH":0,"RTC_CENTER":[100,200,300]})", model));
  folder_.write("b.b3dm", b3dm("", model));
  const RawMesh mesh = read_mesh(
      folder_.write("tileset.json", tileset(tile("", {tile("a.b3dm"), tile("b.b3dm")}, translation(1, 0, 0)))));
  EXPECT_EQ(mesh.positions[2], (Vec3d{101, 200, 301}));
  EXPECT_EQ(mesh.positions[5], (Vec3d{1, 0, 1}));

  const std::string one = tileset(tile("bad.b3dm")), whole = b3dm("{}", model);
  for (const std::size_t size : {4u, 27u, 28u, 40u, 80u}) {
    folder_.write("bad.b3dm", whole.substr(0, size));
    expect_refusal<InputError>(one, {"bad.b3dm", "byte"});
  }
  folder_.write("bad.b3dm", "b3dm" + Bytes().put(std::uint32_t{2}).str() + whole.substr(8));
  expect_refusal<UnsupportedError>(one, {"bad.b3dm", "version 2"});
  folder_.write("bad.b3dm", b3dm("{\"RTC_CENTER\":[1]}", model));
  expect_refusal<InputError>(one, {"bad.b3dm", "feature table.RTC_CENTER", "3 numbers"});
}

TEST_F(TilesetTest, Errors) {
  expect_refusal<InputError>("{", {"tileset.json", "invalid JSON"});
  expect_refusal<InputError>("{}", {"no 'asset'"});
  expect_refusal<InputError>(R"({"asset": {"version": "1.0"}})", {"no 'root'"});
  expect_refusal<UnsupportedError>(tileset(tile("a.glb"), {{"version", "2.0"}}), {"asset", "'2.0'"});
  expect_refusal<FileError>(tileset(tile("", {tile("no.glb")})),
                            {"root.children[0].content.uri", "'no.glb'", "cannot be found"});
  expect_refusal<FileError>(tileset(tile("/etc/hostname")), {"'/etc/hostname'", "outside", "--allow-outside"});
  expect_refusal<InputError>(tileset(tile("a.glb", {}, {{"refine", "MIX"}})), {"root", "'MIX'"});
  expect_refusal<InputError>(tileset(tile("a.glb", {}, {{"transform", {1, 2}}})), {"root.transform", "16 numbers"});
  expect_refusal<InputError>(tileset({{"content", {{"link", "a.glb"}}}}), {"root.content", "no 'url'"});
  expect_refusal<UnsupportedError>(tileset(tile("a.glb", {}, {{"implicitTiling", json::object()}})),
                                   {"implicit tiling"});
  expect_refusal<InputError>(tileset(tile("tileset.json")), {"256", "refer to itself"});
  expect_refusal<InputError>(tileset(tile("")), {"has no triangle"});
  folder_.write("bad.glb", triangle_file().glb().substr(0, 100));
  expect_refusal<InputError>(tileset(tile("bad.glb")), {"bad.glb", "byte 8"});
}

// Each of 25 files names the next one twice: 2^25 tiles, of which none may be read before that is refused. A tileset
// used many times beside each other is valid.
TEST_F(TilesetTest, TilesetsThatDoubleOverAndOver) {
  for (int i = 0; i < 25; ++i) {
    const std::string next = std::to_string(i + 1) + ".json";
    folder_.write(std::to_string(i) + ".json", tileset(tile("", {tile(next), tile(next)})));
  }
  folder_.write("25.json", tileset(tile("a.glb")));
  expect_refusal<InputError>(tileset(tile("0.json")), {"27 tilesets", "more than 1000 times"});
  EXPECT_EQ(chosen(tileset(tile("20.json"))).size(), 32u);
}

TEST_F(TilesetTest, OtherContentsAreWarnings) {
  folder_.write("p.pnts", "pnts");
  const RawMesh mesh = read_mesh(folder_.write("tileset.json", tileset(tile("", {tile("p.pnts"), tile("a.glb")}))));
  expect_warning(mesh, {"tileset.json: root.children[0].content.uri", "'p.pnts'", "left out"});
  EXPECT_EQ(mesh.triangles.size(), 1u);
}

TEST(Tileset, RealTilesHaveTheTrianglesOfTheirDataSheet) {
  LODESTONE_MODEL_OR_SKIP(path, "textured/komaba_tiles_022");
  const RawMesh mesh = read_mesh(path);
  EXPECT_EQ(wedge_mistake(mesh), "");
  EXPECT_EQ(mesh.triangles.size(), 125253u);
  EXPECT_TRUE(mesh.warnings.empty());
  EXPECT_EQ(mesh.textures.size(), 27u);
  EXPECT_EQ(mesh.wedges.uv.size(), mesh.positions.size());
  // The box of the root tile, turned and moved by its transform: 4e6 m from the centre of the Earth.
  for (const Vec3d p : mesh.positions) {
    EXPECT_NEAR(p.x, -3955963 + 19.3 + 19.8 - 14.2 + 13.8, 60);
    EXPECT_NEAR(length(p), 6.37e6, 5e4);
  }
}

}  // namespace
}  // namespace lodestone
