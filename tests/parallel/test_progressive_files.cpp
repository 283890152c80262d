// Files of progressive meshes: back bit for bit or within the quantization, whole and in part, damaged and foreign.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "core/base/error.h"
#include "core/progressive/gltf/progressive_glb.h"
#include "core/progressive/lpm/range_coder.h"
#include "core/progressive/mesh/activation.h"
#include "core/progressive/mesh/level.h"
#include "core/progressive/progressive_file.h"
#include "core/texture/image_codec.h"
#include "parallel/progressive/make_progressive.h"
#include "tests/core/progressive/progressive_checks.h"
#include "tests/expect_error.h"
#include "tests/parallel/progressive_meshes.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

ProgressiveMesh make(const IndexedMesh& mesh, std::size_t base = 0) {
  const auto scheduler = make_serial_scheduler();
  ProgressiveReport report;
  return make_progressive(mesh, {.base_triangles = base}, *scheduler, report);
}

std::vector<ProgressiveMesh> some_meshes() {
  const auto scheduler = make_serial_scheduler();
  std::vector<ProgressiveMesh> out;
  out.push_back(make(test::sphere_mesh(5)));
  out.push_back(make(test::sphere_mesh(4), 300));
  out.push_back(make(test::terrain_mesh(40)));
  out.push_back(make(test::textured_torus(40, 30, false, *scheduler)));
  out.push_back(make(test::textured_torus(40, 30, true, *scheduler)));
  out.push_back(make(test::touching_cubes(6, *scheduler)));
  return out;
}

template <class Bytes>
ByteReader reader_of(const Bytes& bytes) {
  return ByteReader({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "test");
}

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

TEST(RangeCoder, GivesBackWhatWasWritten) {
  std::mt19937 random(3);
  std::vector<std::uint32_t> values;
  for (int k = 0; k < 20000; ++k) values.push_back(static_cast<std::uint32_t>(random() >> (random() % 32) >> 1));
  progressive::RangeEncoder encoder;
  progressive::BitModel bit;
  progressive::NumberModel number;
  progressive::SignedModel sign;
  for (const std::uint32_t v : values) {
    encoder.bit(bit, v % 7 == 0 ? 1 : 0);
    number.code(encoder, v);
    encoder.direct(11, v & 0x7ff);
    sign.code(encoder, static_cast<std::int32_t>(v % 1000) - 500);
  }
  const std::vector<std::byte> bytes = encoder.finish();
  progressive::RangeDecoder decoder(bytes);
  bit = {}, number = {}, sign = {};
  for (const std::uint32_t v : values) {
    ASSERT_EQ(decoder.bit(bit), v % 7 == 0 ? 1u : 0u);
    ASSERT_EQ(number.code(decoder, 0), v);
    ASSERT_EQ(decoder.direct(11), v & 0x7ff);
    ASSERT_EQ(sign.code(decoder, 0), static_cast<std::int32_t>(v % 1000) - 500);
  }
}

TEST(RangeCoder, SpendsNearlyNothingOnWhatNeverChanges) {
  progressive::RangeEncoder encoder;
  progressive::BitModel bit;
  for (int k = 0; k < 80000; ++k) encoder.bit(bit, 0);
  EXPECT_LT(encoder.finish().size(), 300u);
}

TEST(ProgressiveGlb, ComesBackBitForBit) {
  for (const ProgressiveMesh& mesh : some_meshes())
    for (const bool compressed : {false, true}) {
      const std::vector<std::byte> bytes = encode_progressive_glb(mesh, compressed);
      ByteReader input = reader_of(bytes);
      const ProgressiveMesh back = read_progressive_glb(input);
      EXPECT_EQ(back.positions, mesh.positions);
      EXPECT_EQ(back.parents, mesh.parents);
      EXPECT_EQ(back.triangles, mesh.triangles);
      EXPECT_EQ(back.base_vertices, mesh.base_vertices);
      EXPECT_EQ(back.wedges.uv, mesh.wedges.uv);
      EXPECT_EQ(back.wedges.normal, mesh.wedges.normal);
      EXPECT_EQ(back.transform, mesh.transform);
      for (std::size_t v = 0; v < mesh.errors.size(); ++v) EXPECT_NEAR(back.errors[v], mesh.errors[v], 1e-6);
    }
}

TEST(ProgressiveFiles, KeepNormalsInObjectSpace) {
  ProgressiveMesh mesh = some_meshes().front();
  mesh.wedges.uv.assign(mesh.positions.size(), {});
  const PixelImage pixel{.size = {1, 1}, .channels = 3, .pixels = {1, 2, 3}};
  const std::vector<char> bytes = encode_image(pixel, "image/png");
  mesh.wedges.materials = {{.name = "skin", .texture = 0}};
  mesh.wedges.textures = {{.name = "colour", .media_type = "image/png", .bytes = bytes},
                          {.name = "normals", .media_type = "image/png", .bytes = bytes}};
  mesh.object_normals = {1};
  const auto check = [&](ByteReader input) {
    const ProgressiveMesh back = read_progressive(input);
    EXPECT_EQ(back.object_normals, mesh.object_normals);
    EXPECT_EQ(back.wedges.materials, mesh.wedges.materials);
    EXPECT_EQ(back.wedges.textures, mesh.wedges.textures);
  };
  const std::vector<std::byte> glb = encode_progressive_glb(mesh, false), lpm = encode_lpm(mesh, {}).bytes;
  check(reader_of(glb));
  check(reader_of(lpm));
}

TEST(ProgressiveGlb, RefusesGltfWithoutParents) {
  const std::string text =
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  ByteReader input({text.data(), text.size()}, "plain.gltf");
  expect_error_of<InputError>([&] { return read_progressive_glb(input); }, {"not progressive"});
}

TEST(Lpm, ComesBackWithinTheQuantization) {
  for (const ProgressiveMesh& mesh : some_meshes())
    for (const std::uint32_t bits : {8u, 12u, 20u}) {
      const LpmBytes lpm = encode_lpm(mesh, {.position_bits = bits, .uv_bits = bits});
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
      for (const std::uint32_t level : test::some_levels(mesh, 6))
        EXPECT_EQ(as_set(a.compute_level(level)), as_set(b.compute_level(level)));
    }
}

TEST(Lpm, APrefixIsACoarserMesh) {
  const auto scheduler = make_serial_scheduler();
  const ProgressiveMesh mesh = make(test::textured_torus(60, 50, true, *scheduler));
  const LpmBytes lpm = encode_lpm(mesh, {.position_bits = 20, .uv_bits = 20});
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
  const LpmBytes lpm = encode_lpm(make(test::sphere_mesh(4)));
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

TEST(ProgressiveFiles, ByExtension) {
  const TestFolder folder;
  const ProgressiveMesh mesh = make(test::sphere_mesh(3));
  for (const char* name : {"a.lpm", "a.GLB"}) {
    const ProgressiveFileSize size = save_progressive(mesh, folder / name);
    EXPECT_EQ(std::filesystem::file_size(folder / name), size.bytes);
    EXPECT_EQ(load_progressive(folder / name).parents, mesh.parents);
  }
  EXPECT_THROW(save_progressive(mesh, folder / "a.ply"), UnsupportedError);
  EXPECT_THROW((void)load_progressive(folder / "none.lpm"), FileError);
}

// Messages of the checks for damaged values, for any kind of file.
TEST(ProgressiveFiles, ContradictionsAreNamed) {
  const ProgressiveMesh sound = make(test::sphere_mesh(2));
  const auto refused = [&](auto change, const char* what) {
    ProgressiveMesh mesh = sound;
    change(mesh);
    expect_error_of<InputError>([&] { check_progressive(mesh, "test"); }, {what}, what);
  };
  check_progressive(sound, "test");
  refused([](ProgressiveMesh& m) { m.parents.pop_back(); }, "not one per vertex");
  refused([](ProgressiveMesh& m) { m.base_vertices = 1u << 20; }, "base has more vertices");
  refused([](ProgressiveMesh& m) { m.parents.back() = m.vertex_count() - 1; }, "comes in after it");
  refused([](ProgressiveMesh& m) { m.errors.front() = -1; }, "not a distance");
  refused([](ProgressiveMesh& m) { m.errors.back() = 10; }, "larger than that of the vertex before");
  refused([](ProgressiveMesh& m) { m.positions[3].x = NAN; }, "not finite");
  refused([](ProgressiveMesh& m) { m.triangles[0].v[1] = 1u << 20; }, "there is no vertex");
}

}  // namespace
}  // namespace lodestone
