// Files that a model names: within its folder alone, unless the caller allows others.
#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "core/formats/mesh_file.h"
#include "tests/core/formats/gltf_test_util.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// Models in the folder "in", which hold `name` in the place of a file.
using MakeModel = std::function<fs::path(const TestFolder& folder, const std::string& name)>;

std::string obj_text(const std::string& library) {
  return "mtllib " + library + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
}

fs::path gltf_buffer(const TestFolder& folder, const std::string& name) {
  return folder.write("in/m.gltf", triangle_file().gltf(name));
}

fs::path gltf_image(const TestFolder& folder, const std::string& name) {
  GltfFile file = triangle_file();
  file.json["images"] = {{{"uri", name}}};
  file.json["textures"] = {{{"source", 0}}};
  file.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  file.json["meshes"][0]["primitives"][0]["material"] = 0;
  return folder.write("in/m.glb", file.glb());
}

fs::path obj_library(const TestFolder& folder, const std::string& name) {
  return folder.write("in/m.obj", obj_text(name));
}

fs::path obj_image(const TestFolder& folder, const std::string& name) {
  folder.write("in/m.mtl", "newmtl m\nmap_Kd " + name + "\n");
  return folder.write("in/m.obj", obj_text("m.mtl"));
}

fs::path ply_image(const TestFolder& folder, const std::string& name) {
  return folder.write("in/m.ply", "ply\nformat ascii 1.0\ncomment TextureFile " + name +
                                      "\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                                      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
}

fs::path tile(const TestFolder& folder, const std::string& name) {
  const nlohmann::json tileset{{"asset", {{"version", "1.1"}}},
                               {"root", {{"geometricError", 1}, {"content", {{"uri", name}}}}}};
  return folder.write("in/tileset.json", tileset.dump());
}

// A tileset below, whose tiles lie within the folder of the first.
fs::path tile_of_inner(const TestFolder& folder, const std::string& name) {
  fs::rename(tile(folder, "../" + name), folder.path() / "in/inner.json");
  fs::create_directories(folder.path() / "in/sub");
  fs::rename(folder.path() / "in/inner.json", folder.path() / "in/sub/inner.json");
  return tile(folder, "sub/inner.json");
}

fs::path buffer_of_tile(const TestFolder& folder, const std::string& name) {
  folder.write("in/sub/t.gltf", triangle_file().gltf("../" + name));
  return tile(folder, "sub/t.gltf");
}

enum class Outcome { error, warning };
enum class Names { plain, escaped };  // with %XX

struct Kind {
  const char* what;
  MakeModel make;
  std::string secret;  // what the file holds
  Outcome outcome;     // of a file that is not read
  Names names;
};

const std::string png = "\x89PNG\r\n\x1a\n";

std::vector<Kind> kinds() {
  const std::string model = triangle_file().glb(), buffer = triangle_file().binary;
  using enum Outcome;
  using enum Names;
  return {{"buffer of glTF", gltf_buffer, buffer, error, escaped},
          {"image of glTF", gltf_image, png, warning, escaped},
          {"library of OBJ", obj_library, "newmtl m\nKd 0 0 0\n", warning, plain},
          {"image of OBJ", obj_image, png, warning, plain},
          {"image of PLY", ply_image, png, warning, plain},
          {"tile", tile, model, error, escaped},
          {"tile of a tileset below", tile_of_inner, model, error, escaped},
          {"buffer of a tile", buffer_of_tile, buffer, error, escaped}};
}

// The names that lead from "in" to "out/file.glb"; the last is a symbolic link.
std::vector<std::string> ways_out(const TestFolder& folder, const Kind& kind) {
  std::vector<std::string> names{"../out/file.glb", "sub/../../out/file.glb", "link.glb"};
  if (kind.names == Names::escaped) names.push_back("%2e%2e/out/file.glb");
  if (kind.names == Names::escaped) names.push_back("..%2Fout%2ffile.glb");
  if (!std::string(kind.what).ends_with("tile") && !std::string(kind.what).ends_with("below")) {
    names.push_back(folder.path().string() + "/out/file.glb");
    names.push_back("file://" + folder.path().string() + "/out/file.glb");
  }
  return names;
}

// Colours of the materials: magenta if the texture is missing, white if the library is.
std::vector<std::array<float, 4>> colours_of(const RawMesh& mesh) {
  std::vector<std::array<float, 4>> colours;
  for (const Material& material : mesh.materials) colours.push_back(material.base_colour);
  return colours;
}

TEST(CompanionFiles, NothingOutsideOfTheModelsFolderIsReadUnlessAllowed) {
  for (const Kind& kind : kinds()) {
    const TestFolder folder;
    folder.write("out/file.glb", kind.secret);
    folder.write("in/sub/inside.glb", kind.secret);
    fs::create_symlink(folder.path() / "out/file.glb", folder.path() / "in/link.glb");
    const RawMesh within = read_mesh(kind.make(folder, "sub/inside.glb"));
    EXPECT_TRUE(within.warnings.empty()) << kind.what;
    for (const std::string& name : ways_out(folder, kind)) {
      const fs::path model = kind.make(folder, name);
      const std::string label = kind.what + (": " + name);
      if (kind.outcome == Outcome::warning) {
        const RawMesh mesh = read_mesh(model);
        expect_warning(mesh, {"outside of the model's folder", "--allow-outside"});
        EXPECT_TRUE(mesh.textures.empty()) << label;
      } else {
        expect_error_of<FileError>([&] { return read_mesh(model); }, {"outside of the model's folder"}, label);
      }
      const RawMesh mesh = read_mesh(model, {.allow_outside = true});
      EXPECT_TRUE(mesh.warnings.empty()) << label;
      EXPECT_EQ(colours_of(mesh), colours_of(within)) << label;
      EXPECT_EQ(mesh.triangles.size(), 1u) << label;
    }
  }
}

TEST(CompanionFiles, AFolderThatIsItselfALinkHoldsItsFiles) {
  const TestFolder folder;
  folder.write("in/file.glb", triangle_file().binary);
  gltf_buffer(folder, "file.glb");
  fs::create_directory_symlink(folder.path() / "in", folder.path() / "link");
  EXPECT_EQ(read_mesh(folder.path() / "link/m.gltf").triangles.size(), 1u);
}

TEST(CompanionFiles, AModelInTheCurrentFolderFindsItsFiles) {
  const TestFolder folder;
  folder.write("in/file.glb", triangle_file().binary);
  gltf_buffer(folder, "file.glb");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path() / "in");
  EXPECT_EQ(read_mesh("m.gltf").triangles.size(), 1u);
  folder.write("out.glb", triangle_file().binary);
  gltf_buffer(folder, "../out.glb");
  EXPECT_THROW((void)read_mesh("../in/m.gltf"), FileError);
  fs::current_path(before);
}

}  // namespace
}  // namespace lodestone
