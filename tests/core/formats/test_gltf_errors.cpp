// Damaged glTF files, and those that ask for what is not known.
#include <gtest/gtest.h>

#include <functional>

#include "tests/core/formats/gltf_test_util.h"

namespace lodestone {
namespace {

constexpr auto gltf = MeshFormat::gltf;

using Change = std::function<void(nlohmann::json&)>;

// The triangle, after a change of its JSON, is refused with these words.
template <class E = InputError>
void expect_refusal(const Change& change, std::initializer_list<std::string_view> parts) {
  GltfFile file = triangle_file();
  file.json = file.with_buffer();
  change(file.json);
  expect_error<E>(file.glb(), gltf, parts);
}

TEST(GltfErrors, ChunksAndHeader) {
  const std::string whole = triangle_file().glb();
  expect_error<InputError>("", gltf, {"empty"});
  for (std::size_t size = 1; size < whole.size(); ++size)
    EXPECT_THROW((void)read_bytes(whole.substr(0, size), gltf), InputError) << size;
  const auto changed = [&](std::size_t at, std::uint32_t value) {
    return whole.substr(0, at) + Bytes().put(value).str() + whole.substr(at + 4);
  };
  expect_error<UnsupportedError>(changed(4, 1), gltf, {"file: byte 4", "version 1", "2.0"});
  expect_error<InputError>(changed(8, 0xFFFFFFFF), gltf, {"byte 8", "declares 4294967295 bytes"});
  expect_error<InputError>(changed(8, 11), gltf, {"byte 8", "declares 11 bytes"});
  expect_error<InputError>(changed(8, 12), gltf, {"no JSON chunk"});
  expect_error<InputError>(changed(12, 0xFFFFFFF0), gltf, {"byte 12", "chunk of 4294967280 bytes"});
  expect_error<InputError>(changed(16, 0x004E4942), gltf, {"byte 16", "not JSON"});
}

// A few bytes show what would fill any memory: nodes and instances of a mesh.
TEST(GltfErrors, MeshesThatAreShownWithoutEnd) {
  GltfFile file;
  const std::size_t positions = file.floats(std::vector<float>(3 * 3000, 0.5f), "VEC3");
  const std::size_t indices = file.indices(std::vector<std::uint16_t>(9000, 1));
  const nlohmann::json primitive{{"attributes", {{"POSITION", positions}}}, {"indices", indices}};
  const std::size_t mesh = file.mesh(nlohmann::json::array({primitive}));
  const auto words = {std::string_view("vertices and triangles, of at most"), std::string_view("split the file")};
  GltfFile nodes = file;
  nlohmann::json all;
  for (int k = 0; k < 10'000; ++k) all.push_back(nodes.node({{"mesh", mesh}}));
  nodes.scene(all);
  expect_error<ResourceError>(nodes.glb(), gltf, words);
  GltfFile instances = file;
  const nlohmann::json many{{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", positions}}}}}};
  all = nlohmann::json::array();
  for (int k = 0; k < 4; ++k) all.push_back(instances.node({{"mesh", mesh}, {"extensions", many}}));
  instances.scene(all);
  expect_error<ResourceError>(instances.glb(), gltf, words);
}

TEST(GltfErrors, MalformedJson) {
  expect_error<InputError>("{\"asset\": ", gltf, {"file: byte 11", "invalid JSON"});
  expect_error<InputError>("{\"asset\": 1e999}", gltf, {"invalid JSON"});
  expect_error<InputError>(std::string(100'000, '['), gltf, {"invalid JSON"});
  expect_error<InputError>("[]", gltf, {"expected an object, found array"});
  expect_error<InputError>("{}", gltf, {"has no 'asset'"});
  expect_error<InputError>(R"({"asset": {"version": 2}})", gltf, {"asset.version", "expected a string, found number"});
  expect_error<UnsupportedError>(R"({"asset": {"version": "1.0"}})", gltf, {"glTF '1.0'", "2.0"});
  expect_error<InputError>(R"({"asset": {"version": "2.0"}})", gltf, {"has no triangle"});
}

TEST(GltfErrors, RequiredExtensions) {
  expect_refusal<UnsupportedError>(
      [](auto& j) {
        j["extensionsRequired"] = {"KHR_mesh_quantization", "NEW_thing"};
      },
      {"extensionsRequired[1]", "'NEW_thing'", "does not know it"});
  GltfFile file = triangle_file();
  file.json["extensionsRequired"] = {"KHR_materials_unlit"};
  file.json["extensionsUsed"] = {"NEW_thing"};
  EXPECT_EQ(read_bytes(file.glb(), gltf).triangles.size(), 1u);
}

TEST(GltfErrors, BuffersAndViews) {
  expect_refusal([](auto& j) { j["buffers"] = nlohmann::json::array(); },
                 {"bufferViews[0].buffer", "index 0", "0 buffers"});
  expect_refusal([](auto& j) { j["buffers"][0]["byteLength"] = 1000; },
                 {"buffers[0]", "1000 bytes, but only", "exist"});
  expect_refusal([](auto& j) { j["buffers"][0].erase("byteLength"); }, {"buffers[0]", "no 'byteLength'"});
  expect_refusal([](auto& j) { j["bufferViews"][0]["byteLength"] = 1000; }, {"bufferViews[0]", "to 1000", "42 bytes"});
  expect_refusal([](auto& j) { j["bufferViews"][0]["byteOffset"] = 43; }, {"bufferViews[0]", "from byte 43"});
  expect_refusal([](auto& j) { j["bufferViews"][0]["byteOffset"] = -1; }, {"bufferViews[0].byteOffset", "found -1"});
  expect_refusal([](auto& j) { j["bufferViews"][0]["byteOffset"] = 1e300; }, {"byteOffset", "2^53"});
  expect_refusal([](auto& j) { j["buffers"][0]["uri"] = "data:;base64,@@@@"; }, {"buffers[0].uri", "data URI"});
  expect_refusal([](auto& j) { j["buffers"][0]["uri"] = "data:text/plain,abc"; }, {"buffers[0].uri", "base64"});
  expect_refusal<FileError>([](auto& j) { j["buffers"][0]["uri"] = "no.bin"; },
                            {"buffers[0].uri", "'no.bin'", "beside"});
  expect_refusal<FileError>([](auto& j) { j["buffers"][0]["uri"] = "https://example.com/a.bin"; }, {"cannot be found"});
  expect_error<InputError>(triangle_file().with_buffer().dump(), gltf, {"buffers[0]", "neither a 'uri' nor a binary"});
}

TEST(GltfErrors, Accessors) {
  expect_refusal([](auto& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 5; },
                 {"meshes[0].primitives[0].attributes.POSITION", "index 5", "2 accessors"});
  expect_refusal([](auto& j) { j["accessors"][0]["count"] = 4; },
                 {"accessors[0]", "beyond its buffer view", "4 elements"});
  expect_refusal([](auto& j) { j["accessors"][0]["count"] = 1ull << 53; }, {"accessors[0]", "beyond its buffer view"});
  expect_refusal([](auto& j) { j["accessors"][0]["byteOffset"] = 1ull << 53; }, {"accessors[0]", "beyond"});
  expect_refusal([](auto& j) { j["bufferViews"][0]["byteStride"] = 1ull << 53; }, {"accessors[0]", "beyond"});
  expect_refusal([](auto& j) { j["accessors"][0]["componentType"] = 5124; }, {"accessors[0].componentType", "5124"});
  expect_refusal([](auto& j) { j["accessors"][0]["type"] = "MAT3"; }, {"accessors[0].type", "'MAT3'"});
  expect_refusal([](auto& j) { j["accessors"][0]["type"] = "VEC2"; }, {"attributes.POSITION", "2 components"});
  expect_refusal<UnsupportedError>([](auto& j) { j["accessors"][0].erase("bufferView"); },
                                   {"accessors[0]", "no bufferView"});
  expect_refusal([](auto& j) { j["accessors"][1]["componentType"] = 5122; }, {"accessors[1]", "not unsigned numbers"});
  expect_refusal([](auto& j) { j["accessors"][0]["count"] = 2; }, {"accessors[1]", "index 2 at 2", "there are 2"});
  expect_refusal([](auto& j) { j["accessors"][1]["count"] = 2; }, {"primitives[0]", "2 indices do not make triangles"});
  expect_refusal(
      [](auto& j) {
        j["accessors"][0]["sparse"] = {{"count", 1},
                                       {"indices", {{"bufferView", 1}, {"componentType", 5121}, {"byteOffset", 4}}},
                                       {"values", {{"bufferView", 0}}}};
        j["accessors"][0]["count"] = 2;
      },
      {"accessors[0].sparse.indices", "out of range"});
  expect_refusal(
      [](auto& j) {
        j["accessors"][0]["sparse"] = {{"count", 1ull << 40},
                                       {"indices", {{"bufferView", 1}, {"componentType", 5121}}},
                                       {"values", {{"bufferView", 0}}}};
      },
      {"accessors[0].sparse.indices", "beyond"});
}

TEST(GltfErrors, MeshesAndPrimitives) {
  expect_refusal([](auto& j) { j["nodes"][0]["mesh"] = 1; }, {"nodes[0].mesh", "index 1", "1 meshes"});
  expect_refusal([](auto& j) { j["meshes"][0].erase("primitives"); }, {"meshes[0]", "no 'primitives'"});
  expect_refusal([](auto& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }, {"primitives[0]", "mode 7"});
  expect_refusal([](auto& j) { j["meshes"][0]["primitives"][0]["mode"] = 1; }, {"has no triangle"});
  expect_refusal([](auto& j) { j["meshes"][0]["primitives"][0]["attributes"] = nlohmann::json::object(); },
                 {"accessors[1]", "index 0", "there are 0"});
  expect_refusal([](auto& j) { j["meshes"][0]["primitives"][0]["material"] = 0; },
                 {"material", "index 0", "0 materials"});
  expect_refusal(
      [](auto& j) {
        j["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 2;
        j["accessors"].push_back(j["accessors"][0]);
        j["accessors"][2]["count"] = 2;
      },
      {"primitives[0]", "3 positions", "2 values"});
  expect_refusal(
      [](auto& j) {
        j["meshes"][0]["primitives"][0]["material"] = 0;
        j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 2}}}}}};
      },
      {"materials[0].pbrMetallicRoughness.baseColorFactor", "expected 4 numbers, found 2"});
}

TEST(GltfErrors, Nodes) {
  expect_refusal([](auto& j) { j["scene"] = 3; }, {"scene", "index 3", "1 scenes"});
  expect_refusal([](auto& j) { j["scenes"][0]["nodes"] = {9}; }, {"scenes[0].nodes[0]", "index 9"});
  expect_refusal([](auto& j) { j["nodes"][0]["children"] = {0}; }, {"nodes[0].children[0]", "another parent", "tree"});
  expect_refusal([](auto& j) { j["scenes"][0]["nodes"] = {0, 0}; }, {"scenes[0].nodes[1]", "another parent"});
  expect_refusal([](auto& j) { j["nodes"][0]["matrix"] = {1, 2, 3}; }, {"nodes[0].matrix", "16 numbers"});
  expect_refusal([](auto& j) { j["nodes"][0]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; },
                 {"nodes[0].matrix", "last row"});
  expect_refusal([](auto& j) { j["nodes"][0]["rotation"] = {0, 0, 0, 0}; }, {"nodes[0]", "rotation"});
  expect_refusal([](auto& j) { j["nodes"][0]["scale"] = {1, "x", 1}; }, {"nodes[0].scale[1]", "number"});
}

TEST(GltfErrors, LongChainsOfNodesNeedNoStack) {
  GltfFile file = triangle_file();
  nlohmann::json nodes;
  for (int i = 0; i < 100'000; ++i) nodes.push_back({{"children", {i + 1}}});
  nodes.push_back({{"mesh", 0}, {"translation", {1, 0, 0}}});
  file.json["nodes"] = nodes;
  EXPECT_EQ(read_bytes(file.glb(), gltf).positions[0], (Vec3d{1, 0, 0}));
}

}  // namespace
}  // namespace lodestone
