// Attributes and materials of OBJ files, and what is said when something about them is wrong.
#include <gtest/gtest.h>

#include <string>

#include "core/formats/common/companion_files.h"
#include "tests/core/formats/io_test_util.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

constexpr auto obj = MeshFormat::obj;
const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\nvn 0 0 2\n";

TEST(ObjAttributes, CornersShareWedgesUnlessTheyDiffer) {
  // The second triangle has another texture coordinate at vertex 1, the same at vertex 3.
  const RawMesh mesh = read_bytes(square + "f 1/1/1 2/2/1 3/3/1\nf 1/5/1 3/3/1 4/4/1\n", obj);
  EXPECT_EQ(wedge_count(mesh), 5u);
  EXPECT_EQ(values_at(mesh, 0, 0).uv, (Vec2f{0, 1})) << "the image's upper left is (0, 0)";
  EXPECT_EQ(values_at(mesh, 1, 0).uv, (Vec2f{0.5f, 0.5f}));
  EXPECT_EQ(mesh.wedges.corners[0].v[2], mesh.wedges.corners[1].v[1]);
  EXPECT_EQ(values_at(mesh, 0, 1).normal, (Vec3f{0, 0, 1}));
  EXPECT_TRUE(mesh.wedges.colour.empty());
  EXPECT_TRUE(mesh.wedges.material.empty());
}

TEST(ObjAttributes, EqualValuesOfSeveralIndicesAreOneWedge) {
  const RawMesh mesh = read_bytes(square + "vt 0 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/6 3/7 4/4\n", obj);
  EXPECT_EQ(wedge_count(mesh), 4u);
}

TEST(ObjAttributes, PolygonsKeepTheValuesOfTheirCorners) {
  const RawMesh mesh = read_bytes(square + "f 1 2 3\nf 1/1 2/2 3/3 4/4\nf 1//1 2//-1 3\n", obj);
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(values_at(mesh, 0, 1).uv, Vec2f{}) << "no texture coordinates before the first face that has some";
  EXPECT_EQ(values_at(mesh, 2, 0).uv, (Vec2f{0, 1}));
  EXPECT_EQ(values_at(mesh, 2, 1).uv, (Vec2f{1, 0}));
  EXPECT_EQ(values_at(mesh, 2, 2).uv, (Vec2f{0, 0}));
  EXPECT_EQ(values_at(mesh, 3, 1).normal, (Vec3f{0, 0, 1}));
  EXPECT_EQ(values_at(mesh, 3, 2).normal, Vec3f{});
}

TEST(ObjAttributes, FollowTheCutOfAPolygonThatIsNotConvex) {
  const RawMesh mesh = read_bytes(
      "v 0.5 0.5 0\nv 0 0 0\nv 0.5 -0.5 0\nv 0.25 0 0\nvt 0 0\nvt 0.5 -0.5\nvt 0.25 0\nvt 0.5 0.5\nvn 0 1 0\n"
      "f 1 2 3\nf 1/4 2/1 3/2/1 4/3\n",
      obj);
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangles[1], (Triangle{{3, 0, 1}}));
  for (std::size_t t = 1; t < 3; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = mesh.positions[mesh.triangles[t].v[k]];
      EXPECT_EQ(values_at(mesh, t, k).uv, (Vec2f{static_cast<float>(p.x), static_cast<float>(1 - p.y)}));
      EXPECT_EQ(values_at(mesh, t, k).normal, (p.y < 0 ? Vec3f{0, 1, 0} : Vec3f{}));
    }
}

TEST(ObjAttributes, ColoursBehindPositions) {
  const RawMesh mesh = read_bytes("v 0 0 0 1 0 0.5\nv 1 0 0\nv 0 1 0 1.0 0 2 -1\nv 5 5 5 1.0\nf 1 2 3\n", obj);
  EXPECT_EQ(mesh.wedges.colour, (std::vector<Rgba8>{{255, 0, 128, 255}, {}, {0, 255, 0, 255}, {}}));
  EXPECT_TRUE(mesh.wedges.corners.empty()) << "one wedge per vertex";
  const RawMesh seam = read_bytes("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n", obj);
  EXPECT_EQ(values_at(seam, 0, 0).colour, (Rgba8{255, 0, 0, 255}));
  EXPECT_EQ(values_at(seam, 0, 1).colour, Rgba8{});
}

TEST(ObjAttributes, AreLeftOutWhenNotAskedFor) {
  const std::string text = square + "mtllib none.mtl\nusemtl m\nf 1/1/1 2/2/x 3/9/1\n";
  const RawMesh mesh = read_bytes(text, obj, {.attributes = false});
  EXPECT_EQ(wedge_count(mesh), 0u);
  EXPECT_TRUE(mesh.wedges.corners.empty() && mesh.materials.empty() && mesh.warnings.empty());
}

TEST(ObjAttributes, WrongIndices) {
  const RawMesh mesh = read_bytes(square + "f 1/1/1 2/6/1 3/3/2\n", obj);
  expect_warning(mesh, {"file: line 11", "texture coordinate index 6", "has 5", "1 corners"});
  expect_warning(mesh, {"file: line 11", "normal index 2", "has 1"});
  EXPECT_EQ(values_at(mesh, 0, 1).uv, Vec2f{});
  EXPECT_EQ(values_at(mesh, 0, 2).normal, Vec3f{});
  EXPECT_EQ(wedge_count(read_bytes("f 1/1 2/1 3/1\n" + square, obj)), 3u) << "values may come after faces";
  expect_error<InputError>(square + "f 1/x 2 3\n", obj, {"line 11", "texture coordinate index", "'x'"});
  expect_error<InputError>(square + "f 1/0 2 3\n", obj, {"line 11", "texture coordinate index 0"});
  expect_error<InputError>(square + "f 1//-2 2 3\n", obj, {"line 11", "normal index -2"});
  expect_error<InputError>("vt\n" + square, obj, {"line 1", "texture coordinate"});
  expect_error<InputError>("vn 0 0\n" + square, obj, {"line 1", "z component"});
}

class ObjMaterialsTest : public testing::Test {
 protected:
  RawMesh read(const std::string& obj_text) {
    const RawMesh mesh = read_mesh(folder_.write("m.obj", square + obj_text));
    EXPECT_EQ(wedge_mistake(mesh), "");
    return mesh;
  }
  TestFolder folder_;
};

TEST_F(ObjMaterialsTest, SeveralWithTexturesAndOptions) {
  folder_.write("my textures.mtl",
                "# comment\nKd 1 1 1\nnewmtl red wall\nKd 1 0 0.25\nd 0.5\nmap_Kd -clamp on -s 1 1 1 -bm 2 a b.png\r\n"
                "newmtl plain\nKd 0.5\nTr 0.25\nillum 2\nmap_Bump -bm 1 sub\\n.png\n"
                "newmtl other\nKd spectral x.rfl\nmap_Kd a b.png\nnorm a b.png\nbump sub/n.png\n");
  folder_.write("a b.png", png_bytes("1"));
  folder_.write("sub/n.png", "\xff\xd8\xff jpeg");
  const RawMesh mesh = read(
      "mtllib my textures.mtl\nf 1 2 3\nusemtl red wall\nf 1/1 2/2 3/3 4/4\nusemtl plain\nf 1 2 3\n"
      "usemtl other\nf 1 2 4\nusemtl red wall\nf 2 3 4\n");
  EXPECT_TRUE(mesh.warnings.empty());
  EXPECT_EQ(mesh.wedges.material, (std::vector<std::uint32_t>{no_material, 0, 0, 1, 2, 0}));
  ASSERT_EQ(mesh.materials.size(), 3u);
  Material red{"red wall", {1, 0, 0.25f, 0.5f}, 0, no_texture},
      plain{"plain", {0.5f, 0.5f, 0.5f, 0.75f}, no_texture, 1};
  red.alpha_mode = plain.alpha_mode = AlphaMode::blend;
  EXPECT_EQ(mesh.materials[0], red);
  EXPECT_EQ(mesh.materials[1], plain);
  EXPECT_EQ(mesh.materials[2], (Material{"other", {1, 1, 1, 1}, 2, 2})) << "one image, twice: it wraps in two ways";
  ASSERT_EQ(mesh.textures.size(), 3u);
  EXPECT_EQ(mesh.textures[0].media_type, "image/png");
  EXPECT_EQ(mesh.textures[0].wrap_u, TextureWrap::clamp);
  EXPECT_EQ(std::string(mesh.textures[0].bytes.begin(), mesh.textures[0].bytes.end()), png_bytes("1"));
  EXPECT_EQ(mesh.textures[1].media_type, "image/jpeg");
  EXPECT_EQ(mesh.textures[2].wrap_u, TextureWrap::repeat);
}

TEST_F(ObjMaterialsTest, LightMetalAndWhatHasNoPlace) {
  folder_.write("m.mtl",
                "newmtl lamp\nKe 1 0.5 0\nmap_Ke e.png\nPr 0.25\nPm 1\nnorm -bm 0.5 n.png\n"
                "newmtl glow\nmap_Ke e.png\nKs 0 0 0\nTf 1 1 1\nmap_Kd -o 0 0 -s 1 1 n.png\n"
                "newmtl shiny\nKs 0.5 0.5 0.5\nNs 10\nmap_Ks e.png\nmap_d e.png\ndisp e.png\nmap_Kd -s 2 2 n.png\n"
                "newmtl wet\nKs 1 1 1\nTf 1 0.5 1\nmap_Pr e.png\nPc 0.5\nNi 1.3\nKa 1 1 1\n"
                "newmtl unused\nrefl e.png\n");
  folder_.write("e.png", png_bytes("1"));
  folder_.write("n.png", png_bytes("2"));
  const RawMesh mesh =
      read("mtllib m.mtl\nusemtl lamp\nf 1 2 3\nusemtl glow\nf 1 2 3\nusemtl shiny\nf 1 2 3\nusemtl wet\nf 1 2 4\n");
  ASSERT_EQ(mesh.materials.size(), 4u);
  const Material &lamp = mesh.materials[0], &glow = mesh.materials[1];
  EXPECT_EQ(lamp.emissive, (std::array<float, 3>{1, 0.5f, 0}));
  EXPECT_EQ(mesh.textures[lamp.emissive_map.texture].name, "e.png");
  EXPECT_EQ(lamp.roughness, 0.25f);
  EXPECT_EQ(lamp.metallic, 1);
  EXPECT_EQ(lamp.normal_scale, 0.5f);
  EXPECT_TRUE(lamp.double_sided);
  EXPECT_EQ(lamp.alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(glow.emissive, (std::array<float, 3>{1, 1, 1}));
  // One note for each kind of statement, with the number of materials in use that it concerns.
  const auto note = [](const char* what, const char* of) { return std::string("m.obj: ") + what + of + " left out"; };
  std::vector<std::string> notes;
  for (const std::string& w : mesh.warnings) notes.push_back(w.substr(w.find("m.obj")));
  EXPECT_EQ(notes, (std::vector<std::string>{note("colours of highlights (Ks)", " of 2 materials are"),
                                             note("displacement maps (disp)", " of 1 material is"),
                                             note("filters of light (Tf)", " of 1 material is"),
                                             note("maps of highlights (map_Ks, map_Ns)", " of 1 material is"),
                                             note("maps of opacity (map_d)", " of 1 material is"),
                                             note("maps of roughness and metal (map_Pr, map_Pm)", " of 1 material is"),
                                             note("places and scales of maps (-o, -s, -t)", " of 1 material is"),
                                             note("sheen and clear coats (Ps, Pc, Pcr)", " of 1 material is")}));
}

TEST_F(ObjMaterialsTest, SeveralLibrariesAndNamesFromOtherMachines) {
  folder_.write("a.mtl", "newmtl a\nmap_Kd C:\\models\\wall.png\n");
  folder_.write("b.mtl", "newmtl b\nmap_Kd /models/of/others/wall.png\nnewmtl a\nKd 0 0 0\n");
  folder_.write("wall.png", png_bytes());
  const RawMesh mesh = read("mtllib a.mtl b.mtl\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n");
  EXPECT_TRUE(mesh.warnings.empty());
  EXPECT_EQ(mesh.textures.size(), 1u) << "the same image";
  EXPECT_EQ(mesh.materials[0].base_colour[0], 1) << "the first of a name counts";
}

TEST_F(ObjMaterialsTest, WhatIsMissingIsAWarningAndTheSurfaceStays) {
  const RawMesh none = read("mtllib no.mtl\nusemtl m\nf 1 2 3\n");
  expect_warning(none, {"m.obj: line 11", "'no.mtl'", "cannot be found"});
  EXPECT_EQ(none.materials, (std::vector<Material>{{.name = "m"}}));
  EXPECT_EQ(none.triangles.size(), 1u);

  folder_.write("t.mtl", "newmtl m\nmap_Kd no.jpg\nnewmtl n\nmap_Kd text.png\n");
  folder_.write("text.png", "root:x:0:0::/:/bin/sh");
  const RawMesh textures = read("mtllib t.mtl\nusemtl m\nf 1 2 3\nusemtl n\nf 1 3 4\nusemtl m\nf 1 3 4\n");
  expect_warning(textures, {"m.obj: line 12", "t.mtl: line 2", "'no.jpg'", "cannot be found"});
  expect_warning(textures, {"t.mtl: line 4", "'text.png'", "not a PNG, JPEG"});
  EXPECT_EQ(textures.warnings.size(), 2u);
  for (const Material& material : textures.materials) EXPECT_EQ(material.base_colour, missing_texture_colour);
  EXPECT_TRUE(textures.textures.empty());

  folder_.write("bad.mtl", "newmtl m\nKd red\n");
  expect_warning(read("mtllib bad.mtl\nusemtl m\nf 1 2 3\n"), {"bad.mtl: line 2", "red component", "white"});
  folder_.write("empty.mtl", "newmtl m\nmap_Kd -clamp on\n");
  const RawMesh twice = read("mtllib bad.mtl\nmtllib ./bad.mtl\nusemtl m\nf 1 2 3\n");
  EXPECT_EQ(std::ranges::count_if(twice.warnings, [](const std::string& w) { return w.find("red component") != std::string::npos; }), 1);
  expect_warning(read("mtllib empty.mtl\nusemtl m\nf 1 2 3\n"), {"empty.mtl: line 2", "without a file name"});
}

TEST(ObjAttributes, RealModelsHaveTheWedgesOfTheirDataSheet) {
  struct Expected {
    const char* name;
    std::size_t wedges, textures;
  };
  for (const Expected& e :
       {Expected{"meshroom_esp32cam/texturedMesh.obj", 34478, 1}, Expected{"Nymph/Nymph.obj", 22902, 1},
        Expected{"Hermes/Hermes.obj", 11114, 2}, Expected{"spot/spot_triangulated.obj", 3225, 0},
        Expected{"ycb_Banana/textured_simple_reoriented.obj", 10710, 1}, Expected{"Column03/Column03.obj", 7414, 2}}) {
    LODESTONE_MODEL_OR_SKIP(path, std::string("textured/") + e.name);
    const RawMesh mesh = read_mesh(path);
    EXPECT_EQ(wedge_mistake(mesh), "") << path;
    EXPECT_EQ(wedge_count(mesh), e.wedges) << path;
    EXPECT_EQ(mesh.textures.size(), e.textures) << path;
    for (const std::string& w : mesh.warnings) EXPECT_NE(w.find("left out"), std::string::npos) << w;
  }
}

}  // namespace
}  // namespace lodestone
