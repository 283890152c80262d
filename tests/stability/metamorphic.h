// Surfaces and what is done to them in the metamorphic tests.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/math/affine.h"
#include "core/mesh/clean.h"
#include "core/mesh/generate.h"
#include "core/mesh/raw_mesh.h"
#include "tests/hard_mesh.h"

namespace lodestone::test {

// Coordinates are multiples of this, and moves are whole numbers below 2^23, so that sums are exact in double.
inline constexpr double step = 0x1p-20;

struct Surface {
  std::string name;
  RawMesh mesh;  // clean, in [0, 1]^3, its longest side 1; vertices in the order in which triangles use them
};

inline void number_by_use(RawMesh& mesh) {
  constexpr std::uint32_t unused = 0xffff'ffffu;
  std::vector<std::uint32_t> number(mesh.positions.size(), unused);
  std::vector<Vec3d> positions;
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t.v) {
      if (number[v] == unused) {
        number[v] = static_cast<std::uint32_t>(positions.size());
        positions.push_back(mesh.positions[v]);
      }
      v = number[v];
    }
  mesh.positions = std::move(positions);
}

inline RawMesh on_steps(const RawMesh& mesh) {
  Repairs repairs;
  const IndexedMesh clean = clean_mesh(mesh, repairs, {}, {20});
  RawMesh result;
  for (const Vec3f p : clean.positions) result.positions.push_back(to_double(p));
  result.triangles = clean.triangles;
  number_by_use(result);
  return result;
}

// The catalogue without what is refused, and two generated shapes.
inline std::vector<Surface> surfaces(std::uint64_t triangles) {
  std::vector<Surface> all;
  for (const HardCase& hard : hard_cases())
    if (hard.refusal.empty()) all.push_back({std::string(hard.name), on_steps(hard_mesh(hard, triangles))});
  for (const Shape shape : {Shape::sphere, Shape::terrain})
    all.push_back({shape == Shape::sphere ? "sphere" : "terrain",
                   on_steps(generate_mesh({.shape = shape, .triangles = 2 * triangles}))});
  return all;
}

inline Surface surface_named(const char* name, std::uint64_t triangles) {
  return {name, on_steps(hard_mesh(hard_case(name), triangles))};
}

inline RawMesh mapped(RawMesh mesh, const Affine3d& map) {
  transform_mesh(mesh, map);  // turns the triangles of a mirrored mesh over
  return mesh;
}
inline Affine3d scaling(double s) { return {{Vec3d{s, 0, 0}, Vec3d{0, s, 0}, Vec3d{0, 0, s}}, {}}; }
inline Affine3d moving(Vec3d by) { return {{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}, by}; }
// About the axis (1, 2, 2) / 3, which no face of a cell is parallel to.
inline Affine3d turning(double angle) {
  const Vec3d n{1.0 / 3, 2.0 / 3, 2.0 / 3};
  const auto turned = [&](Vec3d v) {
    return std::cos(angle) * v + std::sin(angle) * cross(n, v) + ((1 - std::cos(angle)) * dot(n, v)) * n;
  };
  return {{turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})}, {}};
}

// Every triangle with vertices of its own.
inline RawMesh unwelded(const RawMesh& mesh) {
  RawMesh result;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(result.positions.size());
    for (const std::uint32_t v : t.v) result.positions.push_back(mesh.positions[v]);
    result.triangles.push_back({{first, first + 1, first + 2}});
  }
  return result;
}

// As two files, and joined again.
inline RawMesh in_two_parts(const RawMesh& mesh) {
  RawMesh first, second;
  const auto middle = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(mesh.triangles.size() / 2);
  first.positions = second.positions = mesh.positions;
  first.triangles.assign(mesh.triangles.begin(), middle);
  second.triangles.assign(middle, mesh.triangles.end());
  if (!first.triangles.empty()) number_by_use(first);
  number_by_use(second);
  if (first.triangles.empty()) return second;
  append_mesh(first, std::move(second), "second");
  return first;
}

// Vertices, triangles and the corner that each of these begins with, in an order that is far from theirs.
inline RawMesh permuted(const RawMesh& mesh) {
  const auto order = [](std::size_t count) {
    std::vector<std::uint32_t> at(count);
    for (std::size_t k = 0; k < count; ++k) at[k] = static_cast<std::uint32_t>(k);
    std::uint64_t state = 1;
    for (std::size_t k = count; k > 1; --k) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      std::swap(at[k - 1], at[(state >> 33) % k]);
    }
    return at;
  };
  RawMesh result;
  const std::vector<std::uint32_t> place = order(mesh.positions.size());
  result.positions.resize(mesh.positions.size());
  for (std::size_t v = 0; v < place.size(); ++v) result.positions[place[v]] = mesh.positions[v];
  for (const std::uint32_t k : order(mesh.triangles.size())) {
    const auto& v = mesh.triangles[k].v;
    result.triangles.push_back({{place[v[k % 3]], place[v[(k + 1) % 3]], place[v[(k + 2) % 3]]}});
  }
  return result;
}

}  // namespace lodestone::test
