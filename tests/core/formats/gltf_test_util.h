// Small glTF files, made piece by piece.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/core/formats/io_test_util.h"

namespace lodestone {

// A scene with one buffer; add what a test is about, change what it wants to be wrong.
class GltfFile {
 public:
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::string binary;

  // Each returns the index of what it adds.
  std::size_t view(const std::string& bytes, std::size_t stride = 0) {
    binary.resize((binary.size() + 3) / 4 * 4);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}};
    if (stride != 0) view["byteStride"] = stride;
    binary += bytes;
    return push("bufferViews", view);
  }
  template <class T>
  std::size_t accessor(const std::vector<T>& values, int component_type, const std::string& type,
                       bool normalised = false) {
    const std::size_t components = type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
    std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    nlohmann::json a = {{"bufferView", view(bytes)},
                        {"componentType", component_type},
                        {"count", values.size() / components},
                        {"type", type}};
    if (normalised) a["normalized"] = true;
    return push("accessors", a);
  }
  std::size_t floats(const std::vector<float>& values, const std::string& type) { return accessor(values, 5126, type); }
  std::size_t indices(const std::vector<std::uint16_t>& values) { return accessor(values, 5123, "SCALAR"); }
  std::size_t mesh(const nlohmann::json& primitives) { return push("meshes", {{"primitives", primitives}}); }
  std::size_t node(const nlohmann::json& node) { return push("nodes", node); }
  void scene(const nlohmann::json& nodes) { push("scenes", {{"nodes", nodes}}); }
  std::size_t push(const char* array, const nlohmann::json& item) {
    json[array].push_back(item);
    return json[array].size() - 1;
  }
  // A mesh of these primitives at the origin, alone in the scene.
  void show(const nlohmann::json& primitives) { scene({node({{"mesh", mesh(primitives)}})}); }

  [[nodiscard]] nlohmann::json with_buffer() const {
    nlohmann::json result = json;
    if (!result.contains("buffers") && !binary.empty()) result["buffers"] = {{{"byteLength", binary.size()}}};
    return result;
  }
  [[nodiscard]] std::string glb() const { return pack(with_buffer().dump(), binary); }
  // The text form, with its buffer under this name.
  [[nodiscard]] std::string gltf(const std::string& uri) const {
    nlohmann::json result = with_buffer();
    if (!binary.empty()) result["buffers"][0]["uri"] = uri;
    return result.dump();
  }

  static std::string pack(std::string text, std::string bytes) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    const std::size_t size = 12 + 8 + text.size() + (bytes.empty() ? 0 : 8 + bytes.size());
    Bytes result("glTF");
    result.put(std::uint32_t{2}).put(static_cast<std::uint32_t>(size));
    result.put(static_cast<std::uint32_t>(text.size())).put(std::uint32_t{0x4E4F534A});
    std::string whole = result.str() + text;
    if (!bytes.empty())
      whole += Bytes().put(static_cast<std::uint32_t>(bytes.size())).put(std::uint32_t{0x004E4942}).str() + bytes;
    return whole;
  }
};

// One triangle in the plane z = 0.
inline GltfFile triangle_file() {
  GltfFile file;
  const std::size_t position = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const std::size_t indices = file.indices({0, 1, 2});
  file.show({{{"attributes", {{"POSITION", position}}}, {"indices", indices}}});
  return file;
}

}  // namespace lodestone
