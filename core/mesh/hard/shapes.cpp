// Surfaces that are hard by their form or topology.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mesh/hard/makers.h"

namespace lodestone::hard {
namespace {

constexpr double turn = 2 * std::numbers::pi;

std::uint32_t squares(std::uint64_t size) {
  return static_cast<std::uint32_t>(std::max(2.0, std::sqrt(static_cast<double>(size) / 2)));
}

// n x n squares over [0, 1]^2, two triangles each; vertices are numbered row by row, n + 1 in each.
template <class Place>
PolygonMesh sheet(std::uint32_t n, const Place& place) {
  PolygonMesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) mesh.add_vertex(place(double(i) / n, double(j) / n));
  const auto at = [n](std::uint32_t i, std::uint32_t j) { return j * (n + 1) + i; };
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      mesh.add_face({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.add_face({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

// The vertices of column n become others, for strips that close.
template <class Partner>
void join_last_column(PolygonMesh& mesh, std::uint32_t n, const Partner& partner) {
  for (std::uint32_t& v : mesh.corners)
    if (v % (n + 1) == n) v = partner(v / (n + 1));
}

Vec3d on_circle(double share, double z) { return {0.5 * std::cos(turn * share), 0.5 * std::sin(turn * share), z}; }

}  // namespace

PolygonMesh fins(std::uint64_t size) {
  PolygonMesh mesh;
  for (std::uint64_t k = 0; 5 * k < size; ++k) {
    const double x = static_cast<double>(k % 20), y = static_cast<double>(k / 20);
    const std::uint32_t a = mesh.add_vertex({x, y, 0}), b = mesh.add_vertex({x, y, 0.8});
    for (std::uint64_t f = 0; f < 3 + k % 5; ++f) {
      const double angle = turn * static_cast<double>(f) / static_cast<double>(3 + k % 5);
      const std::uint32_t c = mesh.add_vertex({x + 0.4 * std::cos(angle), y + 0.4 * std::sin(angle), 0.4});
      f % 2 == 0 ? mesh.add_face({a, b, c}) : mesh.add_face({b, a, c});
    }
  }
  return mesh;
}

// Pyramids that stand on each other's tips.
PolygonMesh bow_ties(std::uint64_t size) {
  PolygonMesh mesh;
  std::uint32_t tip = mesh.add_vertex({0, 0, 0});
  for (std::uint64_t k = 0; 8 * k < size; ++k) {
    const double z = static_cast<double>(k);
    const std::uint32_t next = mesh.add_vertex({0, 0, z + 1});
    std::uint32_t ring[4];
    for (int c = 0; c < 4; ++c) ring[c] = mesh.add_vertex(on_circle(c / 4.0, z + 0.5));
    for (int c = 0; c < 4; ++c) {
      mesh.add_face({tip, ring[(c + 1) % 4], ring[c]});
      mesh.add_face({next, ring[c], ring[(c + 1) % 4]});
    }
    tip = next;
  }
  return mesh;
}

PolygonMesh moebius(std::uint64_t size) {
  const std::uint32_t n = squares(size);
  PolygonMesh mesh = sheet(n, [](double u, double v) {
    const double r = 1 + 0.4 * (v - 0.5) * std::cos(turn * u / 2);
    return Vec3d{r * std::cos(turn * u), r * std::sin(turn * u), 0.4 * (v - 0.5) * std::sin(turn * u / 2)};
  });
  join_last_column(mesh, n, [n](std::uint32_t row) { return (n - row) * (n + 1); });
  return mesh;
}

// The figure-eight immersion.
PolygonMesh klein(std::uint64_t size) {
  const std::uint32_t n = squares(size);
  PolygonMesh mesh = sheet(n, [](double u, double v) {
    const double a = turn * u, b = turn * v;
    const double r = 2 + std::cos(a / 2) * std::sin(b) - std::sin(a / 2) * std::sin(2 * b);
    return Vec3d{r * std::cos(a), r * std::sin(a), std::sin(a / 2) * std::sin(b) + std::cos(a / 2) * std::sin(2 * b)};
  });
  join_last_column(mesh, n, [n](std::uint32_t row) { return (n - row) * (n + 1); });
  for (std::uint32_t& v : mesh.corners)
    if (v / (n + 1) == n) v -= n * (n + 1);  // the last row is the first one
  return mesh;
}

PolygonMesh plane(std::uint64_t size) {
  return sheet(squares(size), [](double u, double v) { return Vec3d{u, v, 0}; });
}

PolygonMesh flat(std::uint64_t size) {
  return sheet(squares(size), [](double u, double v) {
    const double inside = std::max(0.0, 1 - 100 * ((u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5)));
    return Vec3d{u, v, 0.01 * inside * inside};
  });
}

PolygonMesh cylinder(std::uint64_t size) {
  const std::uint32_t n = squares(size);
  PolygonMesh mesh = sheet(n, [](double u, double v) { return on_circle(u, v); });
  join_last_column(mesh, n, [n](std::uint32_t row) { return row * (n + 1); });
  return mesh;
}

PolygonMesh crease(std::uint64_t size) {
  return sheet(squares(size), [](double u, double v) { return Vec3d{u, v, std::abs(u - 0.5)}; });
}

PolygonMesh cone(std::uint64_t size) {
  const std::uint32_t n = squares(size);
  PolygonMesh mesh = sheet(n, [](double u, double v) {
    const Vec3d p = on_circle(u, 0);
    return Vec3d{(1 - v) * p.x, (1 - v) * p.y, v};
  });
  join_last_column(mesh, n, [n](std::uint32_t row) { return row * (n + 1); });
  for (std::uint32_t& v : mesh.corners)
    if (v / (n + 1) == n) v = n * (n + 1);  // the last row is the tip
  return mesh;
}

PolygonMesh wheel(std::uint64_t size) {
  const auto n = static_cast<std::uint32_t>(std::max<std::uint64_t>(size, 3));
  PolygonMesh mesh;
  mesh.add_vertex({0, 0, 0.1});
  for (std::uint32_t k = 0; k < n; ++k) mesh.add_vertex(on_circle(double(k) / n, 0.01 * std::sin(40 * turn * k / n)));
  for (std::uint32_t k = 0; k < n; ++k) mesh.add_face({0, 1 + k, 1 + (k + 1) % n});
  return mesh;
}

// Its teeth point up; between them a fan of triangles from one corner would leave the polygon.
PolygonMesh comb(std::uint64_t size) {
  const auto teeth = static_cast<std::uint32_t>(std::max<std::uint64_t>(size / 2, 2));
  PolygonMesh mesh;
  mesh.add_vertex({1, 0, 0}), mesh.add_vertex({0, 0, 0});
  for (std::uint32_t k = 0; k + 1 < teeth; ++k) {
    mesh.add_vertex({(k + 0.3) / teeth, 0.5, 0});
    mesh.add_vertex({(k + 0.6) / teeth, 0.05, 0});
  }
  for (std::uint32_t v = static_cast<std::uint32_t>(mesh.positions.size()); v-- > 0;) mesh.corners.push_back(v);
  mesh.ends.push_back(mesh.corners.size());
  return mesh;
}

// A strip of ten turns: out along one side, back along the other.
PolygonMesh spiral(std::uint64_t size) {
  const auto n = static_cast<std::uint32_t>(std::max<std::uint64_t>(size / 2, 4));
  PolygonMesh mesh;
  const auto add = [&](double share, double width) {
    mesh.add_vertex((0.1 + 0.9 * share + width) * 2 * on_circle(10 * share, 0));
  };
  for (std::uint32_t k = 0; k < n; ++k) add(double(n - 1 - k) / (n - 1), 0);
  for (std::uint32_t k = 0; k < n; ++k) add(double(k) / (n - 1), 0.04);
  for (std::uint32_t v = static_cast<std::uint32_t>(mesh.positions.size()); v-- > 0;) mesh.corners.push_back(v);
  mesh.ends.push_back(mesh.corners.size());
  return mesh;
}

PolygonMesh leaf(std::uint64_t size) {
  PolygonMesh mesh = plane(size / 2);
  const PolygonMesh other = mesh;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3d& p : other.positions) mesh.add_vertex({p.x, p.y, 1e-9 * std::sin(30 * p.x + 20 * p.y)});
  for (std::size_t i = 0; i < other.polygon_count(); ++i)
    mesh.add_face({first + other.corners[3 * i], first + other.corners[3 * i + 2], first + other.corners[3 * i + 1]});
  return mesh;
}

PolygonMesh one_triangle(std::uint64_t) { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}}, {0, 1, 2}, {3}}; }

PolygonMesh on_a_line(std::uint64_t size) {
  PolygonMesh mesh;
  for (std::uint64_t k = 0; k < size + 2; ++k) mesh.add_vertex(static_cast<double>(k) * Vec3d{1, 2, 4});
  for (std::uint32_t k = 0; k < size; ++k) mesh.add_face({k, k + 1, k + 2});
  return mesh;
}

PolygonMesh in_a_point(std::uint64_t size) {
  PolygonMesh mesh;
  for (std::uint32_t k = 0; k < size; ++k) {
    const std::uint32_t v = mesh.add_vertex({0.3, 0.7, 0.1});
    mesh.add_vertex({0.3, 0.7, 0.1}), mesh.add_vertex({0.3, 0.7, 0.1});
    mesh.add_face({v, v + 1, v + 2});
  }
  return mesh;
}

PolygonMesh nothing(std::uint64_t) { return {}; }

}  // namespace lodestone::hard
