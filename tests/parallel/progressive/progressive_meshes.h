// Surfaces with charts and seams for the tests of progressive meshes, and these meshes with readers of their bytes.
#pragma once

#include "core/files/byte_reader.h"
#include "core/mesh/clean.h"
#include "core/mesh/raw_mesh.h"
#include "parallel/clean/prepare.h"
#include "parallel/progressive/make_progressive.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

// A closed torus of n x m squares whose texture is one rectangle (two seams that cross), or a rectangle for each half.
inline IndexedMesh textured_torus(std::uint32_t n, std::uint32_t m, bool halves, Scheduler& scheduler) {
  RawMesh raw = raw_of(torus_mesh(n, m));
  for (std::uint32_t j = 0; j < m; ++j)
    for (std::uint32_t i = 0; i < n; ++i)
      for (int half = 0; half < 2; ++half) {
        const auto corner = [&](std::uint32_t di, std::uint32_t dj) {
          const bool second = halves && i >= n / 2;
          raw.wedges.uv.push_back({static_cast<float>(i + di) / static_cast<float>(n) + (second ? 2.0f : 0.0f),
                                   static_cast<float>(j + dj) / static_cast<float>(m)});
          const float angle = 6.2831853f * static_cast<float>(i + di) / static_cast<float>(n);
          raw.wedges.normal.push_back(unit_normal({std::cos(angle), std::sin(angle), 0}));
          return static_cast<std::uint32_t>(raw.wedges.uv.size() - 1);
        };
        if (half == 0) raw.wedges.corners.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
        if (half == 1) raw.wedges.corners.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
      }
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, scheduler);
}

// Two cubes that share an edge, and a third that touches one of them in a corner; each of n^2 squares a side.
inline IndexedMesh touching_cubes(std::uint32_t n, Scheduler& scheduler) {
  RawMesh raw;
  for (const Vec3d at : {Vec3d{0, 0, 0}, Vec3d{1, 1, 0}, Vec3d{-1, -1, -1}})
    add_cube(
        n, [&](Vec3d p) { return at + p; }, raw.positions, raw.triangles);
  Repairs repairs;
  return prepare_mesh(std::move(raw), repairs, scheduler);
}

inline ProgressiveMesh progressive_of(const IndexedMesh& mesh, const ProgressiveConfig& config = {}) {
  ProgressiveReport report;
  return make_progressive(mesh, config, *make_serial_scheduler(), report);
}

// Closed, open, with a base of some triangles, with seams and with vertices that are cut apart.
inline std::vector<ProgressiveMesh> some_progressive_meshes() {
  const auto scheduler = make_serial_scheduler();
  return {progressive_of(sphere_mesh(5)),
          progressive_of(sphere_mesh(4), {.base_triangles = 300}),
          progressive_of(terrain_mesh(40)),
          progressive_of(textured_torus(40, 30, false, *scheduler)),
          progressive_of(textured_torus(40, 30, true, *scheduler)),
          progressive_of(touching_cubes(6, *scheduler))};
}

template <class Bytes>
inline ByteReader reader_of(const Bytes& bytes) {
  return ByteReader({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "test");
}

}  // namespace lodestone::test
