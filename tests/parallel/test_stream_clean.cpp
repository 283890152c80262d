// Cleaning of meshes that remain in their file: the twin of prepare_mesh, and errors of bad files.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <string>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "parallel/clean/stream_clean.h"
#include "parallel/mesh/load.h"
#include "parallel/mesh/mesh_stream.h"
#include "tests/expect_error.h"
#include "tests/parallel/stream_meshes.h"
#include "tests/test_bytes.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class StreamTest : public FolderTest {};

// For any number of workers and any memory, down to that for a few hundred hashes.
void expect_same_as_in_memory(const fs::path& path, Lattice lattice = {}) {
  const auto serial = make_serial_scheduler();
  Repairs repairs;
  const IndexedMesh expected = clean_mesh(load_mesh(path, *serial), repairs, {}, lattice);
  const auto stream = open_mesh_stream(path);
  ASSERT_NE(stream, nullptr) << path;
  for (const int threads : {0, 1, 2, 7})
    for (const std::size_t rounds : {1, 3, 40}) {
      const auto working_bytes = 9 * static_cast<std::size_t>(stream->triangle_count()) / rounds + 100;
      const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
      const CleanStream clean = clean_stream(*stream, lattice, working_bytes, *scheduler);
      EXPECT_EQ(clean.repairs, repairs) << path;
      EXPECT_EQ(clean.triangles, expected.triangles.size());
      EXPECT_TRUE(test::same_bytes(clean.positions, expected.positions)) << path;
      EXPECT_EQ(clean.transform, expected.transform);
      const auto count = static_cast<std::size_t>(stream->triangle_count());
      EXPECT_TRUE(test::same_bytes(clean.read(*stream, 0, count), expected.triangles)) << path;
      std::vector<Triangle> pieces = clean.read(*stream, 0, count / 3);
      const std::vector<Triangle> rest = clean.read(*stream, count / 3, count - count / 3);
      pieces.insert(pieces.end(), rest.begin(), rest.end());
      EXPECT_TRUE(test::same_bytes(pieces, expected.triangles)) << path;
    }
}

TEST_F(StreamTest, SameAsInMemory) {
  const RawMesh sphere = test::raw_of(test::sphere_mesh(5)), terrain = test::raw_of(test::terrain_mesh(80));
  test::write_ply(folder_ / "sphere.ply", sphere);
  test::write_ply(folder_ / "terrain.ply", terrain, true);
  for (const char* name : {"sphere.ply", "terrain.ply"})
    for (const Lattice lattice : {Lattice{}, Lattice{12}, Lattice{Lattice::automatic}})
      expect_same_as_in_memory(folder_ / name, lattice);
}

TEST_F(StreamTest, SameRepairsOfEveryFault) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    test::write_ply(folder_ / "faulty.ply", test::with_faults(test::raw_of(test::sphere_mesh(5)), seed), seed == 3);
    for (const Lattice lattice : {Lattice{}, Lattice{6}, Lattice{Lattice::automatic}})
      expect_same_as_in_memory(folder_ / "faulty.ply", lattice);
  }
}

TEST_F(StreamTest, SameForMoreTrianglesThanAPieceHas) {
  test::write_ply(folder_ / "large.ply", test::with_faults(test::raw_of(test::terrain_mesh(300)), 7));
  expect_same_as_in_memory(folder_ / "large.ply", {Lattice::automatic});
}

TEST_F(StreamTest, SoupsOfStlAreWelded) {
  const IndexedMesh mesh = test::torus_mesh(60, 40);
  write_mesh(folder_ / "torus.stl", mesh);
  expect_same_as_in_memory(folder_ / "torus.stl");
  const auto stream = open_mesh_stream(folder_ / "torus.stl");
  std::vector<Vec3d> all(stream->vertex_count()), part(5);
  stream->read_vertices(0, all);
  for (const std::uint64_t first : {0, 1, 2, 3, 100}) {
    stream->read_vertices(first, part);
    EXPECT_TRUE(std::equal(part.begin(), part.end(), all.begin() + static_cast<std::ptrdiff_t>(first)));
  }
}

TEST_F(StreamTest, OtherFilesAreNoStreams) {
  const IndexedMesh mesh = test::torus_mesh(10, 10);
  write_mesh(folder_ / "torus.obj", mesh);
  EXPECT_EQ(open_mesh_stream(folder_ / "torus.obj"), nullptr);
  EXPECT_EQ(open_mesh_stream(folder_), nullptr);
  test::write_ply(folder_ / "torus.ply", test::raw_of(mesh));
  std::string bytes = content(folder_ / "torus.ply");
  std::ofstream(folder_ / "cut.ply", std::ios::binary) << bytes.substr(0, bytes.size() - 1);
  EXPECT_EQ(open_mesh_stream(folder_ / "cut.ply"), nullptr);
  const std::size_t at = bytes.find("property float z\n") + 17;
  bytes.insert(at, "property uchar red\nproperty uchar green\nproperty uchar blue\n");
  // The faces begin within a vertex, as no colours are there: the first is not a triangle.
  std::ofstream(folder_ / "faces.ply", std::ios::binary) << bytes << std::string(1000, '\0');
  EXPECT_EQ(open_mesh_stream(folder_ / "faces.ply"), nullptr);
  for (std::size_t end = bytes.find("end_header\n") + 11 + 12 * mesh.positions.size();
       end > bytes.find("end_header\n") + 11; end -= 12)
    bytes.insert(end, "\1\2\3");
  std::ofstream(folder_ / "coloured.ply", std::ios::binary) << bytes;
  EXPECT_TRUE(open_mesh_stream(folder_ / "coloured.ply")->has_attributes());
  EXPECT_FALSE(open_mesh_stream(folder_ / "coloured.ply", {.attributes = false})->has_attributes());
}

TEST_F(StreamTest, BadFacesAndFilesThatShrinkAreErrors) {
  const auto scheduler = make_tbb_scheduler(2);
  RawMesh raw = test::raw_of(test::torus_mesh(50, 50));
  raw.triangles[1234].v[1] = 1u << 30;
  test::write_ply(folder_ / "index.ply", raw);
  const auto stream = open_mesh_stream(folder_ / "index.ply");
  expect_error_of<InputError>([&] { return clean_stream(*stream, {}, 1 << 20, *scheduler); },
                              {"index.ply: face 1234: "});
  raw.triangles[1234].v[1] = 0;
  test::write_ply(folder_ / "cut.ply", raw);
  const auto shrunk = open_mesh_stream(folder_ / "cut.ply");
  fs::resize_file(folder_ / "cut.ply", fs::file_size(folder_ / "cut.ply") / 2);
  EXPECT_THROW((void)clean_stream(*shrunk, {}, 1 << 20, *scheduler), InputError);
}

TEST_F(StreamTest, MeshesWithoutASurfaceAreErrors) {
  const auto scheduler = make_serial_scheduler();
  RawMesh raw = test::raw_of(test::torus_mesh(4, 4));
  for (Triangle& t : raw.triangles) t.v[2] = t.v[0];
  test::write_ply(folder_ / "flat.ply", raw);
  EXPECT_THROW((void)clean_stream(*open_mesh_stream(folder_ / "flat.ply"), {}, 1 << 20, *scheduler), InputError);
}

TEST_F(StreamTest, TellsFilesApart) {
  RawMesh raw = test::raw_of(test::torus_mesh(50, 50));
  test::write_ply(folder_ / "a.ply", raw);
  const std::uint64_t identity = open_mesh_stream(folder_ / "a.ply")->identity();
  EXPECT_EQ(identity, open_mesh_stream(folder_ / "a.ply")->identity());
  const auto time = fs::last_write_time(folder_ / "a.ply");
  fs::last_write_time(folder_ / "a.ply", time + std::chrono::seconds(1));
  EXPECT_NE(identity, open_mesh_stream(folder_ / "a.ply")->identity());
  raw.positions[0].x += 1;
  test::write_ply(folder_ / "a.ply", raw);
  fs::last_write_time(folder_ / "a.ply", time);
  EXPECT_NE(identity, open_mesh_stream(folder_ / "a.ply")->identity());
}

}  // namespace
}  // namespace lodestone
