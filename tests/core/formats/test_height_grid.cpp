// Height grids: the surface over them, voids, and the files they come in.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "core/formats/terrain/height_grid.h"
#include "tests/core/formats/io_test_util.h"
#include "tests/test_data.h"

namespace lodestone {
namespace {

const float nan_height = std::nanf("");

HeightGrid grid_of(std::size_t width, std::vector<float> heights) {
  return {
      .width = width, .height = heights.size() / width, .spacing_x = 2, .spacing_y = 3, .heights = std::move(heights)};
}

TEST(HeightGrid, RowsFromTheNorthTrianglesSeenFromAbove) {
  HeightGrid grid = grid_of(3, {4, 5, 6, 1, 2, 3});
  grid.origin_x = 100, grid.origin_y = 200;
  const RawMesh mesh = triangulate(grid);
  EXPECT_EQ(
      mesh.positions,
      (std::vector<Vec3d>{{100, 200, 1}, {102, 200, 2}, {104, 200, 3}, {100, 203, 4}, {102, 203, 5}, {104, 203, 6}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{{0, 1, 4}}, {{0, 4, 3}}, {{1, 2, 5}}, {{1, 5, 4}}}));
  for (const Triangle& t : mesh.triangles) {
    const auto& p = mesh.positions;
    EXPECT_GT(cross(p[t.v[1]] - p[t.v[0]], p[t.v[2]] - p[t.v[0]]).z, 0);
  }
}

TEST(HeightGrid, VoidsStayOpenAndUnusedPostsAreNoVertices) {
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    const std::size_t width = 2 + random() % 6, height = 2 + random() % 6;
    HeightGrid grid = grid_of(width, std::vector<float>(width * height, 1));
    std::uint64_t voids = 0;
    for (float& h : grid.heights)
      if (random() % 4 == 0) h = nan_height, ++voids;
    const RawMesh mesh = triangulate(grid);
    EXPECT_EQ(mesh.void_posts, voids);
    // The twin: count quads of four known posts.
    std::size_t quads = 0;
    for (std::size_t row = 0; row + 1 < height; ++row)
      for (std::size_t column = 0; column + 1 < width; ++column) {
        const auto known = [&](std::size_t r, std::size_t c) { return !std::isnan(grid.heights[r * width + c]); };
        quads += known(row, column) && known(row, column + 1) && known(row + 1, column) && known(row + 1, column + 1);
      }
    EXPECT_EQ(mesh.triangles.size(), 2 * quads);
    std::vector<bool> used(mesh.positions.size());
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t.v) used.at(v) = true;
    EXPECT_EQ(std::count(used.begin(), used.end(), true), static_cast<std::ptrdiff_t>(mesh.positions.size()));
  }
}

TEST(HeightGrid, FillingAPlaneGivesThePlane) {
  const auto plane = [](std::size_t row, std::size_t column) { return 5 + 2 * float(column) - 3 * float(row); };
  HeightGrid grid = grid_of(9, std::vector<float>(63));
  for (std::size_t i = 0; i < 63; ++i) grid.heights[i] = plane(i / 9, i % 9);
  for (std::size_t row = 2; row < 5; ++row)
    for (std::size_t column = 1; column < 7; ++column) grid.heights[row * 9 + column] = nan_height;
  EXPECT_EQ(fill_voids(grid), 18u);
  for (std::size_t i = 0; i < 63; ++i) EXPECT_NEAR(grid.heights[i], plane(i / 9, i % 9), 1e-4) << i;
  EXPECT_EQ(fill_voids(grid), 0u);
}

TEST(HeightGrid, FillingReachesEveryPostAndStaysBetweenTheKnownHeights) {
  // One known post in a corner; then known posts that leave a row and a column empty.
  HeightGrid one = grid_of(4, std::vector<float>(16, nan_height));
  one.heights[0] = 7;
  EXPECT_EQ(fill_voids(one), 15u);
  for (const float h : one.heights) EXPECT_EQ(h, 7);
  HeightGrid two = grid_of(3, {1, nan_height, 3, nan_height, nan_height, nan_height, 5, nan_height, 9});
  EXPECT_EQ(fill_voids(two), 5u);
  for (const float h : two.heights) EXPECT_TRUE(h >= 1 && h <= 9) << h;
  EXPECT_FLOAT_EQ(two.heights[1], 2);
  HeightGrid none = grid_of(2, std::vector<float>(4, nan_height));
  EXPECT_EQ(fill_voids(none), 0u);
}

// A tile of 1201 x 1201 heights, all `height` but for some posts.
std::string srtm_bytes(std::int16_t height, const std::map<std::size_t, std::int16_t>& others = {}) {
  Bytes one("", std::endian::big);
  std::string bytes;
  const std::string post = one.put(height).str();
  for (std::size_t i = 0; i < 1201 * 1201; ++i) bytes += post;
  for (const auto& [at, value] : others) bytes.replace(2 * at, 2, Bytes("", std::endian::big).put(value).str());
  return bytes;
}

TEST(Srtm, HeightsAreBigEndianMetresAndTheNameTellsThePlace) {
  const std::string bytes = srtm_bytes(258, {{0, -32768}, {1, -32767}, {1200, -430}});
  const RawMesh mesh = read_bytes(bytes, MeshFormat::hgt, {}, "somewhere/s01e002.hgt");
  EXPECT_EQ(mesh.void_posts, 2u);
  EXPECT_EQ(mesh.triangles.size(), 2u * (1200 * 1200 - 2));
  EXPECT_EQ(mesh.positions[0], (Vec3d{0, 0, 258}));
  const double degree = std::acos(-1.0) / 180;
  EXPECT_NEAR(mesh.positions.back().y, 6371000 * degree, 1e-6);
  EXPECT_NEAR(mesh.positions[1200].x, 6371000 * degree * std::cos(0.5 * degree), 1e-6);
  EXPECT_EQ(mesh.positions.back().z, -430) << "the Dead Sea is not a void";
  const RawMesh filled = read_bytes(bytes, MeshFormat::hgt, {.fill_voids = true}, "S01E002.hgt");
  EXPECT_EQ(filled.filled_posts, 2u);
  EXPECT_EQ(filled.void_posts, 0u);
  EXPECT_EQ(filled.triangles.size(), 2u * 1200 * 1200);
}

TEST(Srtm, Errors) {
  for (const char* name : {"tile.hgt", "X01E002.hgt", "N1E002.hgt", "N01E0x2.hgt", "N91E000.hgt", "N01E180.hgt"})
    expect_error<InputError>("1234", MeshFormat::hgt, {name, "not that of a corner"}, name);
  expect_error<InputError>("1234", MeshFormat::hgt, {"N01E002.hgt", "4 bytes", "1201 x 1201"}, "N01E002.hgt");
  expect_error<InputError>("", MeshFormat::hgt, {"empty"}, "N01E002.hgt");
  expect_error<InputError>(srtm_bytes(-32768), MeshFormat::hgt, {"no triangle"}, "N01E002.hgt");
}

TEST(Srtm, TilesOfAFolderAreJoined) {
  const TestFolder folder;
  // The seam of the western tile is void in one post, which the eastern one knows.
  folder.write("N10W002.hgt", srtm_bytes(5, {{1200, -32768}}));
  folder.write("n10w001.HGT", srtm_bytes(5, {{7, 9}}));
  folder.write("readme.txt", "no tile");
  const RawMesh mesh = read_mesh(folder.path());
  EXPECT_EQ(mesh.positions.size(), 2401u * 1201);
  EXPECT_EQ(mesh.triangles.size(), 2u * 2400 * 1200);
  EXPECT_EQ(mesh.void_posts, 0u);
  EXPECT_EQ(mesh.positions[1200 * 2401 + 1207].z, 9);

  // A third tile to the north-west leaves a degree without heights.
  folder.write("N11W002.hgt", srtm_bytes(5));
  EXPECT_EQ(read_mesh(folder.path()).void_posts, 1200u * 1200);

  const auto expect_refusal = [&](std::initializer_list<std::string_view> parts) {
    expect_error_of<InputError>([&] { return read_mesh(folder.path()); }, parts);
  };
  folder.write("N11W002.hgt", srtm_bytes(5, {{1200 * 1201, 6}}));
  expect_refusal({folder.path().string(), "N11W002", "differs from its neighbour", "1 m"});
  folder.write("N11W002.hgt", std::string(2 * 3601 * 3601, '\0'));
  expect_refusal({"N11W002", "another resolution"});
  std::filesystem::rename(folder.path() / "N11W002.hgt", folder.path() / "N50E100.hgt");
  folder.write("N50E100.hgt", srtm_bytes(5));
  expect_refusal({"3 tiles", "less than a quarter", "41 by 103"});
}

TEST(EsriGrid, HeadersOfAllKinds) {
  for (const std::string header :
       {"ncols 3\nnrows 2\nxllcorner 99\nyllcorner 199\ncellsize 2\nNODATA_value -1\n",
        "NCOLS 3\r\nNROWS 2\r\nXLLCENTER 100\r\nYLLCENTER 200\r\nCELLSIZE 2\r\nnodata_value -1\r\n",
        "ncols 3\nnrows 2\nxllcenter 100\nyllcenter 200\ndx 2\ndy 2\nNODATA_value -1\n"}) {
    const RawMesh mesh = read_bytes(header + "4 5.5 -1\n1 2\n3e0", MeshFormat::ascii_grid);
    EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{100, 200, 1}, {102, 200, 2}, {100, 202, 4}, {102, 202, 5.5}}));
    EXPECT_EQ(mesh.void_posts, 1u);
  }
}

TEST(EsriGrid, Errors) {
  const auto expect = [](const std::string& text, std::initializer_list<std::string_view> parts) {
    expect_error<InputError>(text, MeshFormat::ascii_grid, parts);
  };
  expect("", {"empty"});
  expect("ncols 2\nnrows 2\n", {"ends in its header"});
  expect("ncols two\n", {"line 1", "'two'"});
  expect("ncols 2\ncellsize 1\n1 2 3 4\n", {"no 'nrows'"});
  expect("ncols 2\nnrows 2\n1 2 3 4\n", {"no 'cellsize'"});
  expect("ncols 1\nnrows 2\ncellsize 1\n1 2\n", {"ncols", "at least 2"});
  expect("ncols 2.5\nnrows 2\ncellsize 1\n1 2\n", {"ncols", "at least 2"});
  expect("ncols 2\nnrows nan\ncellsize 1\n1 2\n", {"nrows"});
  expect("ncols 4000000000\nnrows 4000000000\ncellsize 1\n1 2\n", {"declares", "truncated"});
  expect("ncols 2\nnrows 2\ncellsize -1\n1 2 3 4\n", {"cell size"});
  expect("ncols 2\nnrows 2\nxllcorner inf\ncellsize 1\n1 2 3 4\n", {"origin"});
  expect("ncols 2\nnrows 2\ncellsize 1\n1 2 3\n", {"a height", "the end"});
  expect("ncols 2\nnrows 2\ncellsize 1\n1 2 x 4\n", {"line 4", "'x'"});
  expect("ncols 2\nnrows 2\ncellsize 1\n-9999 2 3 4\n", {"no triangle"});
}

TEST(BareGrid, TypesAndByteOrders) {
  const auto read = [](const std::string& bytes, ScalarType type, std::endian order) {
    return read_bytes(
        bytes, MeshFormat::raw_grid,
        {.raw_grid = RawGridFormat{.width = 2, .height = 2, .type = type, .byte_order = order, .spacing = 10}});
  };
  const std::vector<Vec3d> expected{{0, 0, 3}, {10, 0, 4}, {0, 10, 1}, {10, 10, 2}};
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    Bytes i16("", order), u16("", order), f32("", order), f64("", order);
    for (int i = 1; i <= 4; ++i)
      i16.put(std::int16_t(i)), u16.put(std::uint16_t(i)), f32.put(float(i)), f64.put(double(i));
    EXPECT_EQ(read(i16.str(), ScalarType::int16, order).positions, expected);
    EXPECT_EQ(read(u16.str(), ScalarType::uint16, order).positions, expected);
    EXPECT_EQ(read(f32.str(), ScalarType::float32, order).positions, expected);
    EXPECT_EQ(read(f64.str(), ScalarType::float64, order).positions, expected);
  }
  Bytes voids;
  voids.put(nan_height).put(-9999.f).put(HUGE_VALF).put(1.f);
  expect_error_of<InputError>([&] { return read(voids.str(), ScalarType::float32, std::endian::little); },
                              {"no triangle"});
  expect_error_of<InputError>([&] { return read("123456", ScalarType::int16, std::endian::little); },
                              {"6 bytes", "2 x 2 heights of 2 bytes", "--grid"});
}

TEST(Srtm, RealTilesHaveTheVoidsOfTheirDataSheet) {
  LODESTONE_MODEL_OR_SKIP(path, "terrain/N46E008.hgt");
  EXPECT_EQ(read_mesh(path).void_posts, 103743u);
  const RawMesh filled = read_mesh(path, {.fill_voids = true});
  EXPECT_EQ(filled.filled_posts, 103743u);
  EXPECT_EQ(filled.triangles.size(), 2880000u);
  for (const Vec3d& p : filled.positions) ASSERT_TRUE(p.z > 150 && p.z < 4700) << p.z;  // the Alps
}

}  // namespace
}  // namespace lodestone
