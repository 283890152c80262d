// Wedges out of corners, and meshes put together and moved with their attributes.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

#include "core/base/error.h"
#include "core/mesh/raw_mesh.h"
#include "core/mesh/wedges.h"
#include "tests/core/mesh/wedge_checks.h"

namespace lodestone {
namespace {

// Few vertices and few values, so that many corners agree.
RawMesh random_soup(std::mt19937& random, CornerAttributes& attributes, std::size_t triangles) {
  const auto any = [&](std::uint32_t count) { return static_cast<std::uint32_t>(random() % count); };
  RawMesh mesh;
  mesh.positions.resize(7);
  for (int i = 0; i < 5; ++i) attributes.uv.push_back({static_cast<float>(i / 2), 0.5f});  // some equal
  for (int i = 0; i < 3; ++i) attributes.normal.push_back({0, 0, i == 1 ? -1.f : 1.f});
  attributes.uv.push_back({-0.0f, 0.5f});  // equals the first
  for (std::size_t t = 0; t < triangles; ++t) {
    mesh.triangles.push_back({{any(7), any(7), any(7)}});
    attributes.uv_of.push_back({{any(6), any(6), any(8) == 0 ? no_value : any(6)}});
    attributes.normal_of.push_back({{any(3), any(3), any(3)}});
  }
  for (std::uint8_t v = 0; v < 7; ++v) attributes.colour.push_back({v, v, v, v});
  return mesh;
}

using Key = std::tuple<std::uint32_t, float, float, float, float, float>;

Key key_of(const RawMesh& mesh, const CornerAttributes& a, std::size_t t, std::size_t k) {
  const std::uint32_t uv = a.uv_of[t].v[k], n = a.normal_of[t].v[k];
  const Vec2f p = uv == no_value ? Vec2f{} : a.uv[uv];
  return {mesh.triangles[t].v[k], p.x + 0, p.y + 0, a.normal[n].x, a.normal[n].y, a.normal[n].z};
}

TEST(Wedges, AreTheDistinctValuesAtEachVertex) {
  std::mt19937 random(1);
  for (const std::size_t triangles : {0, 1, 2, 10, 200}) {
    CornerAttributes attributes;
    RawMesh mesh = random_soup(random, attributes, triangles);
    mesh.wedges = make_wedges(mesh.triangles, mesh.positions.size(), attributes);
    EXPECT_EQ(wedge_mistake(mesh), "");
    // The twin: a map from everything that tells wedges apart.
    std::map<Key, std::uint32_t> expected;
    for (std::size_t t = 0; t < triangles; ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t wedge = mesh.wedges.corners[t].v[k];
        const auto [entry, is_new] = expected.emplace(key_of(mesh, attributes, t, k), wedge);
        EXPECT_EQ(entry->second, wedge) << "two wedges of one value";
        const auto [vertex, u, v, nx, ny, nz] = entry->first;
        EXPECT_EQ(mesh.wedges.uv[wedge], (Vec2f{u, v}));
        EXPECT_EQ(mesh.wedges.normal[wedge], (Vec3f{nx, ny, nz}));
        EXPECT_EQ(mesh.wedges.colour[wedge], attributes.colour[vertex]);
      }
    EXPECT_EQ(expected.size(), wedge_count(mesh));
  }
}

TEST(Wedges, AbsentAttributesStayAbsent) {
  const std::vector<Triangle> triangles{{{0, 1, 2}}};
  CornerAttributes attributes;
  attributes.uv = {{0.25f, 0.5f}};
  attributes.uv_of = {{{0, 0, no_value}}};
  const RawWedges wedges = make_wedges(triangles, 3, attributes);
  EXPECT_EQ(wedges.uv, (std::vector<Vec2f>{{0.25f, 0.5f}, {0.25f, 0.5f}, {0, 0}}));
  EXPECT_TRUE(wedges.normal.empty());
  EXPECT_TRUE(wedges.colour.empty());
}

struct Parts {
  bool uv = false;  // false: normals
  bool corners = false, material = false;
};

RawMesh triangle_with(Parts parts) {
  RawMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{{0, 1, 2}}};
  if (parts.uv) mesh.wedges.uv = {{0.1f, 0}, {0.2f, 0}, {0.3f, 0}};
  if (!parts.uv) mesh.wedges.normal = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  if (parts.corners) {
    mesh.wedges.corners = {{{3, 0, 1}}};
    if (parts.uv) mesh.wedges.uv = {{0.2f, 0}, {0.3f, 0}, {0.9f, 0}, {0.1f, 0}};
    if (!parts.uv) mesh.wedges.normal.push_back({0, 0, 1});
  }
  if (parts.material) {
    mesh.wedges.material = {0};
    mesh.materials = {{.name = "m", .texture = 0}};
    mesh.textures = {{.name = "t", .media_type = "image/png", .bytes = {'x'}}};
  }
  return mesh;
}

TEST(RawMesh, AppendingKeepsEveryCornersValues) {
  for (int kind = 0; kind < 64; ++kind) {
    const auto bit = [&](int i) { return (kind >> i & 1) != 0; };
    RawMesh a = triangle_with({.uv = bit(0), .corners = bit(1), .material = bit(2)});
    const RawMesh b = triangle_with({.uv = bit(3), .corners = bit(4), .material = bit(5)});
    for (Texture& texture : a.textures) texture.bytes = {'y'};
    RawMesh both = a, part = b;
    append_mesh(both, std::move(part), "file");
    append_mesh(both, RawMesh{}, "file");
    ASSERT_EQ(wedge_mistake(both), "") << kind;
    ASSERT_EQ(both.triangles, (std::vector<Triangle>{{{0, 1, 2}}, {{3, 4, 5}}}));
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(values_at(both, 0, k), values_at(a, 0, k)) << kind;
      EXPECT_EQ(values_at(both, 1, k), values_at(b, 0, k)) << kind;
    }
    EXPECT_EQ(both.materials.size(), std::size_t{bit(2)} + bit(5));
    if (bit(2) || bit(5)) {
      ASSERT_EQ(both.wedges.material.size(), 2u);
      EXPECT_EQ(both.wedges.material[0], bit(2) ? 0 : no_material);
      EXPECT_EQ(both.wedges.material[1], bit(5) ? std::uint32_t{bit(2)} : no_material);
      if (bit(5)) {
        EXPECT_EQ(both.materials.back().texture, std::uint32_t{bit(2)});
      }
    }
  }
}

TEST(RawMesh, EqualMaterialsAndTexturesBecomeOne) {
  RawMesh whole = triangle_with({.uv = true, .material = true});
  RawMesh other = whole, colour = whole;
  other.textures.insert(other.textures.begin(), Texture{.name = "first", .media_type = "image/png", .bytes = {'z'}});
  other.materials = {{.name = "m", .texture = 1}, {.name = "n", .texture = 0, .normal_map = 1}};
  other.wedges.material = {1};
  colour.materials[0].base_colour[0] = 0.5f;
  append_mesh(whole, RawMesh(whole), "file");
  append_mesh(whole, std::move(other), "file");
  append_mesh(whole, std::move(colour), "file");
  EXPECT_EQ(whole.textures.size(), 2u);
  EXPECT_EQ(whole.wedges.material, (std::vector<std::uint32_t>{0, 0, 1, 2}));
  ASSERT_EQ(whole.materials.size(), 3u);
  EXPECT_EQ(whole.materials[1], (Material{.name = "n", .texture = 1, .normal_map = 0}));
  EXPECT_EQ(whole.materials[2].texture, 0u);
}

TEST(RawMesh, AppendingAddsCountsAndWarnings) {
  RawMesh a = triangle_with({.uv = true}), b = a;
  a.polygons_triangulated = 1, b.polygons_triangulated = 2, b.faces_dropped = 3, b.void_posts = 4, b.filled_posts = 5;
  b.warnings = {"w"};
  append_mesh(a, std::move(b), "file");
  EXPECT_EQ(a.polygons_triangulated, 3u);
  EXPECT_EQ(a.faces_dropped, 3u);
  EXPECT_EQ(a.void_posts, 4u);
  EXPECT_EQ(a.filled_posts, 5u);
  EXPECT_EQ(a.warnings, (std::vector<std::string>{"w"}));
}

TEST(RawMesh, MirrorsKeepOutsideOutside) {
  RawMesh mesh = triangle_with({.corners = true});
  transform_mesh(mesh, {{Vec3d{-2, 0, 0}, Vec3d{0, 3, 0}, Vec3d{0, 0, 5}}, {10, 20, 30}});
  EXPECT_EQ(mesh.positions, (std::vector<Vec3d>{{10, 20, 30}, {8, 20, 30}, {10, 23, 30}}));
  EXPECT_EQ(mesh.triangles[0], (Triangle{{0, 2, 1}}));
  EXPECT_EQ(mesh.wedges.corners[0], (Triangle{{3, 1, 0}}));
  for (const Vec3f& n : mesh.wedges.normal) EXPECT_EQ(n, (Vec3f{0, 0, 1}));  // still on the side the triangle shows
}

TEST(RawMesh, NormalsStayPerpendicularUnderAnyMap) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vec3d{number(random), number(random), number(random)}; };
  for (int i = 0; i < 100; ++i) {
    RawMesh mesh;
    mesh.positions = {vector(), vector(), vector()};
    mesh.triangles = {{{0, 1, 2}}};
    const auto face_normal = [&] {
      const auto& [a, b, c] = mesh.triangles[0].v;
      const std::vector<Vec3d>& p = mesh.positions;
      return unit_normal(cross(p[b] - p[a], p[c] - p[a]));
    };
    mesh.wedges.normal.assign(3, face_normal());
    transform_mesh(mesh, {{vector(), vector(), vector()}, vector()});
    EXPECT_LT(length(mesh.wedges.normal[0] - face_normal()), 1e-4f);
  }
}

TEST(RawMesh, DirectionsThatAreNoneGiveNoNormal) {
  EXPECT_EQ(unit_normal({0, 0, 0}), Vec3f{});
  EXPECT_EQ(unit_normal({std::nan(""), 0, 0}), Vec3f{});
  EXPECT_EQ(unit_normal({HUGE_VAL, 0, 0}), Vec3f{});
  EXPECT_EQ(unit_normal({0, 0, -1e-150}), (Vec3f{0, 0, -1}));
}

}  // namespace
}  // namespace lodestone
