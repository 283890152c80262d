// Meshes that make_spherical has made, and what is asked of them.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <span>
#include <vector>

#include "core/spherical/surface.h"
#include "parallel/scheduler/scheduler.h"
#include "parallel/spherical/make_spherical.h"

namespace lodestone::test {

struct Made {
  ProgressiveMesh mesh;
  SphericalReport report;
};

inline Made make(const IndexedMesh& mesh, SphericalConfig config = {}, int threads = 1) {
  Made made;
  const auto scheduler = threads == 1 ? make_serial_scheduler() : make_tbb_scheduler(threads);
  made.mesh = make_spherical(mesh, config, *scheduler, made.report);
  return made;
}

inline SphericalConfig small_images() {
  SphericalConfig config;
  config.texture = 128;
  config.media_type = "image/png";
  config.error_points = 20000;
  return config;
}

// By position, as texture coordinates part the surface.
inline spherical::SurfaceKind kind_by_position(const ProgressiveMesh& mesh, std::span<const Triangle> triangles) {
  std::map<std::array<float, 3>, std::uint32_t> number;
  std::vector<Triangle> welded;
  for (const Triangle& t : triangles) {
    Triangle& w = welded.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f p = mesh.positions[t.v[k]];
      w.v[k] = number.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(number.size())).first->second;
    }
  }
  return spherical::kind_of(welded, number.size());
}

inline double area_of(const std::vector<Vec3f>& positions, std::span<const Triangle> triangles,
                      const Transform& transform) {
  double area = 0;
  for (const Triangle& t : triangles) {
    const auto at = [&](std::size_t k) { return transform.to_model(positions[t.v[k]]); };
    area += 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
  }
  return area;
}

inline void expect_square(const ProgressiveMesh& mesh) {
  for (const Vec2f uv : mesh.wedges.uv) {
    ASSERT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1) << uv.x << ' ' << uv.y;
  }
}

}  // namespace lodestone::test
