// Attributes of PLY and Draco files.
#include <draco/attributes/geometry_attribute.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>

#include <string>

#include "core/formats/common/companion_files.h"
#include "tests/core/formats/io_test_util.h"

namespace lodestone {
namespace {

constexpr auto ply = MeshFormat::ply;

const std::string attributes =
    "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n"
    "property uchar blue\nproperty uchar alpha\nproperty float s\nproperty float t\n";

std::string header(const std::string& format, const std::string& vertex, const std::string& face = "",
                   const std::string& comments = "") {
  return "ply\nformat " + format + " 1.0\n" + comments +
         "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n" + vertex +
         "element face 1\nproperty list uchar int vertex_indices\n" + face + "end_header\n";
}

void expect_attributes(const RawMesh& mesh) {
  EXPECT_EQ(mesh.wedges.normal, (std::vector<Vec3f>{{0, 0, 1}, {0, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(mesh.wedges.colour, (std::vector<Rgba8>{{1, 2, 3, 4}, {5, 6, 7, 8}, {255, 0, 9, 255}}));
  EXPECT_EQ(mesh.wedges.uv, (std::vector<Vec2f>{{0.25f, 0.5f}, {0, 1}, {1, 0}}));
  EXPECT_TRUE(mesh.wedges.corners.empty());
}

TEST(PlyAttributes, TextAndBinaryOfEitherByteOrder) {
  expect_attributes(read_bytes(header("ascii", attributes) + "0 0 0 0 0 9 1 2 3 4 0.25 0.5\n1 0 0 0 0 0 5 6 7 8 0 0\n"
                                                             "0 1 0 3 0 0 255 0 9 255 1 1\n3 0 1 2\n",
                               ply));
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    Bytes bytes(header(order == std::endian::big ? "binary_big_endian" : "binary_little_endian", attributes), order);
    const auto vertex = [&](std::array<float, 6> a, std::array<std::uint8_t, 4> c, float s, float t) {
      for (const float value : a) bytes.put(value);
      for (const std::uint8_t value : c) bytes.put(value);
      bytes.put(s).put(t);
    };
    vertex({0, 0, 0, 0, 0, 9}, {1, 2, 3, 4}, 0.25f, 0.5f);
    vertex({1, 0, 0, 0, 0, 0}, {5, 6, 7, 8}, 0, 0);
    vertex({0, 1, 0, 3, 0, 0}, {255, 0, 9, 255}, 1, 1);
    bytes.put(std::uint8_t{3}).put(0).put(1).put(2);
    expect_attributes(read_bytes(bytes.str(), ply));
    const RawMesh plain = read_bytes(bytes.str(), ply, {.attributes = false});
    EXPECT_EQ(wedge_count(plain), 0u);
    EXPECT_EQ(plain.positions.size(), 3u);
  }
}

TEST(PlyAttributes, NamesAndTypes) {
  for (const std::string names : {"u v", "texture_u texture_v", "s t"}) {
    const std::string u = names.substr(0, names.find(' ')), v = names.substr(names.find(' ') + 1);
    const RawMesh mesh = read_bytes(header("ascii", "property double " + u + "\nproperty float " + v + "\n") +
                                        "0 0 0 0.5 1\n1 0 0 0 0\n0 1 0 0 0\n3 0 1 2\n",
                                    ply);
    EXPECT_EQ(mesh.wedges.uv, (std::vector<Vec2f>{{0.5f, 0}, {0, 1}, {0, 1}}));
  }
  const auto colour = [](const std::string& type, const std::string& values) {
    const RawMesh mesh = read_bytes(
        header("ascii", "property " + type + " red\nproperty " + type + " green\nproperty " + type + " blue\n") +
            "0 0 0 " + values + "\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n",
        ply);
    return mesh.wedges.colour.at(0);
  };
  EXPECT_EQ(colour("float", "0 0.5 2"), (Rgba8{0, 128, 255, 255}));
  EXPECT_EQ(colour("ushort", "0 32896 65535"), (Rgba8{0, 128, 255, 255}));
  EXPECT_EQ(colour("int", "-5 128 999"), (Rgba8{0, 128, 255, 255}));
  EXPECT_EQ(colour("float", "nan 0 0"), (Rgba8{0, 0, 0, 255}));
}

TEST(PlyAttributes, IncompleteOnesAreNone) {
  const RawMesh mesh = read_bytes(header("ascii",
                                         "property float nx\nproperty float ny\nproperty uchar red\n"
                                         "property float s\nproperty list uchar float t\n") +
                                      "0 0 0 1 2 3 4 1 5\n1 0 0 1 2 3 4 0\n0 1 0 1 2 3 4 2 5 6\n3 0 1 2\n",
                                  ply);
  EXPECT_EQ(wedge_count(mesh), 0u);
}

class PlyTextures : public testing::Test {
 protected:
  // Two triangles and a quad around a seam, as MeshLab writes them.
  static std::string textured(const std::string& face_properties, const std::string& faces, const std::string& vertex,
                              const std::string& vertices) {
    return "ply\nformat ascii 1.0\ncomment TextureFile a.png\ncomment TextureFile b c.png\n"
           "comment " +
           std::string(5000, 'x') +
           "\nelement vertex 4\nproperty float x\nproperty float y\n"
           "property float z\n" +
           vertex + "element face 3\nproperty list uchar int vertex_indices\n" + face_properties + "end_header\n" +
           vertices + faces;
  }
  RawMesh read(const std::string& text) {
    folder_.write("a.png", png_bytes("a"));
    folder_.write("b c.png", png_bytes("b"));
    const RawMesh mesh = read_mesh(folder_.write("m.ply", text));
    EXPECT_EQ(wedge_mistake(mesh), "");
    return mesh;
  }
  TestFolder folder_;
};

TEST_F(PlyTextures, CoordinatesFollowTheCutOfAPolygonThatIsNotConvex) {
  const RawMesh mesh = read(textured("property list uchar float texcoord\n",
                                     "4 0 1 2 3 8 0.5 0.5 0 0 0.5 -0.5 0.25 0\n3 0 1 2 0\n4 3 2 1 0 0\n", "",
                                     "0.5 0.5 0\n0 0 0\n0.5 -0.5 0\n0.25 0 0\n"));
  ASSERT_EQ(mesh.triangles.size(), 5u);
  EXPECT_EQ(mesh.triangles[0], (Triangle{{3, 0, 1}}));
  for (std::size_t t = 0; t < 2; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = mesh.positions[mesh.triangles[t].v[k]];
      EXPECT_EQ(values_at(mesh, t, k).uv, (Vec2f{static_cast<float>(p.x), static_cast<float>(1 - p.y)}));
    }
}

TEST_F(PlyTextures, CoordinatesAndNumbersOfFaces) {
  const RawMesh mesh = read(textured("property list uchar float texcoord\nproperty int texnumber\n",
                                     "3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 6 0.5 0.5 1 1 0 1 1\n4 0 1 2 3 0 7\n",
                                     "property float nx\nproperty float ny\nproperty float nz\n",
                                     "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n"));
  ASSERT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(mesh.polygons_triangulated, 1u);
  EXPECT_EQ(values_at(mesh, 0, 0), (CornerValues{{0, 1}, {0, 0, 1}, {}}));
  EXPECT_EQ(values_at(mesh, 1, 0), (CornerValues{{0.5f, 0.5f}, {0, 0, 1}, {}}));
  EXPECT_EQ(mesh.wedges.corners[0].v[2], mesh.wedges.corners[1].v[1]);
  EXPECT_EQ(mesh.wedges.material, (std::vector<std::uint32_t>{0, 1, no_material, no_material}));
  ASSERT_EQ(mesh.textures.size(), 2u);
  EXPECT_EQ(mesh.textures[1].name, "b c.png");
  EXPECT_EQ(mesh.materials[1].texture, 1u);
  expect_warning(mesh, {"m.ply", "1 faces do not have two texture coordinates"});
}

TEST_F(PlyTextures, FacesBeforeVertices) {
  const RawMesh mesh = read(
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar float texcoord\n"
      "property list uchar int vertex_indices\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
      "6 0 0 1 0 0 1 3 0 1 2\n0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n");
  EXPECT_EQ(values_at(mesh, 0, 1), (CornerValues{{1, 1}, {}, {4, 5, 6, 255}}));
}

TEST_F(PlyTextures, WithoutNumbersTheFirstTextureIsMeant) {
  const RawMesh mesh = read(textured("", "3 0 1 2\n3 0 2 3\n3 0 1 3\n", "property float s\nproperty float t\n",
                                     "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n"));
  EXPECT_EQ(mesh.wedges.material, (std::vector<std::uint32_t>{0, 0, 0}));
  EXPECT_EQ(mesh.wedges.uv.size(), 4u);
}

TEST_F(PlyTextures, MissingImagesAreWarnings) {
  const std::string text =
      textured("property int texnumber\n", "3 0 1 2 0\n3 0 2 3 1\n3 0 1 3 -1\n", "", "0 0 0\n1 0 0\n1 1 0\n0 1 0\n");
  const RawMesh mesh = read_bytes(text, ply);
  expect_warning(mesh, {"file: header", "'a.png'", "cannot be found"});
  EXPECT_EQ(mesh.wedges.material, (std::vector<std::uint32_t>{0, 1, no_material}));
  EXPECT_EQ(mesh.materials[0].texture, no_texture);
  EXPECT_EQ(mesh.materials[0].base_colour, missing_texture_colour);
}

TEST(DracoAttributes, PointsAreWedges) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int colour = builder.AddAttribute(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8);
  const float p[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const float t[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5f, 0.5f}};
  const float n[3] = {0, 0, 1};
  const std::uint8_t c[3] = {10, 20, 255};
  const int corners[2][3] = {{0, 1, 2}, {0, 2, 3}};
  for (int f = 0; f < 2; ++f) {
    const draco::FaceIndex face(static_cast<std::uint32_t>(f));
    const auto& v = corners[f];
    builder.SetAttributeValuesForFace(position, face, p[v[0]], p[v[1]], p[v[2]]);
    builder.SetAttributeValuesForFace(uv, face, f == 1 ? t[4] : t[0], t[v[1]], t[v[2]]);
    builder.SetAttributeValuesForFace(normal, face, n, n, n);
    builder.SetAttributeValuesForFace(colour, face, c, c, c);
  }
  draco::Encoder encoder;
  encoder.SetSpeedOptions(5, 5);
  draco::EncoderBuffer buffer;
  ASSERT_TRUE(encoder.EncodeMeshToBuffer(*builder.Finalize(), &buffer).ok());
  const std::string bytes(buffer.data(), buffer.size());
  const RawMesh mesh = read_bytes(bytes, MeshFormat::draco);
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_GE(wedge_count(mesh), 5u) << "a seam at one vertex; libdraco lets it run through the edge";
  for (std::size_t triangle = 0; triangle < 2; ++triangle)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const Vec3d at = mesh.positions[mesh.triangles[triangle].v[corner]];
      const CornerValues values = values_at(mesh, triangle, corner);
      const bool seam = values.uv == Vec2f{0.5f, 0.5f};
      EXPECT_EQ(values.uv, (seam ? Vec2f{0.5f, 0.5f} : Vec2f{static_cast<float>(at.x), static_cast<float>(1 - at.y)}));
      EXPECT_NEAR(values.normal.z, 1, 1e-3);
      EXPECT_EQ(values.colour, (Rgba8{10, 20, 255, 255}));
    }
  EXPECT_EQ(wedge_count(read_bytes(bytes, MeshFormat::draco, {.attributes = false})), 0u);
}

// A triangle; the vertices may have more properties, and so may the face.
std::string small_ply(const std::string& format, const std::string& face_properties, const std::string& body) {
  return "ply\nformat " + format + " 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\nproperty uchar z\n" +
         "element face 1\nproperty list uchar int vertex_indices\n" + face_properties + "end_header\n" + body;
}

TEST(Ply, ColoursOfFacesAreLeftOutWithAWarning) {
  const std::string text = small_ply("ascii", "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                                     "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 9 9 9\n");
  const RawMesh mesh = read_bytes(text, MeshFormat::ply);
  EXPECT_TRUE(mesh.wedges.empty());
  expect_warning(mesh, {"colours of the faces are left out"});
  EXPECT_TRUE(read_bytes(text, MeshFormat::ply, {.attributes = false}).warnings.empty());
}

TEST(Ply, PropertiesAndElementsThatAreNotReadAreOneNote) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float quality\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float radius\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty int flags\nproperty int texnumber\n"
      "element material 2\nproperty float ambient\nelement camera 0\nproperty float fov\nend_header\n"
      "0 0 0 1 9 9 9 2\n1 0 0 1 9 9 9 2\n0 1 0 1 9 9 9 2\n3 0 1 2 7 0\n0.5\n0.5\n";
  const RawMesh mesh = read_bytes(text, MeshFormat::ply);
  ASSERT_EQ(mesh.warnings.size(), 1u);
  expect_warning(mesh,
                 {"header: quality radius of vertices, flags texnumber of faces, 2 of element material left out"});
  EXPECT_TRUE(read_bytes(text, MeshFormat::ply, {.attributes = false}).warnings.empty());
}

TEST(Ply, BytesBehindTheLastElementAreAWarning) {
  const std::string text = small_ply("ascii", "", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n  \n");
  EXPECT_EQ(read_bytes(text, MeshFormat::ply).warnings, std::vector<std::string>{});
  expect_warning(read_bytes(text + "3 0 1 2\n", MeshFormat::ply), {"8 bytes after the last element"});
  const std::string binary =
      small_ply("binary_little_endian", "",
                std::string("\0\0\0\1\0\0\0\1\0", 9) + Bytes().put(std::uint8_t{3}).put(0).put(1).put(2).str());
  EXPECT_EQ(read_bytes(binary, MeshFormat::ply).warnings, std::vector<std::string>{});
  expect_warning(read_bytes(binary + "more", MeshFormat::ply), {"4 bytes after the last element"});
}

}  // namespace
}  // namespace lodestone
