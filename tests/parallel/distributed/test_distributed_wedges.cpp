// Meshes with attributes by several ranks: the bytes of a build of the same files on one machine, which is the slow and
// obvious twin.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "core/base/byte_size.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/mesh/generate.h"
#include "core/texture/image_codec.h"
#include "tests/expect_error.h"
#include "tests/parallel/distributed/distributed.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view no_materials{};

class DistributedWedges : public testing::Distributed {
 protected:
  DistributedWedges() {
    reading_ = {.attributes = true, .up = UpAxis::z};
    config_.build.sigma0 = 0.6f;
    whole_ = generate_mesh({Shape::terrain, 4000, 3});
  }

  struct Part {
    std::size_t first = 0, end = 0;  // triangles
    bool uv = false, normals = false, colours = false;
    std::string_view materials = no_materials;  // of charts, a letter each: chart c has the c-th, modulo their number
  };

  // Charts are columns of the terrain: texture coordinates jump between them, and normals at every third. Vertices are
  // those of all parts, so that parts meet.
  fs::path obj(const std::string& name, const Part& part) const {
    std::ofstream out(folder_ / name);
    out.precision(17);
    if (!part.materials.empty()) out << "mtllib " << library() << '\n';
    for (const Vec3d& p : whole_.positions) {
      out << "v " << p.x << ' ' << p.y << ' ' << p.z;
      if (part.colours) out << ' ' << std::fmod(std::abs(p.x), 1) << " 0.5 " << std::fmod(std::abs(p.y), 1);
      out << '\n';
    }
    int texture = 0, normal = 0;
    std::size_t material = ~std::size_t{0};
    for (std::size_t t = part.first; t < part.end; ++t) {
      const auto& v = whole_.triangles[t].v;
      const int chart = static_cast<int>(std::floor(4 * centre(t).x));
      if (!part.materials.empty() && static_cast<std::size_t>(chart) % part.materials.size() != material) {
        material = static_cast<std::size_t>(chart) % part.materials.size();
        out << "usemtl " << part.materials[material] << '\n';
      }
      std::string face = "f";
      for (const std::uint32_t i : v) {
        const Vec3d p = whole_.positions[i];
        face += ' ' + std::to_string(i + 1);
        if (part.uv || part.normals) face += '/';
        if (part.uv) {
          out << "vt " << p.x + 10 * chart << ' ' << p.y << '\n';
          face += std::to_string(++texture);
        }
        if (part.normals) {
          out << (chart % 3 == 0 ? "vn 0 0.6 0.8\n" : "vn 0 0 1\n");
          face += '/' + std::to_string(++normal);
        }
      }
      out << face << '\n';
    }
    return folder_ / name;
  }

  // Materials a to d: a and c have one image, b another one, and d none.
  std::string library() const {
    PixelImage pixels{.size = {128, 128}, .channels = 1, .pixels = {}};
    for (int i = 0; i < 128 * 128; ++i) pixels.pixels.push_back(static_cast<std::uint8_t>(i % 128 + i / 256));
    const std::vector<char> one = encode_image(pixels, "image/png");
    std::ofstream(folder_ / "one.png", std::ios::binary).write(one.data(), static_cast<std::streamsize>(one.size()));
    std::ofstream(folder_ / "two.png", std::ios::binary) << png("without an image");
    std::ofstream(folder_ / "m.mtl") << "newmtl a\nKd 1 0 0\nmap_Kd one.png\nnewmtl b\nmap_Kd two.png\n"
                                        "newmtl c\nKd 0 1 0\nmap_Kd one.png\nnewmtl d\nKd 0 0 1\n";
    return "m.mtl";
  }
  static std::string png(const std::string& content) { return "\x89PNG\r\n\x1a\n" + content; }

  [[nodiscard]] Vec3d centre(std::size_t t) const {
    const auto& v = whole_.triangles[t].v;
    return (1.0 / 3) * (whole_.positions[v[0]] + whole_.positions[v[1]] + whole_.positions[v[2]]);
  }

  // Binary PLY with a colour of each vertex, as it is.
  fs::path coloured(const std::string& name, const RawMesh& mesh) const {
    std::ofstream out(folder_ / name, std::ios::binary);
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.positions.size()
        << "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar green\n"
           "property uchar blue\nelement face "
        << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      out.write(reinterpret_cast<const char*>(&mesh.positions[i]), sizeof(Vec3d));
      out.put(static_cast<char>(i % 2)).put(static_cast<char>(i / 7 % 5)).put('\x40');
    }
    for (const Triangle& t : mesh.triangles) out.put(3).write(reinterpret_cast<const char*>(t.v.data()), 12);
    return folder_ / name;
  }

  // The file of the last build.
  [[nodiscard]] Hierarchy result() const { return open_lode(config_.output); }

  RawMesh whole_;
};

TEST_F(DistributedWedges, KeepNormals) {
  expect_same(obj("m.obj", {.end = whole_.triangles.size(), .normals = true}));
  EXPECT_TRUE(result().attributes.wedges);
}

TEST_F(DistributedWedges, KeepColoursThroughRepairs) {
  expect_same(coloured("m.ply", test::with_faults(test::raw_of(test::sphere_mesh(4)), 1)));
  EXPECT_TRUE(result().attributes.colours);
}

TEST_F(DistributedWedges, KeepSeamsOfTextureCoordinates) {
  expect_same(obj("m.obj", {.end = whole_.triangles.size(), .uv = true}));
  EXPECT_TRUE(result().attributes.uv);
}

TEST_F(DistributedWedges, KeepMaterialsAndTextures) {
  expect_same(obj("m.obj", {.end = whole_.triangles.size(), .uv = true, .normals = true, .materials = "abcd"}));
  EXPECT_EQ(result().materials.size(), 4u);
  EXPECT_EQ(result().textures.size(), 2u);
}

// Along the borders of the files vertices become one, and so do wedges with equal values.
TEST_F(DistributedWedges, JoinFilesWithOtherAttributes) {
  const std::size_t third = whole_.triangles.size() / 3;
  RawMesh plain;
  plain.positions = whole_.positions;
  plain.triangles.assign(whole_.triangles.begin() + 100, whole_.triangles.begin() + 900);
  test::write_ply(folder_ / "plain.ply", plain);
  expect_same({obj("a.obj", {.end = third, .uv = true, .materials = "ab"}),
               obj("b.obj", {.first = third, .end = 2 * third, .uv = true, .colours = true}), folder_ / "plain.ply",
               obj("c.obj", {.first = 2 * third, .end = 3 * third, .uv = true, .materials = "dac"})});
  EXPECT_EQ(result().materials.size(), 4u);
  expect_same({folder_ / "plain.ply", obj("c.obj", {.end = third, .materials = "dac"}), coloured("d.ply", plain),
               obj("e.obj", {.first = third, .end = 2 * third, .materials = "bd"})});
}

TEST_F(DistributedWedges, HalveTextures) {
  config_.texture_copies = true;
  const fs::path file = obj("m.obj", {.end = 2000, .uv = true, .materials = "ab"});
  expect_same(file);
  EXPECT_EQ(result().texture_copies.size(), 2u);
  const OpenInput open = [&](Ranks& all, Scheduler& workers) {
    return open_rank_input(std::vector{file}, reading_, all, workers);
  };
  const std::vector<std::string> warnings = build(open, 2, 0).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings.front().find("m.obj: texture 'two.png'"), std::string::npos) << warnings.front();
}

TEST_F(DistributedWedges, OneMaterialNeedsNoWedgesOfItsOwn) {
  const std::size_t half = whole_.triangles.size() / 2;
  expect_same({obj("a.obj", {.end = half, .materials = "a"}),
               obj("b.obj", {.first = half, .end = whole_.triangles.size(), .materials = "a"})});
  EXPECT_TRUE(result().attributes.wedges);
  EXPECT_FALSE(result().attributes.materials);
  EXPECT_EQ(result().materials.size(), 1u);
}

// Simplifiers that know no wedges, levels of a half, and vertices on a lattice.
TEST_F(DistributedWedges, FollowTheConfiguration) {
  config_.build.simplifier = "cluster";
  config_.build.half_levels = true;
  config_.lattice = {12};
  expect_same(obj("m.obj", {.end = whole_.triangles.size(), .uv = true, .materials = "ab"}));
}

// A tileset of models that share an image.
TEST_F(DistributedWedges, KeepTexturesOfTiles) {
  std::string children;
  for (int i = 0; i < 5; ++i) {
    RawMesh tile = generate_mesh({Shape::sphere, 1000, 1});
    for (Vec3d& p : tile.positions) p.x += 1.5 * i;
    for (const Vec3d& p : tile.positions)
      tile.wedges.uv.push_back({static_cast<float>(p.y), static_cast<float>(p.z + i)});
    tile.wedges.material.assign(tile.triangles.size(), 0);
    const std::string image = png(i == 3 ? "other" : "one");
    tile.textures = {{.name = "photo", .media_type = "image/png", .bytes = {image.begin(), image.end()}}};
    tile.materials = {{.name = "m", .texture = 0, .roughness = 0.3f, .unlit = i == 4}};
    write_mesh(folder_ / ("t" + std::to_string(i) + ".glb"), tile);
    children += std::string(i > 0 ? ", " : "") +
                R"({"boundingVolume": {"sphere": [0, 0, 0, 10]}, "geometricError": 0, "content": {"uri": "t)" +
                std::to_string(i) + R"(.glb"}})";
  }
  std::ofstream(folder_ / "tileset.json")
      << R"({"asset": {"version": "1.1"}, "geometricError": 1, "root": {"boundingVolume": {"sphere": [0, 0, 0, 10]}, )"
      << R"("geometricError": 1, "children": [)" << children << "]}}";
  expect_same(folder_ / "tileset.json");
  EXPECT_EQ(result().materials.size(), 3u);
  EXPECT_EQ(result().textures.size(), 2u);
}

TEST_F(DistributedWedges, HaveToFitALimit) {
  const fs::path file = obj("m.obj", {.end = whole_.triangles.size(), .uv = true, .materials = "ab"});
  const OpenInput open = [&](Ranks& all, Scheduler& workers) {
    return open_rank_input(std::vector{file}, reading_, all, workers);
  };
  for (const RankLimit& limit : {RankLimit{.part = 700}, RankLimit{.bytes = mebibyte}}) {
    config_.limit = limit;
    expect_error_of<ResourceError>([&] { (void)build(open, 2, 0); },
                                   {"m.obj: attributes, which ranks do not put into temporary files, need ",
                                    "--no-attributes", "--memory-limit", "or more ranks"});
  }
  std::uint64_t least = 0;
  try {
    (void)build(open, 2, 0);
  } catch (const ResourceError& error) {
    least = testing::least_in(error.what());
  }
  config_.limit = {.bytes = least - mebibyte};
  EXPECT_THROW((void)build(open, 2, 0), ResourceError);
  config_.limit = {.bytes = least};
  EXPECT_FALSE(build(open, 2, 0).spilled);
  EXPECT_TRUE(content(config_.output) == in_memory({file}));
}

TEST_F(DistributedWedges, DamagedMessagesEndTheJob) {
  const fs::path file = obj("m.obj", {.end = 600, .uv = true, .materials = "ab"});
  const OpenInput open = [&](Ranks& all, Scheduler& workers) {
    return open_rank_input(std::vector{file}, reading_, all, workers);
  };
  int sent = 0;
  const auto build_with_damage = [&](int at) {
    sent = 0;
    const LocalRanksConfig local{.timeout_seconds = 2, .on_send = [&, at](int from, int, Message& message) {
                                   if (from == 1 && sent++ == at) message.pop_back();
                                   return true;
                                 }};
    (void)build(open, 3, 0, local);
  };
  build_with_damage(-1);
  const int messages = sent;
  for (int at = 0; at < messages; at += 1 + messages / 20) EXPECT_THROW(build_with_damage(at), Error) << at;
}

}  // namespace
}  // namespace lodestone
