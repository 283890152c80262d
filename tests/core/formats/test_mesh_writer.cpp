#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/base/error.h"
#include "core/files/scalar.h"
#include "core/formats/common/mesh_view.h"
#include "core/formats/mesh_file.h"
#include "tests/expect_error.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class MeshWriterTest : public FolderTest {};

// Coordinates that floats hold exactly, moved by `offset`.
RawMesh strip(double offset) {
  RawMesh mesh;
  for (int i = 0; i < 10'000; ++i) mesh.positions.push_back({offset + i / 64.0, offset - i % 2, offset + 0.125});
  for (std::uint32_t i = 0; i + 2 < 10'000; ++i)
    mesh.triangles.push_back(i % 2 == 0 ? Triangle{{i, i + 1, i + 2}} : Triangle{{i + 1, i, i + 2}});
  return mesh;
}

TEST_F(MeshWriterTest, PlyAndObjReadBackAsTheyWere) {
  for (const char* name : {"a.ply", "a.PLY", "a.obj"}) {
    for (const double offset : {0.0, -20.0, 4e6, 1e12}) {
      const RawMesh mesh = strip(offset);
      write_mesh(folder_ / name, mesh);
      const RawMesh read = read_mesh(folder_ / name);
      EXPECT_EQ(read.positions, mesh.positions) << name << " " << offset;
      EXPECT_EQ(read.triangles, mesh.triangles) << name;
    }
  }
}

TEST_F(MeshWriterTest, PlyIsOfFloatsNearTheOriginAndOfDoublesFarFromIt) {
  write_mesh(folder_ / "near.ply", strip(0));
  write_mesh(folder_ / "far.ply", strip(4e6));
  EXPECT_EQ(fs::file_size(folder_ / "far.ply") - fs::file_size(folder_ / "near.ply"), 10'000 * 12u + 3);
}

TEST_F(MeshWriterTest, ObjKeepsEveryBitOfADouble) {
  RawMesh mesh;
  mesh.positions = {{0.1, 1.0 / 3, -1e-300}, {2e300, -0.0, 5e-324}, {1, 2, 3}};
  mesh.triangles = {{{0, 1, 2}}};
  write_mesh(folder_ / "a.obj", mesh);
  EXPECT_EQ(read_mesh(folder_ / "a.obj").positions, mesh.positions);
}

// The strip is 156 long: at 4e6 STL moves it by 0.0015 of that, at 6e3 by 2e-6.
TEST_F(MeshWriterTest, StlSaysWhatItLosesFarFromTheOrigin) {
  EXPECT_TRUE(write_mesh(folder_ / "near.stl", strip(-20)).empty());
  const std::vector<std::string> notes = write_mesh(folder_ / "far.stl", strip(6e3));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes.front().find("far.stl"), std::string::npos) << notes.front();
  EXPECT_NE(notes.front().find("moves its vertices"), std::string::npos) << notes.front();
  for (const double offset : {4e6, 1e12, 1e300})
    expect_error_of<InputError>([&] { return write_mesh(folder_ / "lost.stl", strip(offset)); },
                                {"lost.stl", "STL", ".ply"});
  EXPECT_FALSE(fs::exists(folder_ / "lost.stl"));
}

// Formats that have float32 alone refuse what it cannot hold; the others keep it.
TEST_F(MeshWriterTest, SizesBeyondFloat) {
  for (const double scale : {1e-200, 1e-44, 1e37, 1e160}) {
    RawMesh mesh = strip(0);
    for (Vec3d& p : mesh.positions) p = scale * p;
    for (const char* name : {"a.stl", "a.glb"})
      expect_error_of<InputError>([&] { return write_mesh(folder_ / name, mesh); },
                                  {name, scale < 1 ? "so small" : "so large", ".ply or .obj"}, std::to_string(scale));
    for (const char* name : {"a.ply", "a.obj"}) {
      write_mesh(folder_ / name, mesh);
      EXPECT_NEAR(read_mesh(folder_ / name).positions[9999].x / mesh.positions[9999].x, 1, 1e-6) << name << scale;
    }
  }
}

TEST_F(MeshWriterTest, StlHoldsTheCornersAndUnitNormals) {
  const RawMesh mesh = strip(0);
  write_mesh(folder_ / "a.stl", mesh);
  const RawMesh read = read_mesh(folder_ / "a.stl");
  ASSERT_EQ(read.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 97)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(read.positions[read.triangles[t].v[k]], mesh.positions[mesh.triangles[t].v[k]]);
  const std::string bytes = content(folder_ / "a.stl");
  EXPECT_EQ(load<float>(bytes.data() + 84), 0.0f);
  EXPECT_EQ(std::abs(load<float>(bytes.data() + 84 + 8)), 1.0f);
}

TEST_F(MeshWriterTest, NormalisedMeshesAreWrittenInTheSpaceOfTheirFile) {
  const IndexedMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 0.5f, 0.25f}}, {{{0, 1, 2}}}, {{10, 20, 30}, 8}};
  write_mesh(folder_ / "a.ply", mesh);
  EXPECT_EQ(read_mesh(folder_ / "a.ply").positions, (std::vector<Vec3d>{{10, 20, 30}, {18, 20, 30}, {10, 24, 32}}));
}

TEST_F(MeshWriterTest, FailuresLeaveNoFile) {
  const RawMesh mesh = strip(0);
  EXPECT_THROW(write_mesh(folder_ / "a.off", mesh), UnsupportedError);
  EXPECT_THROW(write_mesh(folder_ / "none" / "a.ply", mesh), FileError);
  fs::create_directory(folder_ / "b.ply");
  EXPECT_THROW(write_mesh(folder_ / "b.ply", mesh), FileError);
  fs::remove(folder_ / "b.ply");
  const MeshView failing{2, [](std::size_t i) -> Vec3d { return i == 0 ? Vec3d{} : throw InputError("no"); }, {}};
  EXPECT_THROW(write_mesh(folder_ / "c.obj", failing), InputError);
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace lodestone
