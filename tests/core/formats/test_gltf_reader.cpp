// glTF files of every kind that is read.
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "tests/core/formats/gltf_test_util.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

constexpr auto gltf = MeshFormat::gltf;
const std::vector<Vec3d> triangle_positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
const std::vector<float> square{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

TEST(Gltf, BinaryAndText) {
  const GltfFile file = triangle_file();
  const TestFolder folder;
  folder.write("a b.bin", file.binary);
  std::string base64;
  for (std::size_t i = 0; i < file.binary.size(); i += 3) {
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < file.binary.size() ? static_cast<unsigned char>(file.binary[i + k]) : 0u);
    for (int k = 0; k < 4; ++k)
      base64 += i + static_cast<std::size_t>(k) > file.binary.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
  }
  for (const RawMesh& mesh : {read_bytes(file.glb(), gltf), read_mesh(folder.write("a.gltf", file.gltf("a%20b.bin"))),
                              read_bytes(file.gltf("data:application/octet-stream;base64," + base64), gltf)}) {
    EXPECT_EQ(mesh.positions, triangle_positions);
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 1, 2}}}));
    EXPECT_EQ(wedge_count(mesh), 0u);
  }
}

TEST(Gltf, NodesMoveTurnScaleAndMirror) {
  GltfFile file;
  const std::size_t position = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const std::size_t normal = file.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const std::size_t mesh = file.mesh({{{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}}});
  // A quarter turn about z below a move; a mirrored one beside it; one that no scene shows.
  const double half = std::sqrt(0.5);
  file.node({{"mesh", mesh}, {"rotation", {0, 0, half, half}}, {"scale", {2, 1, 1}}});
  file.node({{"translation", {10, 0, 0}}, {"children", {0}}});
  file.node({{"mesh", mesh}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 5, 1}}});
  file.node({{"mesh", mesh}});
  file.scene(nlohmann::json::array());
  file.scene({1, 2});
  file.json["scene"] = 1;
  const RawMesh result = read_bytes(file.glb(), gltf);
  ASSERT_EQ(result.positions.size(), 6u);
  const std::vector<Vec3d> expected{{10, 0, 0}, {10, 2, 0}, {9, 0, 0}, {0, 0, 5}, {1, 0, 5}, {0, 1, 5}};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(length(result.positions[i] - expected[i]), 1e-12) << i;
  EXPECT_EQ(result.triangles, (std::vector<Triangle>{{{0, 1, 2}}, {{3, 5, 4}}}));
  EXPECT_EQ(result.wedges.normal[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(result.wedges.normal[3], (Vec3f{0, 0, -1}));
  file.json.erase("scene"), file.json.erase("scenes");
  EXPECT_EQ(read_bytes(file.glb(), gltf).triangles.size(), 3u) << "without scenes, all nodes";
}

TEST(Gltf, StripsFansAndIndicesOfAnyType) {
  const auto triangles = [](int mode, int type, const auto& ids) {
    GltfFile file;
    nlohmann::json primitive = {{"attributes", {{"POSITION", file.floats(square, "VEC3")}}}, {"mode", mode}};
    if (!ids.empty()) primitive["indices"] = file.accessor(ids, type, "SCALAR");
    file.show(nlohmann::json::array({primitive}));
    return read_bytes(file.glb(), gltf).triangles;
  };
  using Triangles = std::vector<Triangle>;
  const std::vector<std::uint8_t> bytes{0, 1, 2, 3};
  EXPECT_EQ(triangles(5, 5121, bytes), (Triangles{{{0, 1, 2}}, {{1, 3, 2}}}));
  EXPECT_EQ(triangles(6, 5121, bytes), (Triangles{{{0, 1, 2}}, {{0, 2, 3}}}));
  EXPECT_EQ(triangles(4, 5123, std::vector<std::uint16_t>{3, 2, 0}), (Triangles{{{3, 2, 0}}}));
  EXPECT_EQ(triangles(4, 5125, std::vector<std::uint32_t>{1, 2, 0}), (Triangles{{{1, 2, 0}}}));
  EXPECT_EQ(triangles(6, 0, std::vector<std::uint8_t>{}), (Triangles{{{0, 1, 2}}, {{0, 2, 3}}}));
}

TEST(Gltf, PrimitivesWithMaterialsAndSharedVertices) {
  GltfFile file;
  const std::size_t position = file.floats(square, "VEC3");
  const std::size_t uv = file.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2");
  const std::size_t image = file.view(png_bytes());
  file.json["images"] = {{{"bufferView", image}, {"mimeType", "image/png"}, {"name", "wall"}}};
  file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  file.json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 0}}, {{"source", 0}}};
  file.json["materials"] = {
      {{"name", "unused"}},
      {{"name", "red"},
       {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 0.5}}, {"baseColorTexture", {{"index", 0}}}}}},
      {{"extensions",
        {{"KHR_materials_pbrSpecularGlossiness",
          {{"diffuseFactor", {0, 0.5, 7, 1}}, {"diffuseTexture", {{"index", 1}}}}}}},
       {"normalTexture", {{"index", 2}}}}};
  const nlohmann::json attributes = {{"POSITION", position}, {"TEXCOORD_0", uv}};
  file.show({{{"attributes", attributes}, {"indices", file.indices({0, 1, 2})}, {"material", 1}},
             {{"attributes", attributes}, {"indices", file.indices({0, 2, 3})}, {"material", 2}},
             {{"attributes", {{"POSITION", position}}}, {"indices", file.indices({0, 1, 3})}},
             {{"attributes", attributes}, {"mode", 0}}});
  const RawMesh mesh = read_bytes(file.glb(), gltf);
  EXPECT_EQ(mesh.positions.size(), 8u) << "the first two share their vertices";
  EXPECT_EQ(mesh.wedges.material, (std::vector<std::uint32_t>{0, 1, no_material}));
  ASSERT_EQ(mesh.materials.size(), 2u);
  EXPECT_EQ(
      mesh.materials[0],
      (Material{.name = "red", .base_colour = {1, 0, 0, 0.5f}, .texture = 0, .metallic = 1, .double_sided = false}));
  const Material& glossy = mesh.materials[1];
  EXPECT_EQ(glossy.base_colour, (std::array<float, 4>{0, 0.5f, 1, 1}));
  EXPECT_EQ(glossy.texture, 1u);
  EXPECT_EQ(glossy.normal_map, 1u);
  EXPECT_EQ(glossy.metallic + glossy.roughness, 0.0f);
  EXPECT_EQ(glossy.extension_textures, std::vector<std::uint32_t>{1});
  ASSERT_EQ(mesh.textures.size(), 2u);
  EXPECT_EQ(mesh.textures[0].wrap_u, TextureWrap::clamp);
  EXPECT_EQ(mesh.textures[0].wrap_v, TextureWrap::mirror);
  EXPECT_EQ(mesh.textures[1].wrap_u, TextureWrap::repeat);
  EXPECT_EQ(mesh.textures[0].name, "wall");
  EXPECT_EQ(values_at(mesh, 1, 1).uv, (Vec2f{1, 1})) << "as in the file: glTF counts from the upper left";
  EXPECT_EQ(values_at(mesh, 2, 1).uv, Vec2f{});
  expect_warning(mesh, {"file", "1 primitives of points or lines"});
  const RawMesh plain = read_bytes(file.glb(), gltf, {.attributes = false});
  EXPECT_EQ(plain.triangles.size(), 3u);
  EXPECT_TRUE(plain.wedges == RawWedges{} && plain.materials.empty() && plain.textures.empty());
}

TEST(Gltf, ImagesBesideTheFileInItAndMissing) {
  GltfFile file = triangle_file();
  file.json["images"] = {{{"uri", "a%20b.png"}}, {{"uri", "data:image/png;base64,iVBORw0KGgo="}}, {{"uri", "no.png"}}};
  file.json["textures"] = {{{"source", 0}},
                           {{"source", 1}},
                           {{"source", 2}},
                           {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}},
                           nlohmann::json::object()};
  nlohmann::json primitives;
  for (std::size_t i = 0; i < 5; ++i) {
    file.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    nlohmann::json primitive = file.json["meshes"][0]["primitives"][0];
    primitive["material"] = i;
    primitives.push_back(primitive);
  }
  file.json["meshes"][0]["primitives"] = primitives;
  const TestFolder folder;
  folder.write("a b.png", png_bytes());
  const RawMesh mesh = read_mesh(folder.write("m.glb", file.glb()));
  EXPECT_EQ(wedge_mistake(mesh), "");
  EXPECT_EQ(mesh.positions.size(), 3u) << "one set of vertices for all";
  EXPECT_EQ(mesh.textures.size(), 2u);
  EXPECT_EQ(mesh.materials[3].texture, mesh.materials[0].texture);
  EXPECT_EQ(mesh.materials[2].texture, no_texture);
  EXPECT_EQ(mesh.materials[4].texture, no_texture);
  expect_warning(mesh, {"m.glb: images[2]", "'no.png'", "cannot be found"});
}

TEST(Gltf, NormalsAndColoursOfAllTypes) {
  GltfFile file;
  const std::size_t position = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const std::size_t normal =
      file.accessor(std::vector<std::int8_t>{0, 0, 127, 0, -128, 0, 0, 0, 0}, 5120, "VEC3", true);
  const std::size_t rgb = file.floats({0, 0.5f, 1, 2, -1, 0.002f, 0, 0, 0}, "VEC3");
  const std::size_t rgba = file.accessor(
      std::vector<std::uint16_t>{0, 65535, 32768, 32768, 0, 0, 0, 0, 65535, 65535, 65535, 65535}, 5123, "VEC4", true);
  // Normals of 3 bytes are misaligned, which does no harm here.
  file.show({{{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"COLOR_0", rgb}}}},
             {{"attributes", {{"POSITION", position}, {"COLOR_0", rgba}}}}});
  const RawMesh mesh = read_bytes(file.glb(), gltf);
  EXPECT_EQ(mesh.wedges.normal, (std::vector<Vec3f>{{0, 0, 1}, {0, -1, 0}, {}, {}, {}, {}}));
  EXPECT_EQ(mesh.wedges.colour, (std::vector<Rgba8>{{0, 188, 255, 255},
                                                    {255, 0, 7, 255},
                                                    {0, 0, 0, 255},
                                                    {0, 255, 188, 128},
                                                    {0, 0, 0, 0},
                                                    {255, 255, 255, 255}}))
      << "sRGB; alpha linear";
}

TEST(Gltf, QuantizedValuesAndTextureTransforms) {
  GltfFile file;
  file.json["extensionsRequired"] = {"KHR_mesh_quantization", "KHR_texture_transform"};
  const std::size_t position = file.accessor(std::vector<std::int16_t>{0, 0, 0, 100, 0, 0, 0, -100, 0}, 5122, "VEC3");
  const std::size_t uv = file.accessor(std::vector<std::uint16_t>{0, 0, 65535, 0, 0, 65535}, 5123, "VEC2", true);
  file.push("textures", nlohmann::json::object());
  const nlohmann::json transform = {
      {"offset", {0.5, 0.25}}, {"scale", {2, 4}}, {"rotation", std::acos(-1.0) / 2}, {"texCoord", 1}};
  file.json["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}}}};
  const std::size_t mesh = file.mesh({{{"attributes", {{"POSITION", position}, {"TEXCOORD_1", uv}}}, {"material", 0}}});
  file.scene({file.node({{"mesh", mesh}, {"scale", {0.01, 0.01, 0.01}}})});
  const RawMesh result = read_bytes(file.glb(), gltf);
  EXPECT_LT(length(result.positions[2] - Vec3d{0, -1, 0}), 1e-12);
  // Scaled, then turned counter-clockwise on an image whose y runs down, then moved.
  const std::vector<Vec2f> expected{{0.5f, 0.25f}, {0.5f, 0.25f - 2}, {0.5f + 4, 0.25f}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(result.wedges.uv[i].x, expected[i].x, 1e-6);
    EXPECT_NEAR(result.wedges.uv[i].y, expected[i].y, 1e-6);
  }
}

TEST(Gltf, InterleavedAndSparseAccessors) {
  GltfFile file;
  Bytes bytes;
  for (int i = 0; i < 3; ++i)
    for (const float value : {float(i), float(i * i), 0.f, 9.f, 9.f}) bytes.put(value);
  const std::size_t view = file.view(bytes.str(), 20);
  const std::size_t ids = file.view(Bytes().put(std::uint8_t{2}).str());
  const std::size_t values = file.view(Bytes().put(7.f).put(8.f).put(9.f).str());
  file.push("accessors", {{"bufferView", view},
                          {"componentType", 5126},
                          {"count", 3},
                          {"type", "VEC3"},
                          {"sparse",
                           {{"count", 1},
                            {"indices", {{"bufferView", ids}, {"componentType", 5121}}},
                            {"values", {{"bufferView", values}}}}}});
  file.show({{{"attributes", {{"POSITION", 0}}}}});
  EXPECT_EQ(read_bytes(file.glb(), gltf).positions, (std::vector<Vec3d>{{0, 0, 0}, {1, 1, 0}, {7, 8, 9}}));
}

TEST(Gltf, SkinsAndMorphTargetsAreReadAtRest) {
  GltfFile file = triangle_file();
  file.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  expect_warning(read_bytes(file.glb(), gltf), {"1 nodes", "pose at rest"});
}

// The square with texture coordinates 10 times its x and y, compressed by Draco under ids 7 and 3.
std::string draco_square() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  const int corners[2][3] = {{0, 1, 2}, {0, 2, 3}};
  for (std::uint32_t f = 0; f < 2; ++f) {
    const float* p[3];
    float t[3][2];
    for (int k = 0; k < 3; ++k) {
      p[k] = square.data() + 3 * corners[f][k];
      t[k][0] = 10 * p[k][0], t[k][1] = 10 * p[k][1];
    }
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(f), p[0], p[1], p[2]);
    builder.SetAttributeValuesForFace(uv, draco::FaceIndex(f), t[0], t[1], t[2]);
  }
  const auto mesh = builder.Finalize();
  mesh->attribute(position)->set_unique_id(7);
  mesh->attribute(uv)->set_unique_id(3);
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST(Gltf, DracoCompression) {
  GltfFile file;
  file.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const std::size_t packed = file.view(draco_square());
  file.push("accessors", {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
  file.push("accessors", {{"componentType", 5126}, {"count", 4}, {"type", "VEC2"}});
  file.push("accessors", {{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
  const nlohmann::json extension = {{"bufferView", packed}, {"attributes", {{"POSITION", 7}, {"TEXCOORD_0", 3}}}};
  file.show({{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}},
              {"indices", 2},
              {"extensions", {{"KHR_draco_mesh_compression", extension}}}}});
  const RawMesh mesh = read_bytes(file.glb(), gltf);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  ASSERT_EQ(mesh.wedges.uv.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_EQ(mesh.wedges.uv[i].x, 10 * static_cast<float>(mesh.positions[i].x));
    EXPECT_EQ(mesh.wedges.uv[i].y, 10 * static_cast<float>(mesh.positions[i].y));
  }
  GltfFile wrong = file;
  wrong.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 8;
  expect_error<InputError>(wrong.glb(), gltf, {"meshes[0].primitives[0]", "no attribute 8"});
  wrong = file;
  wrong.json["bufferViews"][0]["byteLength"] = 20;
  expect_error<InputError>(wrong.glb(), gltf, {"KHR_draco_mesh_compression", "cannot decode"});
}

// Adds a buffer view in the compressed form alone; its plain form is a buffer without bytes.
std::size_t packed_view(GltfFile& file, const std::string& packed, const nlohmann::json& description) {
  const std::size_t view = file.view(packed);
  nlohmann::json extension = file.json["bufferViews"][view];
  extension.update(description);
  const std::uint64_t bytes =
      description["count"].get<std::uint64_t>() * description["byteStride"].get<std::uint64_t>();
  file.json["bufferViews"][view] = {
      {"buffer", 1}, {"byteLength", bytes}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
  return view;
}

GltfFile meshopt_file() {
  GltfFile file;
  file.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(4, 12));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), square.data(), 4, 12));
  const std::size_t positions =
      packed_view(file, {bytes.begin(), bytes.end()}, {{"count", 4}, {"byteStride", 12}, {"mode", "ATTRIBUTES"}});
  // Octahedral normals of 4 bytes.
  const std::vector<float> normals{0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 0, 0};
  std::vector<std::int8_t> filtered(16);
  meshopt_encodeFilterOct(filtered.data(), 4, 4, 8, normals.data());
  bytes.resize(meshopt_encodeVertexBufferBound(4, 4));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), filtered.data(), 4, 4));
  const std::size_t octahedral =
      packed_view(file, {bytes.begin(), bytes.end()},
                  {{"count", 4}, {"byteStride", 4}, {"mode", "ATTRIBUTES"}, {"filter", "OCTAHEDRAL"}});
  const std::vector<std::uint32_t> ids{0, 1, 2, 0, 2, 3};
  bytes.resize(meshopt_encodeIndexBufferBound(6, 4));
  bytes.resize(meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), ids.data(), 6));
  const std::size_t triangles =
      packed_view(file, {bytes.begin(), bytes.end()}, {{"count", 6}, {"byteStride", 2}, {"mode", "TRIANGLES"}});
  bytes.resize(meshopt_encodeIndexSequenceBound(4, 4));
  bytes.resize(meshopt_encodeIndexSequence(bytes.data(), bytes.size(), ids.data() + 1, 4));
  const std::size_t sequence =
      packed_view(file, {bytes.begin(), bytes.end()}, {{"count", 4}, {"byteStride", 4}, {"mode", "INDICES"}});
  file.push("accessors", {{"bufferView", positions}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
  file.push(
      "accessors",
      {{"bufferView", octahedral}, {"componentType", 5120}, {"normalized", true}, {"count", 4}, {"type", "VEC3"}});
  file.push("accessors", {{"bufferView", triangles}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
  file.push("accessors", {{"bufferView", sequence}, {"componentType", 5125}, {"count", 3}, {"type", "SCALAR"}});
  const nlohmann::json attributes = {{"POSITION", 0}, {"NORMAL", 1}};
  file.show({{{"attributes", attributes}, {"indices", 2}}, {{"attributes", attributes}, {"indices", 3}}});
  file.json["buffers"] = {{{"byteLength", file.binary.size()}}, {{"byteLength", 112}}};
  return file;
}

TEST(Gltf, MeshoptCompression) {
  const RawMesh mesh = read_bytes(meshopt_file().glb(), gltf);
  EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangles[2], (Triangle{{1, 2, 0}}));
  EXPECT_LT(length(mesh.wedges.normal[1] - Vec3f{1, 0, 0}), 0.02f);
  EXPECT_LT(length(mesh.wedges.normal[3] - Vec3f{0, -1, 0}), 0.02f);
}

TEST(Gltf, MeshoptCompressionErrors) {
  const auto expect = [](std::size_t view, const char* key, const nlohmann::json& value, std::string_view what) {
    SCOPED_TRACE(std::string(key) + " " + value.dump());
    GltfFile file = meshopt_file();
    file.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
    expect_error<InputError>(file.glb(), gltf, {"file: bufferViews[" + std::to_string(view) + "]", what});
  };
  expect(0, "count", 1'000'000'000, "more than");
  expect(0, "count", 1ull << 53, "more than");
  expect(0, "count", 400, "cannot be decoded");
  expect(0, "byteStride", 13, "13 bytes");
  expect(0, "byteStride", 0, "0 bytes");
  expect(0, "byteStride", 260, "260 bytes");
  expect(0, "mode", "OTHER", "'OTHER'");
  expect(0, "filter", "OTHER", "'OTHER'");
  expect(0, "filter", "OCTAHEDRAL", "'OCTAHEDRAL' of 12");
  expect(0, "byteOffset", 100000, "reaches");
  expect(2, "count", 7, "7 indices");
  expect(2, "byteStride", 3, "3 bytes");
  expect(2, "byteLength", 3, "cannot be decoded");
}

TEST(Gltf, RealTilesHaveTheTrianglesOfTheirDataSheet) {
  LODESTONE_MODEL_OR_SKIP(path, "textured/komaba_tiles_022/tiles/022.glb");
  const RawMesh mesh = read_mesh(path);
  EXPECT_EQ(wedge_mistake(mesh), "");
  EXPECT_EQ(mesh.triangles.size(), 6456u / 3);
  EXPECT_EQ(wedge_count(mesh), mesh.positions.size());
  ASSERT_EQ(mesh.textures.size(), 1u);
  EXPECT_EQ(mesh.textures[0].media_type, "image/jpeg");
  EXPECT_EQ(mesh.textures[0].wrap_u, TextureWrap::clamp);
  EXPECT_EQ(mesh.textures[0].bytes.size(), 254593u);
}

TEST(GltfInstances, AreExpanded) {
  GltfFile file = triangle_file();
  nlohmann::json& node = file.json["nodes"][0];
  node["translation"] = {10, 0, 0};
  const double half = std::sqrt(0.5);
  const std::size_t move = file.floats({0, 0, 0, 0, 5, 0}, "VEC3");
  const std::size_t turn = file.floats({0, 0, 0, 1, 0, 0, static_cast<float>(half), static_cast<float>(half)}, "VEC4");
  const std::size_t scale = file.floats({1, 1, 1, 2, 2, -2}, "VEC3");
  nlohmann::json& attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = {{"TRANSLATION", move}, {"ROTATION", turn}, {"SCALE", scale}};
  file.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const RawMesh mesh = read_bytes(file.glb(), gltf);
  ASSERT_EQ(mesh.positions.size(), 6u);
  const std::vector<Vec3d> expected{{10, 0, 0}, {11, 0, 0}, {10, 1, 0}, {10, 5, 0}, {10, 7, 0}, {8, 5, 0}};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(length(mesh.positions[i] - expected[i]), 1e-6) << i;
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 1, 2}}, {{3, 5, 4}}})) << "the second is mirrored";
  attributes["SCALE"] = file.floats({1, 1, 1}, "VEC3");
  expect_error<InputError>(file.glb(), gltf, {"file: nodes[0]", "SCALE", "does not match the other attributes"});
  attributes = nlohmann::json::object();
  expect_error<InputError>(file.glb(), gltf, {"no triangle"});
}

}  // namespace
}  // namespace lodestone
