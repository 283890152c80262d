// A bumpy ball, and everything that may be wrong with one.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/mesh/hard/makers.h"

namespace lodestone::hard {
namespace {

// The same numbers on every machine.
class Random {
 public:
  std::uint32_t below(std::size_t n) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::uint32_t>((state_ >> 33) % n);
  }
  double share() { return below(1u << 30) * 0x1p-30; }  // in [0, 1)

 private:
  std::uint64_t state_ = 12345;
};

std::array<std::uint32_t, 3> face(const PolygonMesh& mesh, std::size_t i) {
  return {mesh.corners[3 * i], mesh.corners[3 * i + 1], mesh.corners[3 * i + 2]};
}

void turn_over(PolygonMesh& mesh, std::size_t i) { std::swap(mesh.corners[3 * i], mesh.corners[3 * i + 1]); }

}  // namespace

PolygonMesh ball(std::uint64_t size) {
  const auto rows = static_cast<std::uint32_t>(std::max(3.0, std::sqrt(static_cast<double>(size) / 4)));
  const std::uint32_t columns = 2 * rows;
  PolygonMesh mesh;
  const auto place = [&](std::uint32_t i, std::uint32_t j) {
    const double a = 2 * std::numbers::pi * i / columns, b = std::numbers::pi * j / rows;
    const Vec3d d{std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b)};
    return 0.45 * (1 + 0.1 * std::sin(9 * d.x) * std::sin(7 * d.y + 1) * std::cos(8 * d.z)) * d;
  };
  mesh.add_vertex(place(0, 0));
  for (std::uint32_t j = 1; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) mesh.add_vertex(place(i, j));
  const std::uint32_t last = mesh.add_vertex(place(0, rows));
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return 1 + (j - 1) * columns + i % columns; };
  for (std::uint32_t i = 0; i < columns; ++i) mesh.add_face({0, at(i, 1), at(i + 1, 1)});
  for (std::uint32_t j = 1; j + 1 < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      mesh.add_face({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.add_face({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  for (std::uint32_t i = 0; i < columns; ++i) mesh.add_face({at(i, rows - 1), last, at(i + 1, rows - 1)});
  return mesh;
}

PolygonMesh not_finite(std::uint64_t size) {
  PolygonMesh mesh = ball(size);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  Random random;
  for (const Vec3d bad : {Vec3d{nan, 0, 0}, Vec3d{0, nan, nan}, Vec3d{infinity, 0, 0}, Vec3d{0, -infinity, nan}})
    mesh.positions[random.below(mesh.positions.size())] = bad;
  return mesh;
}

PolygonMesh zero_area(std::uint64_t size) {
  PolygonMesh mesh = ball(size);
  Random random;
  for (std::size_t k = mesh.polygon_count() / 10; k-- > 0;) {
    const auto [a, b, c] = face(mesh, random.below(mesh.polygon_count()));
    mesh.add_face({a, b, a});
    mesh.add_face({c, c, c});
    mesh.add_face({a, mesh.add_vertex(0.5 * (mesh.positions[a] + mesh.positions[b])), b});
    mesh.add_face({a, mesh.add_vertex(mesh.positions[a]), b});
  }
  return mesh;
}

PolygonMesh duplicate_faces(std::uint64_t size) {
  PolygonMesh mesh = ball(size);
  for (std::size_t i = mesh.polygon_count(); i-- > 0;) {
    const auto [a, b, c] = face(mesh, i);
    if (i % 2 == 0) mesh.add_face({b, c, a});
    if (i % 4 == 0) mesh.add_face({a, b, c});
  }
  return mesh;
}

PolygonMesh opposite_faces(std::uint64_t size) {
  PolygonMesh mesh = ball(size / 2);
  for (std::size_t i = mesh.polygon_count(); i-- > 0;) {
    const auto [a, b, c] = face(mesh, i);
    mesh.add_face({a, c, b});
  }
  return mesh;
}

PolygonMesh unused_vertices(std::uint64_t size) {
  PolygonMesh mesh = ball(size);
  Random random;
  for (std::size_t k = mesh.positions.size(); k-- > 0;) mesh.add_vertex({random.share(), random.share(), 0});
  mesh.add_vertex({1e30, 0, 0});
  mesh.add_vertex({0, std::numeric_limits<double>::quiet_NaN(), 0});
  return mesh;
}

PolygonMesh soup(std::uint64_t size) {
  const PolygonMesh whole = ball(size);
  PolygonMesh mesh;
  for (const std::uint32_t v : whole.corners) mesh.corners.push_back(mesh.add_vertex(whole.positions[v]));
  mesh.ends = whole.ends;
  return mesh;
}

PolygonMesh misoriented(std::uint64_t size) {
  PolygonMesh mesh = ball(size);
  Random random;
  for (std::size_t i = 0; i < mesh.polygon_count(); ++i)
    if (random.below(3) == 0) turn_over(mesh, i);
  return mesh;
}

PolygonMesh inside_out(std::uint64_t size) {
  PolygonMesh mesh = ball(size);
  for (std::size_t i = 0; i < mesh.polygon_count(); ++i) turn_over(mesh, i);
  return mesh;
}

PolygonMesh holes(std::uint64_t size) {
  const PolygonMesh whole = ball(size);
  PolygonMesh mesh{whole.positions, {}, {}};
  Random random;
  for (std::size_t i = 0; i < whole.polygon_count(); ++i)
    if (const auto [a, b, c] = face(whole, i); random.below(10) != 0) mesh.add_face({a, b, c});
  return mesh;
}

// From pole to pole, each a millionth as wide as it is long.
PolygonMesh needles(std::uint64_t size) {
  PolygonMesh mesh = ball(size);
  Random random;
  for (std::uint64_t k = size / 20; k-- > 0;) {
    const double a = 2 * std::numbers::pi * random.share(), r = 0.3 * random.share();
    const Vec3d from{r * std::cos(a), r * std::sin(a), -0.5}, to{r * std::sin(a), r * std::cos(a), 0.5};
    const std::uint32_t p = mesh.add_vertex(from), q = mesh.add_vertex(to);
    mesh.add_face({p, mesh.add_vertex(from + Vec3d{1e-6, 0, 0}), q});
    mesh.add_face({p, q, mesh.add_vertex(0.5 * (from + to) + Vec3d{0, 1e-6, 0})});
  }
  return mesh;
}

PolygonMesh crossing(std::uint64_t size) {
  const PolygonMesh one = ball(size / 3);
  PolygonMesh mesh;
  for (const Vec3d shift : {Vec3d{0, 0, 0}, Vec3d{0.3, 0.05, 0}, Vec3d{0.1, 0.3, 0.1}}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3d& p : one.positions) mesh.add_vertex(p + shift);
    for (std::size_t i = 0; i < one.polygon_count(); ++i) {
      const auto [a, b, c] = face(one, i);
      mesh.add_face({first + a, first + b, first + c});
    }
  }
  return mesh;
}

}  // namespace lodestone::hard
