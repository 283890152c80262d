// Generated models of any size: what tests, figures and the demo use where no scan is at hand.
//
// A surface is a pure function from numbers to vertices and triangles, so that any range of either can be made on its
// own: in memory (generate_mesh), or streamed to a file block by block and in parallel (parallel/generate.h).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "core/mesh/indexed_mesh.h"

namespace lodestone {

enum class Shape : std::uint8_t { sphere, terrain, torus, box };
[[nodiscard]] Shape shape(std::string_view name);  // throws InputError listing the known names

struct GenerateConfig {
  Shape shape = Shape::sphere;
  // How many triangles to aim at, in [12, 200 million]. A surface is a grid, so that it has
  //   sphere, box  12 n^2, with n >= 1 the nearest to sqrt(triangles / 12)
  //   terrain      2 n m, with n nearest to sqrt(triangles / 2), and then m nearest to triangles / (2 n)
  //   torus        2 n m, with n nearest to sqrt(triangles / 5), and then m as above; both at least 3
  std::uint64_t triangles = 1'000'000;
  std::uint32_t seed = 1;  // of the fractal noise of sphere and terrain; the others have none
};

// All surfaces are oriented manifolds without degenerate triangles, with vertices shared (no two at one position) and
// numbered so that triangles close in number are close in space:
//   sphere   closed, genus 0: a unit sphere about the origin displaced along its radius by fractal noise; star-shaped
//   terrain  a square in x and y, one boundary loop: a fractal height field in z
//   torus    closed, genus 1: radii 1 and 0.4 about the z axis, vertices on the torus to float precision
//   box      closed, genus 0: the surface of the unit cube [0,1]^3; its far faces are at exactly 1
class GeneratedSurface {
 public:
  virtual ~GeneratedSurface() = default;
  [[nodiscard]] std::uint32_t vertex_count() const { return vertex_count_; }
  [[nodiscard]] std::uint32_t triangle_count() const { return triangle_count_; }

  // The vertices [first, first + out.size()), and the triangles likewise. May be called from several threads.
  virtual void positions(std::uint32_t first, std::span<Vec3f> out) const = 0;
  virtual void triangles(std::uint32_t first, std::span<Triangle> out) const = 0;

 protected:
  std::uint32_t vertex_count_ = 0, triangle_count_ = 0;
};

// Determined by the config alone. Throws InputError when `triangles` is out of range.
[[nodiscard]] std::unique_ptr<const GeneratedSurface> generate_surface(const GenerateConfig& config);

// The whole surface in memory.
[[nodiscard]] RawMesh generate_mesh(const GenerateConfig& config);

}  // namespace lodestone
