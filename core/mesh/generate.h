// Generated surfaces in closed form by index, so that any part can be made alone, streamed, or made in parallel.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

enum class Shape : std::uint8_t {
  sphere,   // closed, genus 0: a cube-sphere, fractally displaced by up to about a fifth of its radius
  terrain,  // open: a fractal height field over a square
  torus,    // closed, genus 1, fractally displaced
  box,      // closed, axis-aligned [0,1]^3, a regular grid on each face: far faces on the far faces of the root cell
  pile,     // boxes of 12 triangles, turned and placed at random in a ball so that they overlap; porous
};
[[nodiscard]] Shape shape_named(std::string_view name);  // throws InputError listing the known names

struct GenerateConfig {
  Shape shape = Shape::sphere;
  std::uint64_t triangles = 1'000'000;  // 12 to 2 * 10^9; the nearest regular grid is used
  std::uint64_t seed = 1;               // of the displacement; shape and connectivity do not depend on it
};

// A surface as two functions of an index. Determined by the config alone, the same bits on every machine.
class GeneratedSurface {
 public:
  // Throws InputError for a number of triangles out of range.
  explicit GeneratedSurface(const GenerateConfig& config);

  [[nodiscard]] std::uint64_t vertex_count() const { return vertex_count_; }
  [[nodiscard]] std::uint64_t triangle_count() const { return triangle_count_; }
  [[nodiscard]] Vec3f vertex(std::uint64_t index) const;
  [[nodiscard]] Triangle triangle(std::uint64_t index) const;

 private:
  [[nodiscard]] Vec3f lattice_point(std::uint64_t index) const;  // box and sphere: points of the cube [0,n]^3
  [[nodiscard]] std::uint32_t lattice_index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const;
  [[nodiscard]] Triangle cube_triangle(std::uint64_t index) const;
  [[nodiscard]] Triangle grid_triangle(std::uint64_t index) const;
  [[nodiscard]] Triangle pile_triangle(std::uint64_t index) const;
  [[nodiscard]] Vec3f box_corner(std::uint64_t box, std::uint32_t corner) const;
  [[nodiscard]] float displacement(Vec3f p, float base_frequency) const;  // about [-1, 1]

  Shape shape_;
  std::uint64_t seed_;
  std::uint32_t n_ = 0, m_ = 0;  // squares along the two directions; the same for box and sphere
  int octaves_ = 0;
  std::uint64_t vertex_count_ = 0, triangle_count_ = 0;
};

[[nodiscard]] RawMesh generate_mesh(const GenerateConfig& config);

}  // namespace lodestone
