// The format .lpm: back within the quantization, whole, sorted and in part, damaged and foreign.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "core/base/error.h"
#include "core/progressive/lpm/lpm.h"
#include "core/progressive/lpm/lpm_format.h"
#include "core/progressive/mesh/activation.h"
#include "core/progressive/mesh/level.h"
#include "tests/core/progressive/progressive_checks.h"
#include "tests/expect_error.h"
#include "tests/parallel/progressive/progressive_meshes.h"

namespace lodestone::test {
namespace {

// Two levels that are the same triangles, however their corners are turned and ordered.
std::multiset<std::array<std::uint32_t, 3>> as_set(const std::vector<Triangle>& triangles) {
  std::multiset<std::array<std::uint32_t, 3>> out;
  for (const Triangle& t : triangles) {
    auto v = t.v;
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    out.insert(v);
  }
  return out;
}

// On a surface that is almost flat, the level of half the vertices is nearer to the input than a step of 12 bits, which
// would then be most of its error; on a rough one it is farther away than that.
TEST(Lpm, TakesAsManyBitsAsLevelsShow) {
  for (const double height : {0.1, 0.003}) {
    const ProgressiveMesh mesh = progressive_of(terrain_mesh(60, height));
    const float half = mesh.errors[mesh.vertex_count() / 2], twelve = std::ldexp(1.0f, -12);
    ASSERT_EQ(half < twelve / 2, height < 0.1) << half;
    const ProgressiveMesh back = [&] {
      const LpmBytes lpm = encode_lpm(mesh, {.batch = 0});
      ByteReader input = reader_of(lpm.bytes);
      return read_lpm(input);
    }();
    double moved = 0;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
      moved = std::max<double>(moved, length(to_double(back.positions[v]) - to_double(mesh.positions[v])));
    EXPECT_LE(moved, half < twelve ? half : twelve) << height;
    EXPECT_GT(moved, half < twelve ? half / 4 : twelve / 4) << height << ": no more bits than that";
  }
}

TEST(Lpm, ComesBackWithinTheQuantization) {
  for (const ProgressiveMesh& mesh : some_progressive_meshes())
    for (const std::uint32_t bits : {8u, 12u, 20u}) {
      const LpmBytes lpm = encode_lpm(mesh, {.position_bits = bits, .uv_bits = bits, .batch = 0});
      ByteReader input = reader_of(lpm.bytes);
      const ProgressiveMesh back = read_lpm(input);
      ASSERT_EQ(back.parents, mesh.parents);
      ASSERT_EQ(back.base_vertices, mesh.base_vertices);
      ASSERT_EQ(as_set(back.triangles), as_set(mesh.triangles));
      const double step = std::ldexp(1.0, -static_cast<int>(bits));
      for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        EXPECT_LE(std::abs(back.positions[v].x - mesh.positions[v].x), 0.51 * step);
        EXPECT_LE(std::abs(back.positions[v].z - mesh.positions[v].z), 0.51 * step);
        EXPECT_GE(back.errors[v], mesh.errors[v]);
        EXPECT_LE(back.errors[v], mesh.errors[v] * 1.01f);
        if (!mesh.wedges.uv.empty()) {
          EXPECT_NEAR(back.wedges.uv[v].x, mesh.wedges.uv[v].x, 3.1 * step);
        }
      }
      // Levels are those of the mesh, but for triangles that quantization has flattened.
      if (bits < 20) continue;
      const LevelFinder a(mesh), b(back);
      for (const std::uint32_t level : some_levels(mesh, 6))
        EXPECT_EQ(as_set(a.compute_level(level)), as_set(b.compute_level(level)));
    }
}

// Triangles between few points: edges of many triangles, pinched vertices, triangles back to back.
IndexedMesh soup(unsigned seed, bool textured) {
  std::mt19937 random(seed);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  RawMesh raw;
  const std::uint32_t points = 4 + below(16), triangles = points + below(6 * points);
  for (std::uint32_t k = 0; k < points; ++k)
    raw.positions.push_back({0.25 * below(5), 0.25 * below(5), 0.25 * below(5)});
  raw.triangles.push_back({{0, 1, 2}});
  for (std::uint32_t k = 1; k < 4; ++k) raw.positions[k - 1] = {0.1 * k, k == 1 ? 0.9 : 0.3, 0.7};
  for (std::uint32_t k = 1; k < triangles; ++k)
    raw.triangles.push_back({{below(points), below(points), below(points)}});
  for (std::uint32_t k = 0; textured && k < points; ++k)
    raw.wedges.uv.push_back({0.125f * static_cast<float>(below(9)), 0.125f * static_cast<float>(below(9))});
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, *make_serial_scheduler());
}

TEST(Lpm, HoldsWhatWasCutApart) {
  for (unsigned seed = 0; seed < 400; ++seed) {
    ProgressiveMesh mesh = progressive_of(soup(seed, seed % 2 == 1), {.finest_triangles = seed % 3 == 0 ? 20u : 0u});
    const std::vector<std::byte> bytes = encode_lpm(mesh, {.position_bits = 20, .uv_bits = 20, .batch = 0}).bytes;
    ByteReader input = reader_of(bytes);
    const ProgressiveMesh back = read_lpm(input);
    ASSERT_EQ(back.parents, mesh.parents) << seed;
    mesh.errors = back.errors;  // rounded, and flaps come in by them
    progressive::sort_by_activation(mesh);
    const LevelFinder a(mesh), b(back);
    for (std::uint32_t v = mesh.base_vertices; v <= mesh.vertex_count(); ++v) {
      const std::uint32_t level = a.vertices_for(v);
      ASSERT_EQ(as_set(a.compute_level(level)), as_set(b.compute_level(level))) << seed << ' ' << level;
    }
  }
}

// Positions of the corners of triangles, beginning with the least one.
std::multiset<std::array<std::array<float, 3>, 3>> places(const ProgressiveMesh& mesh, std::span<const Triangle> list) {
  std::multiset<std::array<std::array<float, 3>, 3>> out;
  for (const Triangle& t : list) {
    std::array<std::array<float, 3>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f p = mesh.positions[t.v[k]];
      corners[k] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    out.insert(corners);
  }
  return out;
}

// The order within batches changes neither the surface nor the levels between them, and none after them has a hole.
TEST(Lpm, BatchesKeepTheLevelsBetweenThem) {
  std::vector<ProgressiveMesh> meshes = some_progressive_meshes();
  for (unsigned seed = 0; seed < 60; ++seed) meshes.push_back(progressive_of(soup(seed, seed % 2 == 1)));
  for (const ProgressiveMesh& mesh : meshes) {
    const LpmBytes plain = encode_lpm(mesh, {.position_bits = 20, .batch = 0}),
                   sorted = encode_lpm(mesh, {.position_bits = 20, .batch = 8});
    ByteReader plain_input = reader_of(plain.bytes), sorted_input = reader_of(sorted.bytes);
    const ProgressiveMesh a = read_lpm(plain_input), b = read_lpm(sorted_input);
    ASSERT_EQ(a.positions.size(), b.positions.size());
    const LevelFinder a_levels(a), b_levels(b);
    EXPECT_EQ(places(a, a.triangles), places(b, b.triangles));
    if (mesh.positions.size() > 500) {
      EXPECT_LT(sorted.bytes.size(), 0.97 * static_cast<double>(plain.bytes.size()));
    }
    if (!mesh.wedges.uv.empty()) continue;  // below, vertices are groups
    for (std::uint32_t first = mesh.base_vertices; first < mesh.vertex_count(); first += std::max(first / 8, 16u)) {
      EXPECT_EQ(places(a, a_levels.compute_level(first)), places(b, b_levels.compute_level(first))) << first;
      EXPECT_EQ(b.errors[first], a.errors[first]);
    }
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) EXPECT_GE(b.errors[v], a.errors[v]);
    if (open_edges(b, b.triangles) > 0) continue;
    for (const std::uint32_t level : some_levels(b, 9))
      EXPECT_EQ(open_edges(b, b_levels.compute_level(level)), 0u) << level;
  }
}

TEST(Lpm, RefusesUnknownFilters) {
  progressive::LpmHeader header{};
  header.textures = {{.name = "a", .media_type = "image/png", .bytes = {}, .mag_filter = 9729, .min_filter = 9987}};
  const std::string file = "file";
  const Json good = progressive::to_json(header);
  EXPECT_EQ(progressive::read_header(JsonView(good, file)).textures, header.textures);
  for (const std::uint32_t wrong : {5u, 9730u, 9983u, 9988u, 70000u}) {
    Json bad = good;
    bad["textures"][0]["filters"][1] = wrong;
    expect_error_of<InputError>([&] { return progressive::read_header(JsonView(bad, file)); }, {"unknown filter"});
  }
}

TEST(Lpm, RefusesWhatItCannotUndo) {
  const auto refused = [](std::vector<Triangle> triangles, std::uint32_t base, const char* why) {
    ProgressiveMesh mesh;
    for (const Triangle& t : triangles)
      for (const std::uint32_t v : t.v) mesh.positions.resize(std::max<std::size_t>(mesh.positions.size(), v + 1));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) mesh.positions[v] = {0.1f * static_cast<float>(v), 0, 0};
    mesh.parents.assign(mesh.positions.size(), 0);
    mesh.errors.assign(mesh.positions.size(), 0);
    mesh.triangles = std::move(triangles);
    mesh.base_vertices = base;
    expect_error_of<InputError>([&] { return encode_lpm(mesh); }, {why, ".glb"}, why);
  };
  refused({{0, 1, 2}, {0, 3, 4}}, 5, "not a manifold");
  refused({{0, 1, 3}}, 4, "has no triangle");
  refused({{0, 1, 2}, {1, 3, 2}}, 3, "share no edge");
  refused({{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}, 3, "changes the shape");
}

TEST(Lpm, APrefixIsACoarserMesh) {
  const auto scheduler = make_serial_scheduler();
  const ProgressiveMesh mesh = progressive_of(textured_torus(60, 50, true, *scheduler));
  const LpmBytes lpm = encode_lpm(mesh, {.position_bits = 20, .uv_bits = 20, .batch = 0});
  const LevelFinder levels(mesh);
  std::uint32_t most = 0;
  for (std::size_t size = lpm.base; size < lpm.bytes.size(); size += 997) {
    const std::span bytes = std::span(lpm.bytes).first(size);
    ByteReader input = reader_of(bytes), again = reader_of(bytes);
    EXPECT_THROW((void)read_lpm(input), InputError);
    const ProgressiveMesh part = read_lpm(again, true);
    EXPECT_GE(part.vertex_count(), most);
    most = part.vertex_count();
    EXPECT_EQ(as_set(part.triangles), as_set(levels.compute_level(most)));
  }
  EXPECT_GT(most, mesh.vertex_count() / 2);
}

TEST(Lpm, RefusesDamagedAndForeignFiles) {
  const LpmBytes lpm = encode_lpm(progressive_of(sphere_mesh(4)));
  const auto refused = [](std::vector<std::byte> bytes, bool prefix, const char* what) {
    ByteReader input = reader_of(bytes);
    expect_error_of<InputError>([&] { return read_lpm(input, prefix); }, {what}, what);
  };
  std::vector<std::byte> bytes = lpm.bytes;
  refused({bytes.begin(), bytes.begin() + 10}, true, "not a progressive mesh");
  refused({bytes.begin(), bytes.begin() + 40}, true, "ends within its header");
  refused({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(lpm.base) - 1}, true, "ends early");
  for (const std::size_t at : {std::size_t{20}, lpm.base - 2, lpm.base + 40, bytes.size() - 1}) {
    bytes[at] ^= std::byte{0x10};
    refused(bytes, false, "checksum");
    bytes[at] ^= std::byte{0x10};
  }
  bytes.push_back(std::byte{0});
  refused(bytes, false, "more data than the header declares");
  refused(std::vector<std::byte>(100), false, "not a progressive mesh");
}

}  // namespace
}  // namespace lodestone::test
