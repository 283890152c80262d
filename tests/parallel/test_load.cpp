#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "core/base/error.h"
#include "core/formats/mesh_file.h"
#include "core/formats/ply/ply.h"
#include "core/mesh/generate.h"
#include "parallel/mesh/generate.h"
#include "parallel/mesh/load.h"
#include "tests/test_data.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class LoadTest : public FolderTest {};

// Loads with any number of workers and compares with the general reader, in result or in error.
void expect_same_as_read(const fs::path& path, const ReadConfig& config = {}) {
  std::string expected_error;
  RawMesh expected;
  try {
    expected = read_mesh(path, config);
  } catch (const Error& error) {
    expected_error = error.what();
  }
  for (const int threads : {0, 1, 2, 3, 7}) {
    const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
    try {
      const RawMesh mesh = load_mesh(path, *scheduler, config);
      EXPECT_EQ(expected_error, "") << path;
      EXPECT_EQ(mesh.positions, expected.positions) << path;
      EXPECT_EQ(mesh.triangles, expected.triangles) << path;
      EXPECT_EQ(mesh.polygons_triangulated, expected.polygons_triangulated);
      EXPECT_EQ(mesh.faces_dropped, expected.faces_dropped);
      EXPECT_EQ(mesh.wedges, expected.wedges) << path;
      EXPECT_EQ(mesh.materials, expected.materials) << path;
      EXPECT_EQ(mesh.textures, expected.textures) << path;
      EXPECT_EQ(mesh.warnings, expected.warnings) << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), expected_error);
    }
  }
}

RawMesh sample() { return generate_mesh({Shape::sphere, 300'000, 4}); }  // several chunks of both kinds

TEST_F(LoadTest, PlyAndStlInChunks) {
  RawMesh mesh = sample();
  write_mesh(folder_ / "a.ply", mesh);
  expect_same_as_read(folder_ / "a.ply");
  EXPECT_EQ(read_mesh(folder_ / "a.ply").positions, mesh.positions);
  write_mesh(folder_ / "b.stl", mesh);
  expect_same_as_read(folder_ / "b.stl");
  for (Vec3d& p : mesh.positions) p.x += 1e6;  // double positions
  write_mesh(folder_ / "c.ply", mesh);
  expect_same_as_read(folder_ / "c.ply");
  write_mesh(folder_ / "d.obj", generate_mesh({Shape::box, 300, 1}));
  expect_same_as_read(folder_ / "d.obj");
}

TEST_F(LoadTest, OtherElementsAroundAndFacesBeforeVertices) {
  const std::string header =
      "ply\nformat binary_big_endian 1.0\nelement camera 2\nproperty short id\n"
      "element face 1\nproperty uchar tag\nproperty list uchar uint vertex_index\nproperty float quality\n"
      "element edge 1\nproperty uchar a\n"
      "element vertex 3\nproperty uchar red\nproperty short x\nproperty short y\nproperty short z\n"
      "element tail 1\nproperty list uchar uchar bytes\nend_header\n";
  const std::string body(
      "cacaT\3\0\0\0\0\0\0\0\1\0\0\0\2quale"
      "r\0\1\0\2\0\3"
      "r\0\4\0\5\0\6"
      "r\0\7\0\x8\0\x9"
      "\1t",
      46);
  std::ofstream(folder_ / "a.ply", std::ios::binary) << header << body;
  expect_same_as_read(folder_ / "a.ply");
  const RawMesh mesh = read_mesh(folder_ / "a.ply");
  EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 1, 2}}}));
}

TEST_F(LoadTest, AttributesInChunks) {
  // A sphere of several chunks whose vertices have all attributes.
  const RawMesh mesh = sample();
  std::ofstream out(folder_ / "a.ply", std::ios::binary);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.positions.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
         "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float u\n"
         "property float v\nelement face "
      << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3d& p : mesh.positions) {
    const float xyz[3] = {float(p.x), float(p.y), float(p.z)}, uv[2] = {float(p.x), float(p.z)};
    out.write(reinterpret_cast<const char*>(xyz), 12).write(reinterpret_cast<const char*>(xyz), 12);
    out.write(reinterpret_cast<const char*>(xyz), 3).write(reinterpret_cast<const char*>(uv), 8);
  }
  for (const Triangle& t : mesh.triangles) out.put(3).write(reinterpret_cast<const char*>(t.v.data()), 12);
  out.close();
  expect_same_as_read(folder_ / "a.ply");
  expect_same_as_read(folder_ / "a.ply", {.attributes = false});
  const RawMesh loaded = load_mesh(folder_ / "a.ply", *make_tbb_scheduler(2));
  EXPECT_EQ(loaded.wedges.normal.size(), mesh.positions.size());
  EXPECT_EQ(loaded.wedges.colour.size(), mesh.positions.size());
  EXPECT_EQ(loaded.wedges.uv.size(), mesh.positions.size());
  EXPECT_EQ(wedge_count(load_mesh(folder_ / "a.ply", *make_tbb_scheduler(2), {.attributes = false})), 0u);
}

TEST_F(LoadTest, TilesSideBySide) {
  LODESTONE_MODEL_OR_SKIP(tiles, "textured/komaba_tiles_022");
  expect_same_as_read(tiles);
  expect_same_as_read(tiles / "tileset.json", {.attributes = false});
  // If two tiles are damaged, the error of the first is reported.
  fs::copy(tiles, folder_ / "tiles", fs::copy_options::recursive);
  for (const char* name : {"02201.glb", "0227.glb"}) {
    fs::remove(folder_ / "tiles" / "tiles" / name);
    std::ofstream(folder_ / "tiles" / "tiles" / name) << "glTF";
  }
  expect_same_as_read(folder_ / "tiles");
}

TEST_F(LoadTest, FacesThatAreNoTrianglesTurnToTheGeneralReader) {
  write_mesh(folder_ / "a.ply", sample());
  const std::string bytes = content(folder_ / "a.ply");
  // The last triangle becomes a quad; the one before it a face of two corners.
  std::string polygons = bytes.substr(0, bytes.size() - 2 * ply_triangle_bytes);
  polygons += std::string("\x02\1\0\0\0\2\0\0\0", 9) + std::string("\x04\1\0\0\0\2\0\0\0\3\0\0\0\4\0\0\0", 17);
  std::ofstream(folder_ / "b.ply", std::ios::binary) << polygons;
  expect_same_as_read(folder_ / "b.ply");
  const RawMesh mesh = read_mesh(folder_ / "b.ply");
  EXPECT_EQ(mesh.polygons_triangulated, 1u);
  EXPECT_EQ(mesh.faces_dropped, 1u);
}

TEST_F(LoadTest, WarningsAreThoseOfTheGeneralReader) {
  write_mesh(folder_ / "a.ply", sample());
  std::ofstream(folder_ / "b.ply", std::ios::binary) << content(folder_ / "a.ply") << "more";
  expect_same_as_read(folder_ / "b.ply");
  EXPECT_EQ(read_mesh(folder_ / "b.ply").warnings.size(), 1u);
}

TEST_F(LoadTest, DamagedFilesGiveTheErrorOfTheGeneralReader) {
  write_mesh(folder_ / "a.ply", sample());
  const std::string bytes = content(folder_ / "a.ply");
  const auto damaged = [&](const std::string& damaged_bytes) {
    std::ofstream(folder_ / "b.ply", std::ios::binary) << damaged_bytes;
    expect_same_as_read(folder_ / "b.ply");
    EXPECT_THROW((void)read_mesh(folder_ / "b.ply"), InputError);
  };
  damaged(bytes.substr(0, bytes.size() - 1));
  damaged(bytes.substr(0, bytes.size() / 2));
  damaged(bytes.substr(0, 100));
  damaged("");
  std::string out_of_range = bytes;
  out_of_range[bytes.size() - 1] = 0x7f;
  damaged(out_of_range);
  EXPECT_THROW((void)load_mesh(folder_ / "none.ply", *make_serial_scheduler()), FileError);
}

TEST_F(LoadTest, RealModels) {
  for (const char* name :
       {"textured/Gutenberg/Gutenberg.obj", "scans/igea.ply", "scans/rangemap_lato315.ply", "scans/lucy100k.ply",
        "cad/gears.stl", "cad/thingi_73416.stl", "cad/block.off", "textured/spot/spot_triangulated.obj"}) {
    LODESTONE_MODEL_OR_SKIP(path, name);
    expect_same_as_read(path);
  }
}

TEST_F(LoadTest, StreamedModelsAreThoseMadeInMemory) {
  for (const Shape shape : {Shape::sphere, Shape::terrain, Shape::torus, Shape::box, Shape::pile}) {
    const GenerateConfig config{shape, 150'000, 6};
    generate_ply(config, folder_ / "serial.ply", *make_serial_scheduler());
    const std::string expected = content(folder_ / "serial.ply");
    for (const int threads : {1, 2, 3, 7}) {
      generate_ply(config, folder_ / "a.ply", *make_tbb_scheduler(threads));
      EXPECT_EQ(content(folder_ / "a.ply"), expected);
    }
    const RawMesh read = read_mesh(folder_ / "a.ply"), made = generate_mesh(config);
    EXPECT_EQ(read.positions, made.positions);
    EXPECT_EQ(read.triangles, made.triangles);
  }
}

TEST_F(LoadTest, GeneratingIntoNowhereLeavesNothing) {
  const auto scheduler = make_serial_scheduler();
  EXPECT_THROW(generate_ply({}, folder_ / "none" / "a.ply", *scheduler), FileError);
  EXPECT_THROW(generate_ply({Shape::box, 1, 1}, folder_ / "a.ply", *scheduler), InputError);
  EXPECT_TRUE(fs::is_empty(folder_));
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(generate_ply({}, "/dev/full", *scheduler), FileError);
}

}  // namespace
}  // namespace lodestone
