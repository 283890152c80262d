// Surfaces that are hard by where they are, how large, or how many.
#include <cmath>

#include "core/mesh/generate.h"
#include "core/mesh/hard/makers.h"

namespace lodestone::hard {
namespace {

PolygonMesh moved(PolygonMesh mesh, double scale, Vec3d shift) {
  for (Vec3d& p : mesh.positions) p = scale * p + shift;
  return mesh;
}

void add_triangle(PolygonMesh& mesh, Vec3d at, double size) {
  const std::uint32_t a = mesh.add_vertex(at);
  mesh.add_face({a, mesh.add_vertex(at + Vec3d{size, 0, 0}), mesh.add_vertex(at + Vec3d{0, size, 0.3 * size})});
}

}  // namespace

// A box of squares of 1/16, 1/32 ...: middles of triangles and of edges lie on faces of cells, those of the far sides
// on the far faces of the grid.
PolygonMesh grid_faces(std::uint64_t size) {
  std::uint64_t n = 4;
  while (12 * n * n < size) n *= 2;
  const RawMesh box = generate_mesh({Shape::box, 12 * n * n, 1});
  PolygonMesh mesh;
  mesh.positions = box.positions;
  for (const Triangle& t : box.triangles) mesh.add_face({t.v[0], t.v[1], t.v[2]});
  return mesh;
}

PolygonMesh negative(std::uint64_t size) { return moved(ball(size), 1, {-5, -7, -11}); }

PolygonMesh outlier(std::uint64_t size) {
  PolygonMesh mesh = ball(size);
  add_triangle(mesh, {1e6, 0, 0}, 1);
  return mesh;
}

PolygonMesh long_triangles(std::uint64_t size) {
  PolygonMesh mesh = ball(size);
  for (int k = 0; k < 8; ++k) {
    const std::uint32_t a = mesh.add_vertex({-0.5, -0.5, 0.1 * k - 0.4}),
                        b = mesh.add_vertex({0.5, -0.5, 0.1 * k - 0.3});
    mesh.add_face({a, b, mesh.add_vertex({0.1 * k - 0.4, 0.5, 0})});
  }
  return mesh;
}

PolygonMesh far_away(std::uint64_t size) { return moved(ball(size), 1e-2, {1e7, -1e7, 1e7}); }
PolygonMesh tiny(std::uint64_t size) { return moved(ball(size), 1e-12, {}); }
PolygonMesh huge(std::uint64_t size) { return moved(ball(size), 1e12, {}); }
PolygonMesh denormal(std::uint64_t size) { return moved(ball(size), 1e-40, {}); }

PolygonMesh confetti(std::uint64_t size) {
  const auto side = static_cast<std::uint64_t>(std::ceil(std::cbrt(static_cast<double>(size))));
  PolygonMesh mesh;
  for (std::uint64_t k = 0; k < size; ++k)
    add_triangle(
        mesh,
        {static_cast<double>(k % side), static_cast<double>(k / side % side), static_cast<double>(k / side / side)},
        0.4);
  return mesh;
}

PolygonMesh uneven(std::uint64_t size) {
  PolygonMesh mesh = moved(ball(size), 1e-3, {});
  for (int k = 0; k < 27; ++k) add_triangle(mesh, {double(k % 3), double(k / 3 % 3), double(k / 9)}, 0.05);
  return mesh;
}

}  // namespace lodestone::hard
