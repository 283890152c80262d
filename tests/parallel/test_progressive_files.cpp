// Files of progressive meshes: back bit for bit or within the quantization, whole and in part, damaged and foreign.
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <random>

#include "core/base/error.h"
#include "core/files/byte_reader.h"
#include "core/mesh/generate.h"
#include "core/progressive/gltf/progressive_glb.h"
#include "core/progressive/lpm/lpm_format.h"
#include "core/progressive/mesh/activation.h"
#include "core/progressive/mesh/level.h"
#include "core/progressive/mesh/thumbnails.h"
#include "core/progressive/progressive_file.h"
#include "core/texture/downsample.h"
#include "core/texture/image_codec.h"
#include "parallel/progressive/make_progressive.h"
#include "parallel/scheduler/runner.h"
#include "tests/core/progressive/progressive_checks.h"
#include "tests/expect_error.h"
#include "tests/parallel/progressive_meshes.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

ProgressiveMesh make(const IndexedMesh& mesh, std::size_t base = 0, std::size_t finest = 0) {
  const auto scheduler = make_serial_scheduler();
  ProgressiveReport report;
  return make_progressive(mesh, {.base_triangles = base, .finest_triangles = finest}, *scheduler, report);
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
      Transform transform = mesh.transform;
      transform.up.guessed = false;  // written, it is the file's
      EXPECT_EQ(back.transform, transform);
      for (std::size_t v = 0; v < mesh.errors.size(); ++v) EXPECT_NEAR(back.errors[v], mesh.errors[v], 1e-6);
    }
}

// Half of the surface has a material; the reader must not give it to the rest.
TEST(ProgressiveFiles, KeepTrianglesWithoutAMaterial) {
  RawMesh raw = generate_mesh({Shape::sphere, 600, 1});
  raw.materials = {{.name = "red", .base_colour = {1, 0, 0, 1}}};
  for (std::size_t t = 0; t < raw.triangles.size(); ++t)
    raw.wedges.material.push_back(t < raw.triangles.size() / 2 ? 0 : no_material);
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  const ProgressiveMesh mesh = make(prepare_mesh(std::move(raw), repairs, *scheduler));
  const auto bare = [](const ProgressiveMesh& m) {
    return std::ranges::count_if(m.triangles, [&](const Triangle& t) {
      return !m.wedges.material.empty() && m.wedges.material[t.v[0]] == no_material;
    });
  };
  EXPECT_GT(bare(mesh), 0);
  for (const std::vector<std::byte>& bytes : {encode_progressive_glb(mesh, false), encode_lpm(mesh, {}).bytes}) {
    ByteReader input = reader_of(bytes);
    const ProgressiveMesh back = read_progressive(input);
    EXPECT_EQ(back.wedges.materials, mesh.wedges.materials);
    EXPECT_EQ(bare(back), bare(mesh));
  }
}

TEST(ProgressiveFiles, KeepMapsOverTheSphere) {
  ProgressiveMesh mesh = some_meshes().front();
  mesh.wedges.uv.assign(mesh.positions.size(), {});
  const PixelImage pixel{.size = {1, 1}, .channels = 3, .pixels = {1, 2, 3}};
  const std::vector<char> bytes = encode_image(pixel, "image/png");
  Material skin{.name = "skin", .texture = 0, .normal_scale = 0.5f, .metallic = 0.25f, .roughness = 0.5f};
  skin.normal_map = skin.occlusion.texture = 1;
  skin.emissive_map = {2, {{0.5f, 0}, {2, 2}, 0}};
  skin.emissive = {0.5f, 1, 0};
  skin.alpha_mode = AlphaMode::mask, skin.alpha_cutoff = 0.25f;
  skin.double_sided = skin.unlit = true;
  skin.extensions = R"({"KHR_materials_sheen":{"sheenColorTexture":{"index":0}}})";
  skin.extension_textures = {2};
  mesh.wedges.materials = {skin};
  mesh.wedges.textures = {{.name = "colour", .media_type = "image/png", .bytes = bytes},
                          {.name = "normals", .media_type = "image/png", .bytes = bytes},
                          {.name = "geometry", .media_type = "image/png", .bytes = bytes}};
  mesh.wedges.textures[1].mag_filter = 9728, mesh.wedges.textures[1].min_filter = 9984;
  mesh.object_normals = {1};
  mesh.geometry_images = {{2, {0.1, -2, 3e7}, 1.0 / 3}};
  mesh.octahedral = {OctahedralLayout{256, {{64, 2}, {16, 30}}}};
  const auto check = [&](ByteReader input) {
    const ProgressiveMesh back = read_progressive(input);
    EXPECT_EQ(back.object_normals, mesh.object_normals);
    EXPECT_EQ(back.geometry_images, mesh.geometry_images);
    EXPECT_EQ(back.octahedral, mesh.octahedral);
    EXPECT_EQ(back.wedges.materials, mesh.wedges.materials);
    EXPECT_EQ(back.wedges.textures, mesh.wedges.textures);
  };
  const std::vector<std::byte> glb = encode_progressive_glb(mesh, false), lpm = encode_lpm(mesh, {}).bytes;
  check(reader_of(glb));
  check(reader_of(lpm));
}

// A colour picture and normals, both larger than their thumbnails, a picture that is one, and a foreign image.
ProgressiveMesh pictured_mesh() {
  ProgressiveMesh mesh = some_meshes().front();
  mesh.wedges.uv.assign(mesh.positions.size(), {});
  PixelImage image{.size = {200, 100}, .channels = 3, .pixels = {}};
  for (std::uint32_t k = 0; k < 200 * 100 * 3; ++k) image.pixels.push_back(static_cast<std::uint8_t>(k * k >> 7));
  PixelImage dot{.size = {2, 2}, .channels = 3, .pixels = std::vector<std::uint8_t>(12, 90)};
  const auto texture = [](const char* name, const char* type, std::vector<char> bytes) {
    return Texture{.name = name, .media_type = type, .bytes = std::move(bytes)};
  };
  mesh.wedges.textures = {texture("colour", "image/png", encode_image(image, "image/png")),
                          texture("normals", "image/jpeg", encode_image(image, "image/jpeg")),
                          texture("dot", "image/png", encode_image(dot, "image/png")),
                          texture("foreign", "image/ktx2", {'k', 't', 'x'}),
                          texture("unused", "image/png", encode_image(image, "image/png"))};
  mesh.wedges.materials = {{.name = "a", .texture = 0}, {.name = "b", .texture = 2}, {.name = "c", .texture = 3}};
  mesh.wedges.material.assign(mesh.positions.size(), 0);
  mesh.object_normals = {1, no_texture, no_texture};
  return mesh;
}

TEST(Thumbnails, AreSmallPicturesOfWhatIsDrawn) {
  const ProgressiveMesh mesh = pictured_mesh();
  const std::vector<Texture>&textures = mesh.wedges.textures, thumbnails = make_thumbnails(mesh);
  ASSERT_EQ(thumbnails.size(), textures.size());
  for (const std::size_t k : {0u, 1u}) {
    EXPECT_EQ(thumbnails[k].media_type, "image/webp");
    EXPECT_EQ(image_size(thumbnails[k].bytes, "image/webp"), (PixelSize{50, 25}));
    EXPECT_LT(thumbnails[k].bytes.size(), 3000u);
  }
  EXPECT_EQ(thumbnails[2], textures[2]);
  EXPECT_TRUE(thumbnails[3].bytes.empty() && thumbnails[4].bytes.empty());
  // The mean of the picture remains.
  const auto mean = [](const Texture& t) {
    const LinearImage image = to_linear(decode_image(t.bytes, t.media_type), PixelMeaning::colours);
    double sum = 0;
    for (const float x : image.values) sum += x;
    return sum / static_cast<double>(image.values.size());
  };
  EXPECT_NEAR(mean(thumbnails[0]), mean(textures[0]), 0.02);
}

TEST(Thumbnails, AreTheSameSideBySide) {
  const ProgressiveMesh mesh = pictured_mesh();
  const auto scheduler = make_tbb_scheduler(3);
  Runner runner = runner_over(*scheduler);
  std::atomic<std::size_t> items = 0;
  runner.run = [&items, run = runner.run](std::size_t count, const Runner::Body& body) {
    run(count, [&](std::size_t item, std::size_t worker) { body(count - 1 - item, worker), ++items; });
  };
  EXPECT_EQ(make_thumbnails(mesh, runner), make_thumbnails(mesh));
  EXPECT_EQ(items, mesh.wedges.textures.size());
}

TEST(Lpm, ThumbnailsStandInForImagesThatHaveNotCome) {
  const ProgressiveMesh mesh = pictured_mesh();
  const std::vector<Texture>&textures = mesh.wedges.textures, thumbnails = make_thumbnails(mesh);
  const LpmBytes lpm = encode_lpm(mesh, {}, thumbnails), plain = encode_lpm(mesh);
  const auto texture_of = [](std::span<const std::byte> bytes, bool prefix, std::size_t k) {
    ByteReader input = reader_of(bytes);
    return read_lpm(input, prefix).wedges.textures[k];
  };
  EXPECT_NEAR(static_cast<double>(lpm.geometry), static_cast<double>(plain.geometry), 200);  // the header is longer
  for (std::size_t k = 0; k < textures.size(); ++k) {
    EXPECT_EQ(texture_of(lpm.bytes, false, k), textures[k]);
    EXPECT_EQ(texture_of(plain.bytes, false, k), textures[k]);
    const Texture early = texture_of(std::span(lpm.bytes).first(lpm.base), true, k);
    EXPECT_EQ(early.bytes, thumbnails[k].bytes);
    EXPECT_EQ(early.media_type, thumbnails[k].bytes.empty() ? textures[k].media_type : thumbnails[k].media_type);
    EXPECT_EQ(early.name, textures[k].name);
  }
  ByteReader cut = reader_of(std::span(lpm.bytes).first(lpm.base - 2000));
  expect_error_of<InputError>([&] { return read_lpm(cut, true); }, {"ends early"});
}

TEST(ProgressiveGlb, ImagesComeAfterTheirThumbnails) {
  const ProgressiveMesh mesh = pictured_mesh();
  const std::vector<Texture> thumbnails = make_thumbnails(mesh);
  for (const bool compressed : {false, true}) {
    const std::vector<std::byte> bytes = encode_progressive_glb(mesh, compressed, thumbnails);
    ByteReader input = reader_of(bytes);
    const std::vector<Texture> back = read_progressive(input).wedges.textures;  // of the material that is used
    ASSERT_EQ(back.size(), 2u);
    EXPECT_TRUE(std::equal(back.begin(), back.end(), mesh.wedges.textures.begin()));
    const TestFolder folder;
    const ProgressiveFileSize size = save_progressive(mesh, folder / "a.glb", {.lpm = {}, .compress_glb = compressed});
    EXPECT_EQ(size.bytes, bytes.size());
    const auto at = [&](const Texture& t, std::size_t from) {
      const std::span<const std::byte> image = std::as_bytes(std::span(t.bytes));
      return std::search(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.end(), image.begin(), image.end());
    };
    for (const std::size_t k : {0u, 1u}) {
      EXPECT_NE(at(mesh.wedges.textures[k], size.base), bytes.end());
      EXPECT_LT(at(thumbnails[k], 0), bytes.begin() + static_cast<std::ptrdiff_t>(size.base));
    }
  }
}

TEST(ProgressiveGlb, RefusesWhatFloatsCannotHold) {
  ProgressiveMesh mesh = make(test::sphere_mesh(3));
  mesh.transform.scale = 1e39;
  expect_error_of<InputError>([&] { return encode_progressive_glb(mesh, false, {}); }, {"so large", ".lpm"});
}

TEST(ProgressiveGlb, RefusesGltfWithoutParents) {
  const std::string text =
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  ByteReader input({text.data(), text.size()}, "plain.gltf");
  expect_error_of<InputError>([&] { return read_progressive_glb(input); }, {"not progressive"});
}

// On a surface that is almost flat, the level of half the vertices is nearer to the input than a step of 12 bits, which
// would then be most of its error; on a rough one it is farther away than that.
TEST(Lpm, TakesAsManyBitsAsLevelsShow) {
  for (const double height : {0.1, 0.003}) {
    const ProgressiveMesh mesh = make(test::terrain_mesh(60, height));
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
  for (const ProgressiveMesh& mesh : some_meshes())
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
      for (const std::uint32_t level : test::some_levels(mesh, 6))
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
    ProgressiveMesh mesh = make(soup(seed, seed % 2 == 1), 0, seed % 3 == 0 ? 20 : 0);
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
    std::ranges::rotate(corners, std::ranges::min_element(corners));
    out.insert(corners);
  }
  return out;
}

// The order within batches changes neither the surface nor the levels between them, and none after them has a hole.
TEST(Lpm, BatchesKeepTheLevelsBetweenThem) {
  std::vector<ProgressiveMesh> meshes = some_meshes();
  for (unsigned seed = 0; seed < 60; ++seed) meshes.push_back(make(soup(seed, seed % 2 == 1)));
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
    if (test::open_edges(b, b.triangles) > 0) continue;
    for (const std::uint32_t level : test::some_levels(b, 9))
      EXPECT_EQ(test::open_edges(b, b_levels.compute_level(level)), 0u) << level;
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
  const ProgressiveMesh mesh = make(test::textured_torus(60, 50, true, *scheduler));
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
    EXPECT_EQ(load_progressive(folder / name).positions.size(), mesh.positions.size());
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
