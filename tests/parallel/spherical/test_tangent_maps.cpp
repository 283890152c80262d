// Normal maps for other viewers: near the object-space images, in the file with their tangents, only where they help.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/progressive/gltf/progressive_glb.h"
#include "parallel/spherical/make_spherical.h"
#include "parallel/spherical/tangent_maps.h"
#include "tests/core/spherical/painted_sphere.h"

namespace lodestone::test {
namespace {

Vec3d bumpy(Vec3d d) {
  const Vec3d n = d + 0.3 * Vec3d{std::sin(6 * d.y), std::sin(7 * d.z), std::sin(5 * d.x)};
  return (1 / length(n)) * n;
}

// A sphere with an object-space normal map, or without.
ProgressiveMesh sphere_with_normals(bool bumps, Scheduler& scheduler) {
  PaintedSphere painted = painted_sphere(5);
  if (bumps) {
    painted.mesh.wedges.textures.push_back(texture_of(
        atlas(bumpy, [](double v) { return static_cast<std::uint8_t>(std::clamp(v * 127.5 + 128, 0.0, 255.0)); })));
    painted.mesh.wedges.materials[0].normal_map = 1;
  }
  SphericalConfig config;
  config.texture = 256;
  config.error_points = 20000;
  SphericalReport report;
  return make_spherical(painted.mesh, config, scheduler, report);
}

// The mean angle, in degrees, between the normals that the sphere was painted with and those that a glTF viewer makes
// of vertices, tangents and the nearest texel, in the middles of triangles.
double angle_as_drawn(const ProgressiveMesh& mesh) {
  const Texture& texture = mesh.wedges.textures[mesh.wedges.materials[0].normal_map];
  const PixelImage map = decode_image(texture.bytes, texture.media_type);
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    Vec3d place{}, normal{}, tangent{};
    double u = 0, v = 0;
    for (const std::uint32_t w : t.v) {
      place = place + (1.0 / 3) * to_double(mesh.positions[w]), normal = normal + to_double(mesh.wedges.normal[w]);
      tangent = tangent + to_double(mesh.tangents[w].along_u);
      u += mesh.wedges.uv[w].x / 3.0, v += mesh.wedges.uv[w].y / 3.0;
    }
    EXPECT_EQ(mesh.tangents[t.v[0]].side, 1);
    const auto texel =
        static_cast<std::size_t>(v * map.size.height) * map.size.width + static_cast<std::size_t>(u * map.size.width);
    const auto component = [&](std::size_t c) { return map.pixels[3 * texel + c] / 127.5 - 1; };
    const auto unit = [](Vec3d a) { return (1 / length(a)) * a; };
    const Vec3d n = unit(normal), along = unit(tangent);
    const Vec3d drawn = unit(component(0) * along + component(1) * cross(n, along) + component(2) * n);
    sum += std::acos(std::min(dot(drawn, bumpy(unit(place - Vec3d{0.5, 0.5, 0.5}))), 1.0)) * 180 / std::numbers::pi;
  }
  return sum / static_cast<double>(mesh.triangles.size());
}

TEST(TangentMaps, ShowNormalsOfObjectSpace) {
  const auto scheduler = make_serial_scheduler();
  ProgressiveMesh mesh = sphere_with_normals(true, *scheduler);
  TangentMapReport report;
  add_tangent_maps(mesh, {.media_type = "image/png"}, *scheduler, report);
  EXPECT_GT(report.plain_angle, 5);
  EXPECT_LT(report.angle, 1);
  EXPECT_EQ(report.pixels, 128u * 128u);
  ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
  const std::uint32_t map = mesh.wedges.materials[0].normal_map;
  ASSERT_EQ(map, 2u);
  EXPECT_EQ(report.bytes, mesh.wedges.textures[map].bytes.size());
  for (const bool compressed : {false, true}) {
    const std::vector<std::byte> bytes = encode_progressive_glb(mesh, compressed);
    ByteReader input({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "test");
    const ProgressiveMesh back = read_progressive_glb(input);
    EXPECT_EQ(back.tangents, mesh.tangents);
    EXPECT_LT(angle_as_drawn(back), 2);
    const std::uint32_t there = back.wedges.materials[0].normal_map, object = back.object_normals[0];
    EXPECT_EQ(back.wedges.textures[there], mesh.wedges.textures[map]);
    EXPECT_EQ(back.wedges.textures[object], mesh.wedges.textures[mesh.object_normals[0]]);
  }
}

TEST(TangentMaps, AreLeftOutWhereNormalsOfVerticesDo) {
  const auto scheduler = make_serial_scheduler();
  ProgressiveMesh mesh = sphere_with_normals(false, *scheduler);
  TangentMapReport report;
  add_tangent_maps(mesh, {}, *scheduler, report);
  EXPECT_LT(report.plain_angle, 1);
  EXPECT_EQ(report.angle, report.plain_angle);
  EXPECT_EQ(report.bytes, 0u);
  EXPECT_TRUE(mesh.tangents.empty());
  EXPECT_EQ(mesh.wedges.materials[0].normal_map, no_texture);
}

TEST(TangentMaps, AreTheSameForAnyNumberOfThreads) {
  const auto serial = make_serial_scheduler(), parallel = make_tbb_scheduler(3);
  ProgressiveMesh one = sphere_with_normals(true, *serial), other = one;
  TangentMapReport report, again;
  add_tangent_maps(one, {.points = 50'000}, *serial, report);
  add_tangent_maps(other, {.points = 50'000}, *parallel, again);
  EXPECT_EQ(encode_progressive_glb(one, false), encode_progressive_glb(other, false));
  EXPECT_EQ(report.angle, again.angle);
}

}  // namespace
}  // namespace lodestone::test
