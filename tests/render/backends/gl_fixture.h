// Fixture of the tests of the gl backend: a renderer or a visible skip, and frames.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

#include "core/base/error.h"
#include "render/backends/gl/gl_renderer.h"
#include "render/camera/camera.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

// Skips, saying what is missing, where OpenGL 4.5 cannot be had.
class GlTest : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      renderer_ = make_gl_renderer();
    } catch (const UnsupportedError& error) {
      GTEST_SKIP() << error.what();
    }
  }
  std::unique_ptr<GlRenderer> renderer_;
};

// A frame and what it refers to. Every cell is selected whether the camera sees it or not. Position and target of the
// camera are given in normalised space.
struct WholeFrame {
  Radii radii;
  Selection selection;
  Frame frame;

  WholeFrame(const Hierarchy& hierarchy, const RadiiConfig& config, Camera camera, Blend blend = Blend::smoothstep,
             ImageSize size = {160, 120})
      : radii(make_radii(hierarchy, config)) {
    camera.position = hierarchy.transform.origin + hierarchy.transform.scale * camera.position;
    camera.target = hierarchy.transform.origin + hierarchy.transform.scale * camera.target;
    frame.only().morph = {&hierarchy, &radii, blend, viewpoint(camera, hierarchy.transform)};
    select_cells(hierarchy, radii, frame.only().morph.viewpoint, {}, selection);
    frame.only().selection = &selection;
    frame.only().view_projection = view_projection(camera, hierarchy, size);
    frame.size = size;
  }
  WholeFrame(const WholeFrame&) = delete;
  WholeFrame& operator=(const WholeFrame&) = delete;
};

inline RadiiConfig with_kappa0(float kappa0, DistanceMetric metric = DistanceMetric::euclidean,
                               RadiiRule rule = RadiiRule::per_level) {
  RadiiConfig config;
  config.kappa0 = kappa0;
  config.metric = metric;
  config.rule = rule;
  return config;
}

// n x n squares in the plane z = 1/2 over [0,1] x [y0, y0 + 1/2].
inline IndexedMesh plate(std::uint32_t n, float y0 = 0) {
  IndexedMesh mesh = terrain_mesh(n);
  mesh.transform = {};
  for (Vec3f& p : mesh.positions) p = {p.x, y0 + p.y / 2, 0.5f};
  return mesh;
}

// Looks down on the plane z = 1/2 from above (1/2, 0): up in the picture is +y.
inline constexpr Camera from_above{{0.5, 0, 1.5}, {0.5, 0, 0.5}, {0, 1, 0}, 1.2};

// Position bits as a sortable key; -0 = +0.
using PositionKey = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
inline PositionKey key_of(Vec3f p) {
  const auto bits = [](float v) { return std::bit_cast<std::uint32_t>(v + 0.0f); };
  return {bits(p.x), bits(p.y), bits(p.z)};
}

}  // namespace lodestone::test
