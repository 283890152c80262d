// Attributes through the writers and back through our own readers.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <string_view>

#include "core/formats/mesh_file.h"
#include "core/hierarchy/model/level_mesh.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/mesh/load.h"
#include "tests/core/formats/io_test_util.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// The attributes that a format can store.
struct Carried {
  const char* extension;
  bool base_colour = false, normal_map = false, alpha = false;
};
constexpr Carried ply{.extension = ".ply", .alpha = true},
    obj{.extension = ".obj", .base_colour = true, .normal_map = true},
    glb{.extension = ".glb", .base_colour = true, .normal_map = true, .alpha = true};

// Everything that distinguishes a material in the file.
std::string signature(const RawMesh& mesh, std::uint32_t material, const Carried& carried) {
  if (material == no_material) return "none";
  const Material& m = mesh.materials[material];
  std::string text = "material";
  if (carried.base_colour)
    for (const float c : m.base_colour) text += " " + std::to_string(c);
  const auto add = [&](std::uint32_t texture) {
    text += "|";
    if (texture == no_texture) return;
    const Texture& t = mesh.textures[texture];
    text += t.media_type + std::to_string(t.bytes.size()) + " " +
            std::to_string(std::hash<std::string_view>()({t.bytes.data(), t.bytes.size()}));
  };
  add(m.texture);
  if (carried.normal_map) add(m.normal_map);
  return text;
}

// Formats may group triangles by material; within one they keep their order.
std::map<std::string, std::vector<std::size_t>> triangles_by_material(const RawMesh& mesh, const Carried& carried) {
  std::map<std::string, std::vector<std::size_t>> triangles;
  std::map<std::uint32_t, std::string> signatures;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t material = mesh.wedges.material.empty() ? no_material : mesh.wedges.material[t];
    std::string& text = signatures[material];
    if (text.empty()) text = signature(mesh, material, carried);
    // A material that says nothing in this format is as good as none.
    triangles[text == "material|" ? "none" : text].push_back(t);
  }
  return triangles;
}

void expect_equal_attributes(const RawMesh& a, const RawMesh& b, const Carried& carried) {
  EXPECT_EQ(b.warnings, std::vector<std::string>{});
  ASSERT_EQ(wedge_mistake(b), "");
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  EXPECT_EQ(a.wedges.uv.empty(), b.wedges.uv.empty());
  EXPECT_EQ(a.wedges.colour.empty(), b.wedges.colour.empty());
  EXPECT_EQ(a.wedges.normal.empty(), b.wedges.normal.empty());
  const auto in_a = triangles_by_material(a, carried), in_b = triangles_by_material(b, carried);
  ASSERT_EQ(in_a.size(), in_b.size());
  Vec3d lo = a.positions[0], hi = lo;
  for (const Vec3d p : a.positions) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  const double tolerance = 1e-6 * length(hi - lo);
  for (const auto& [name, triangles] : in_a) {
    ASSERT_TRUE(in_b.contains(name)) << name.substr(0, 60);
    const std::vector<std::size_t>& others = in_b.at(name);
    ASSERT_EQ(triangles.size(), others.size());
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t s = triangles[i], t = others[i];
        ASSERT_LE(length(a.positions[a.triangles[s].v[k]] - b.positions[b.triangles[t].v[k]]), tolerance);
        const CornerValues x = values_at(a, s, k), y = values_at(b, t, k);
        ASSERT_NEAR(x.uv.x, y.uv.x, 1e-6);
        ASSERT_NEAR(x.uv.y, y.uv.y, 1e-6);
        ASSERT_LE(length(x.normal - y.normal), 1e-6f);
        ASSERT_EQ((std::array{x.colour.r, x.colour.g, x.colour.b}), (std::array{y.colour.r, y.colour.g, y.colour.b}));
        if (carried.alpha) {
          ASSERT_EQ(x.colour.a, y.colour.a);
        }
      }
  }
}

class WriteAttributes : public testing::TestWithParam<Carried> {
 protected:
  void expect_round_trip(RawMesh mesh) {
    mesh.up = {UpAxis::y, false};  // as in glTF, whose files turn any other
    const fs::path path = folder_.path() / (std::string("a b#1") + GetParam().extension);
    write_mesh(path, mesh);
    expect_equal_attributes(mesh, read_mesh(path), GetParam());
    const auto scheduler = make_tbb_scheduler(2);
    expect_equal_attributes(mesh, load_mesh(path, *scheduler), GetParam());
  }
  TestFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(Formats, WriteAttributes, testing::Values(ply, obj, glb),
                         [](const auto& format) { return std::string(format.param.extension + 1); });

// A fan of triangles with everything that there is, each wedge its own values.
RawMesh everything(double offset) {
  RawMesh mesh;
  for (std::uint32_t i = 0; i < 40; ++i) {
    const float x = static_cast<float>(i) / 40;
    mesh.positions.push_back({offset + x, offset - i % 3, offset + 0.25 * (i % 5)});
    mesh.wedges.uv.push_back({x, i % 7 == 0 ? -2.5f : 1 - 0.3f * x});
    const Vec3f n{x, 1 - x, i % 2 == 0 ? 0.5f : -0.5f};
    mesh.wedges.normal.push_back(i == 13 ? Vec3f{} : (1 / length(n)) * n);
    const auto byte = [&](std::uint32_t k) { return static_cast<std::uint8_t>(i * k % 256); };
    mesh.wedges.colour.push_back({byte(7), byte(31), byte(101), byte(53)});
  }
  for (std::uint32_t i = 0; i + 2 < 40; ++i) {
    mesh.triangles.push_back({{i, i + 1, i + 2}});
    mesh.wedges.material.push_back(i % 5 == 4 ? no_material : i % 5);
  }
  const auto bytes = [](const std::string& text) { return std::vector<char>(text.begin(), text.end()); };
  mesh.textures = {{"wood", "image/png", TextureWrap::clamp, TextureWrap::clamp, bytes(png_bytes("wood"))},
                   {"bumps", "image/png", TextureWrap::repeat, TextureWrap::repeat, bytes(png_bytes("bumps"))},
                   {"stone", "image/jpeg", TextureWrap::repeat, TextureWrap::repeat, bytes("\xff\xd8\xffstone")}};
  mesh.materials = {{"plain", {1, 0.5f, 0.25f, 0.75f}, no_texture, no_texture},
                    {"", {1, 1, 1, 1}, 0, 1},
                    {"plain", {0.1f, 0.2f, 0.3f, 1}, 2, no_texture},
                    {"name with #\nblanks", {0.7f, 0.2f, 0.3f, 1}, 0, no_texture}};
  return mesh;
}

TEST_P(WriteAttributes, Everything) {
  if (GetParam().extension == ply.extension) {  // textures are all that PLY knows of materials
    RawMesh mesh = everything(0);
    mesh.materials[3].texture = no_texture;
    expect_round_trip(mesh);
  } else {
    for (const double offset : {0.0, 4e6}) expect_round_trip(everything(offset));
  }
}

TEST_P(WriteAttributes, Each) {
  const RawMesh all = everything(0);
  for (int kind = 0; kind < 8; ++kind) {
    RawMesh mesh;
    mesh.positions = all.positions;
    mesh.triangles = all.triangles;
    if (kind & 1) mesh.wedges.uv = all.wedges.uv;
    if (kind & 2) mesh.wedges.normal = all.wedges.normal;
    if (kind & 4) mesh.wedges.colour = all.wedges.colour;
    expect_round_trip(mesh);
  }
}

TEST_P(WriteAttributes, OneTexture) {
  RawMesh mesh = everything(0);
  mesh.materials = {{.name = "only", .texture = 0}};
  std::fill(mesh.wedges.material.begin(), mesh.wedges.material.end(), 0u);
  expect_round_trip(mesh);
}

TEST_P(WriteAttributes, FailuresLeaveNoFile) {
  fs::create_directories(folder_.path() / "m_0.png");  // an image cannot be written there
  fs::create_directories(folder_.path() / "m.glb");
  const fs::path path = folder_.path() / (std::string("m") + GetParam().extension);
  EXPECT_THROW(write_mesh(path, everything(0)), FileError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 2);
}

TEST(WriteObj, WedgesOfAPlaceAreOneVertex) {
  const TestFolder folder;
  RawMesh mesh = everything(0);
  mesh.wedges.colour.clear();
  for (std::size_t i = 0; i < 10; ++i) mesh.positions[i + 30] = mesh.positions[i];
  write_mesh(folder.path() / "m.obj", mesh);
  EXPECT_EQ(read_mesh(folder.path() / "m.obj").positions.size(), 30u);
}

TEST(WriteObj, MaterialsKeepTheirNames) {
  const TestFolder folder;
  write_mesh(folder.path() / "m.obj", everything(0));
  const RawMesh read = read_mesh(folder.path() / "m.obj");
  std::vector<std::string> names;
  for (const Material& m : read.materials) names.push_back(m.name);
  EXPECT_EQ(names, (std::vector<std::string>{"plain", "material_1", "plainmaterial_2", "name with __blanks"}));
  EXPECT_EQ(read.textures[0].wrap_u, TextureWrap::clamp);
  EXPECT_EQ(read.textures[1].wrap_u, TextureWrap::repeat);
}

// Every level of a built model, as `export` writes it.
TEST_P(WriteAttributes, LevelsOfTexturedModels) {
  const auto scheduler = make_tbb_scheduler(2);
  for (const char* name :
       {"textured/Gutenberg/Gutenberg.obj", "textured/spot/spot_triangulated.obj", "textured/Hermes/Hermes.obj",
        "textured/komaba_tiles_022", "textured/WaterBottle/WaterBottle.obj"}) {
    SCOPED_TRACE(name);
    LODESTONE_MODEL_OR_SKIP(path, name);
    Repairs repairs;
    BuildConfig config;
    config.finest_level = 2;
    const Hierarchy h =
        build_hierarchy(prepare_mesh(load_mesh(path, *scheduler), repairs, *scheduler), config, *scheduler);
    for (const int level : {0, 2}) {
      const RawMesh mesh = level_mesh(h, level);
      EXPECT_FALSE(mesh.wedges.uv.empty());
      expect_round_trip(mesh);
    }
  }
}

}  // namespace
}  // namespace lodestone
