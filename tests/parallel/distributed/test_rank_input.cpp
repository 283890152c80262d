// Several files as one mesh, read by several ranks: the bytes of a build of the same files on one machine.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/mesh/generate.h"
#include "parallel/mesh/load.h"
#include "tests/expect_error.h"
#include "tests/parallel/distributed/distributed.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

class RankInputTest : public testing::Distributed {
 protected:
  RankInputTest() {
    whole_ = generate_mesh({Shape::terrain, 8000, 3});
    config_.build.sigma0 = 0.4f;
  }

  // Triangles [first, last) with vertices of their own. PLY in text is read as a whole, and binary PLY in pieces.
  fs::path part(const std::string& name, std::size_t first, std::size_t last) const {
    RawMesh mesh;
    for (std::size_t t = first; t < last; ++t) {
      Triangle& triangle = mesh.triangles.emplace_back();
      for (int k = 0; k < 3; ++k) {
        triangle.v[k] = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(whole_.positions[whole_.triangles[t].v[k]]);
      }
    }
    const fs::path path = folder_ / name;
    if (path.extension() == ".off") return write_off(path, mesh);
    write_mesh(path, mesh);
    return path;
  }

  // With a quad, and a face of two corners.
  static fs::path write_off(const fs::path& path, const RawMesh& mesh) {
    std::ofstream out(path);
    out.precision(17);
    out << "OFF\n" << mesh.positions.size() + 4 << ' ' << mesh.triangles.size() + 2 << " 0\n";
    for (const Vec3d& p : mesh.positions) out << p.x << ' ' << p.y << ' ' << p.z << '\n';
    out << "0 0 2\n1 0 2\n1 1 2\n0 1 2\n";
    for (const Triangle& t : mesh.triangles) out << "3 " << t.v[0] << ' ' << t.v[1] << ' ' << t.v[2] << '\n';
    const std::size_t quad = mesh.positions.size();
    out << "4 " << quad << ' ' << quad + 1 << ' ' << quad + 2 << ' ' << quad + 3 << "\n2 0 1\n";
    return path;
  }

  // A tileset of three models, one of them within an external tileset.
  fs::path tileset() const {
    for (int i = 0; i < 3; ++i)
      part("t" + std::to_string(i) + ".glb", static_cast<std::size_t>(i) * 1000,
           static_cast<std::size_t>(i + 1) * 1000);
    const std::string volume = R"("boundingVolume": {"sphere": [0, 0, 0, 10]}, "geometricError": 0)";
    const auto write = [&](const char* name, const std::string& root) {
      std::ofstream(folder_ / name) << R"({"asset": {"version": "1.1"}, "geometricError": 1, "root": {)" << volume
                                    << ", " << root << "}}";
      return folder_ / name;
    };
    write("more.json",
          R"("content": {"uri": "t1.glb"}, "transform": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1])");
    return write("tileset.json", R"("children": [{)" + volume + R"(, "content": {"uri": "t0.glb"}}, {)" + volume +
                                     R"(, "content": {"uri": "more.json"}}, {)" + volume +
                                     R"(, "content": {"uri": "t2.glb"}}])");
  }

  std::shared_ptr<const MeshStream> opened(const std::vector<fs::path>& files, int ranks,
                                           std::vector<std::uint64_t>& sizes) const {
    std::shared_ptr<const MeshStream> first;
    run_local_ranks(ranks, [&](Transport& transport) {
      Ranks all(transport);
      const RankInput input = open_rank_input(files, {.attributes = false}, all, *make_serial_scheduler());
      if (transport.rank() > 0) return;
      first = input.stream;
      for (int r = 0; r < ranks; ++r) sizes.push_back(input.triangles.size(r));
    });
    return first;
  }

  RawMesh whole_;
};

TEST_F(RankInputTest, SeveralFilesOfAnyFormatAreOneMesh) {
  const std::size_t count = whole_.triangles.size();
  expect_same({part("a.ply", 0, 3000), part("b.stl", 3000, 3100), part("c.ply", 3100, count)});
  expect_same({part("a.off", 0, 1000), part("b.ply", 1000, 3000), part("c.off", 3000, count), part("d.stl", 0, 10)});
}

TEST_F(RankInputTest, TilesAreDealtOut) {
  expect_same(tileset());
  expect_same({part("a.ply", 3000, 4000), tileset()});
}

TEST_F(RankInputTest, RepairsOfReadersAreCounted) {
  const std::vector<fs::path> files{part("a.off", 0, 1000), part("b.ply", 1000, 3000), part("c.off", 3000, 4000)};
  const auto scheduler = make_serial_scheduler();
  ModelConfig config{.build = config_.build, .output = folder_ / "expected.lode"};
  const Repairs expected = build_model(ModelSource{files}, config, *scheduler).hierarchy.provenance.repairs;
  EXPECT_EQ(expected.polygons_triangulated, 2u);
  EXPECT_EQ(expected.faces_dropped, 2u);
  const OpenInput open = [&](Ranks& ranks, Scheduler& workers) { return open_rank_input(files, {}, ranks, workers); };
  EXPECT_EQ(build(open, 3, 0).tables.provenance.repairs, expected);
}

// A binary file is cut where it has to be; of the others a rank has whole ones.
TEST_F(RankInputTest, FilesAreSharedOutByTheirBytes) {
  std::vector<std::uint64_t> sizes;
  EXPECT_EQ(opened({part("a.ply", 0, 4000)}, 4, sizes)->triangle_count(), 4000u);
  EXPECT_EQ(sizes, (std::vector<std::uint64_t>{1000, 1000, 1000, 1000}));
  sizes.clear();
  (void)opened({part("a.off", 0, 1000), part("b.off", 0, 1000), part("c.off", 0, 1000)}, 3, sizes);
  EXPECT_EQ(sizes, (std::vector<std::uint64_t>{1001 + 1, 1002, 1002}));
  sizes.clear();
  (void)opened({part("a.off", 0, 1000)}, 3, sizes);
  EXPECT_EQ(sizes, (std::vector<std::uint64_t>{1002, 0, 0}));  // where textures would go
}

TEST_F(RankInputTest, ErrorsNameTheFileOfAPart) {
  const fs::path good = part("a.ply", 0, 1000), bad = part("b.off", 0, 1000);
  fs::resize_file(bad, 5000);
  expect_error_of<InputError>([&] { (void)built({good, bad}, 3, 0); }, {"rank ", "b.off", "line "});
  expect_error_of<FileError>([&] { (void)built({good, folder_ / "none.ply"}, 3, 0); }, {"none.ply"});
  const fs::path turned = part("c.obj", 0, 1000);
  const auto scheduler = make_serial_scheduler();
  expect_error_of<InputError>([&] { (void)built({good, turned}, 2, 0); }, {"c.obj", "y as its up axis", "z", "--up"});
  expect_error_of<InputError>(
      [&] {
        (void)load_meshes(std::vector{good, turned}, *scheduler);
      },
      {"c.obj", "y as its up axis", "z", "--up"});
}

// Binary PLY of other faces is read as a whole.
TEST_F(RankInputTest, PolygonsOfBinaryFilesAreRead) {
  RawMesh mesh;
  for (std::uint32_t y = 0; y < 20; ++y)
    for (std::uint32_t x = 0; x < 20; ++x) mesh.positions.push_back({x * 1.0, y * 1.0, std::sin(0.3 * x * y)});
  std::ofstream out(folder_ / "quads.ply", std::ios::binary);
  out << ply_header(400, 361, ScalarType::float32);
  for (const Vec3d& p : mesh.positions) {
    const Vec3f position = to_float(p);
    out.write(reinterpret_cast<const char*>(&position), sizeof(position));
  }
  for (std::uint32_t y = 0; y < 19; ++y)
    for (std::uint32_t x = 0; x < 19; ++x) {
      const std::uint32_t v[4]{20 * y + x, 20 * y + x + 1, 20 * y + x + 21, 20 * y + x + 20};
      out.put(4).write(reinterpret_cast<const char*>(v), sizeof(v));
    }
  out.close();
  expect_same({folder_ / "quads.ply", part("a.ply", 0, 500)});
}

TEST_F(RankInputTest, RanksSeeTheSameFiles) {
  const fs::path one = part("one.ply", 0, 1000), other = part("other.ply", 0, 1001);
  const OpenInput open = [&](Ranks& ranks, Scheduler& workers) {
    return open_rank_input(std::vector{ranks.rank() == 1 ? other : one}, {}, ranks, workers);
  };
  expect_error_of<InputError>([&] { (void)build(open, 3, 0); }, {".ply", "differs from rank to rank"});
}

}  // namespace
}  // namespace lodestone
