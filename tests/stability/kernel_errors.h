// Rounding errors of the program's kernels, against the same formulas in rational arithmetic or, where roots and powers
// are taken, in long double; and the errors and costs of other precisions. On triangles of the catalogue of hard
// surfaces.
#pragma once

#include <cmath>
#include <ctime>
#include <random>
#include <string>

#include "core/math/quadric.h"
#include "core/spherical/parameterize/sphere_measure.h"
#include "parallel/clean/prepare.h"
#include "render/lod/morph.h"
#include "tests/hard_mesh.h"
#include "tests/stability/exact.h"

namespace lodestone::test {

struct KernelError {
  double below = 0, above = 0;  // largest amounts by which a result is too small, and too large
  std::string worst;            // the case with the larger of both
  void add(long double found, long double exact, const std::string& name) {
    const auto off = static_cast<double>(found - exact);
    if (std::abs(off) > std::max(below, above)) worst = name;
    below = std::max(below, -off);
    above = std::max(above, off);
  }
  [[nodiscard]] double largest() const { return std::max(below, above); }
};

inline long double root_of(const Rational& squared) {
  mpf_class value(squared, 256);
  const mpf_class root = sqrt(value);
  const double high = root.get_d();
  return static_cast<long double>(high) + static_cast<long double>(mpf_class(root - high).get_d());
}

// ---- closest points ----

// A point and a triangle, in the unit cube; exactly floats.
struct PointAndTriangle {
  std::string name;
  Vec3d p;
  std::array<Vec3d, 3> t;
};

// For every surface of the catalogue: points near a triangle, at its corners' places on others, and anywhere.
inline std::vector<PointAndTriangle> points_and_triangles(std::size_t most_triangles) {
  std::vector<PointAndTriangle> all;
  std::mt19937 random(4);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto scheduler = make_serial_scheduler();
  for (const HardCase& hard : hard_cases()) {
    if (!hard.refusal.empty()) continue;
    Repairs repairs;
    const IndexedMesh mesh = prepare_mesh(hard_mesh(hard, 400), repairs, *scheduler);
    const std::size_t stride = 1 + mesh.triangles.size() / most_triangles;
    for (std::size_t k = 0; k < mesh.triangles.size(); k += stride) {
      const auto& v = mesh.triangles[k].v;
      const std::array<Vec3d, 3> t{to_double(mesh.positions[v[0]]), to_double(mesh.positions[v[1]]),
                                   to_double(mesh.positions[v[2]])};
      const auto add = [&](Vec3d p) { all.push_back({std::string(hard.name), to_double(to_float(p)), t}); };
      const float u = unit(random), w = (1 - u) * unit(random);
      const Vec3d inside = t[0] + u * (t[1] - t[0]) + w * (t[2] - t[0]);
      add(inside);
      add(inside + 1e-3 * Vec3d{unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5});
      add(to_double(mesh.positions[random() % mesh.positions.size()]));
      add({unit(random), unit(random), unit(random)});
    }
  }
  return all;
}

// The program's own kernel.
inline double program_distance(const PointAndTriangle& c) {
  return std::sqrt(nearest_on_triangle(c.p, c.t[0], c.t[1], c.t[2]).squared_distance);
}
// The plain formula in a precision.
template <class T>
T plain_distance(const PointAndTriangle& c) {
  return std::sqrt(squared_distance(as<T>(c.p), Corners<T>{as<T>(c.t[0]), as<T>(c.t[1]), as<T>(c.t[2])}));
}
inline long double exact_distance(const PointAndTriangle& c) {
  return root_of(squared_distance(exact(c.p), ExactTriangle{exact(c.t[0]), exact(c.t[1]), exact(c.t[2])}));
}

// ---- quadrics ----

// Planes through the corners of triangles around a vertex, and a place near it.
struct Star {
  std::string name;
  Vec3d vertex, x;
  std::vector<Vec3d> normals;  // rounded: the same numbers for every precision
  std::vector<Vec3d> points;
  std::vector<double> weights;
};

inline std::vector<Star> stars(std::size_t most_vertices) {
  std::vector<Star> all;
  std::mt19937 random(5);
  const auto scheduler = make_serial_scheduler();
  for (const HardCase& hard : hard_cases()) {
    if (!hard.refusal.empty()) continue;
    Repairs repairs;
    const IndexedMesh mesh = prepare_mesh(hard_mesh(hard, 400), repairs, *scheduler);
    const std::size_t stride = 1 + mesh.positions.size() / most_vertices;
    for (std::size_t v = 0; v < mesh.positions.size(); v += stride) {
      Star star{std::string(hard.name), to_double(mesh.positions[v]), {}, {}, {}, {}};
      double reach = 0;
      for (const Triangle& t : mesh.triangles) {
        if (t.v[0] != v && t.v[1] != v && t.v[2] != v) continue;
        const Vec3d a = to_double(mesh.positions[t.v[0]]), b = to_double(mesh.positions[t.v[1]]),
                    c = to_double(mesh.positions[t.v[2]]), n = cross(b - a, c - a);
        const double size = length(n);
        if (!(size > 1e-30)) continue;
        star.normals.push_back(to_double(to_float((1 / size) * n)));
        star.points.push_back(star.vertex);
        star.weights.push_back(static_cast<float>(size / 2));
        reach = std::max({reach, length(b - a), length(c - a)});
      }
      if (star.normals.empty()) continue;
      const auto part = [&] { return reach * (static_cast<double>(random() % 1001) / 1000 - 0.5); };
      const Vec3d by{part(), part(), part()};
      star.x = to_double(to_float(star.vertex + by));
      all.push_back(std::move(star));
    }
  }
  return all;
}

// Root of the mean squared distance of x from the planes.
inline double quadric_in_double(const Star& star) {
  Quadric q;
  for (std::size_t k = 0; k < star.normals.size(); ++k) q.add_plane(star.normals[k], star.points[k], star.weights[k]);
  return std::sqrt(q.cost(star.x));
}
inline double centred_quadric_in_float(const Star& star) {
  CentredQuadric q{};
  for (std::size_t k = 0; k < star.normals.size(); ++k) {
    const auto w = static_cast<float>(star.weights[k]);
    q.add_plane(to_float(star.normals[k]), w);
    q.weight += w;
  }
  const float sum = q.at(to_float(star.x - star.vertex));
  return sum > 0 ? std::sqrt(double{sum} / q.weight) : 0;
}
// The quadric about the origin of the cube, as in double, in a precision.
template <class T>
T plain_quadric(const Star& star) {
  T xx{}, xy{}, xz{}, yy{}, yz{}, zz{}, c{}, weight{};
  Vec<T> b;
  for (std::size_t k = 0; k < star.normals.size(); ++k) {
    const Vec<T> n = as<T>(star.normals[k]);
    const T w = T(star.weights[k]), d = T(-dot(n, as<T>(star.points[k])));
    xx += T(w * n.x * n.x), xy += T(w * n.x * n.y), xz += T(w * n.x * n.z);
    yy += T(w * n.y * n.y), yz += T(w * n.y * n.z), zz += T(w * n.z * n.z);
    b = b + T(w * d) * n;
    c += T(w * d * d);
    weight += w;
  }
  const Vec<T> x = as<T>(star.x);
  const Vec<T> ax{T(xx * x.x + xy * x.y + xz * x.z), T(xy * x.x + yy * x.y + yz * x.z),
                  T(xz * x.x + yz * x.y + zz * x.z)};
  const T sum = T(dot(x, ax) + 2 * dot(b, x) + c);
  return sum > 0 ? T(sum / weight) : T(0);
}
template <class T>
T plain_quadric_root(const Star& star) {
  return std::sqrt(plain_quadric<T>(star));
}
inline long double exact_quadric(const Star& star) { return root_of(plain_quadric<Rational>(star)); }

// The minimum of the mean squared distance from the planes and the stiffness times that from p, exactly.
inline Vec<Rational> exact_minimum(const Star& star, const Vec3d& from, double stiffness) {
  const Vec<Rational> p = exact(from);
  Rational a[3][3], weight = 0;
  Vec<Rational> gradient;
  for (std::size_t k = 0; k < star.normals.size(); ++k) {
    const Vec<Rational> n = exact(star.normals[k]);
    const Rational w(star.weights[k]), off = dot(n, p - exact(star.points[k]));
    const Rational* const parts[3] = {&n.x, &n.y, &n.z};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) a[i][j] += w * *parts[i] * *parts[j];
    gradient = gradient + Rational(w * off) * n;
    weight += w;
  }
  for (int i = 0; i < 3; ++i) a[i][i] += Rational(stiffness) * weight;
  const auto column = [&](int j) { return Vec<Rational>{a[0][j], a[1][j], a[2][j]}; };
  const Vec<Rational> c0 = column(0), c1 = column(1), c2 = column(2);
  const Rational determinant = dot(c0, cross(c1, c2));
  const Vec<Rational> step{Rational(dot(gradient, cross(c1, c2)) / determinant),
                           Rational(dot(c0, cross(gradient, c2)) / determinant),
                           Rational(dot(c0, cross(c1, gradient)) / determinant)};
  return p - step;
}

// ---- lambda ----

// A vertex, a viewpoint and a band.
struct BandView {
  std::string name;
  Vec3f vertex, from;
  float begin = 0, end = 0;
};
inline std::vector<BandView> band_views(std::size_t count) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<BandView> all;
  while (all.size() < count) {
    const Vec3f v{unit(random), unit(random), unit(random)};
    const float size = std::exp2(-10 * unit(random)), begin = size * (1 + unit(random)), end = begin + size / 2;
    const Vec3f way{unit(random) - 0.5f, unit(random) - 0.5f, unit(random) - 0.5f};
    const float d = begin + unit(random) * (end - begin);
    all.push_back({{}, v, v + (d / length(way)) * way, begin, end});
  }
  return all;
}
template <class T>
T plain_lambda(const BandView& view) {
  const Vec<T> by = as<T>(to_double(view.vertex)) - as<T>(to_double(view.from));
  const T d = std::sqrt(squared_length(by));
  if (d <= view.begin) return 1;
  if (d >= view.end) return 0;
  const T t = (d - T(view.begin)) / (T(view.end) - T(view.begin));
  return 1 - t * t * (3 - 2 * t);
}

// ---- stretch of the map to the sphere ----

struct SphereTriangle {
  std::string name;
  std::array<Vec3d, 3> surface, sphere;
};
// Triangles of the catalogue over small ones on the sphere, down to needles.
inline std::vector<SphereTriangle> sphere_triangles(std::size_t most_triangles) {
  std::vector<SphereTriangle> all;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto on_sphere = [](Vec3d v) { return (1 / length(v)) * v; };
  for (const PointAndTriangle& c : points_and_triangles(most_triangles)) {
    const Vec3d n = cross(c.t[1] - c.t[0], c.t[2] - c.t[0]);
    if (!(length(n) > 1e-9)) continue;
    const Vec3d a = on_sphere({normal(random), normal(random), normal(random)});
    const double size = std::pow(10.0, -static_cast<double>(random() % 5)),
                 thin = std::pow(10.0, -static_cast<double>(random() % 3));
    const Vec3d u = on_sphere(cross(a, {normal(random), normal(random), normal(random)})), v = cross(a, u);
    all.push_back({c.name, c.t, {a, on_sphere(a + size * u), on_sphere(a + 0.4 * size * u + thin * size * v)}});
  }
  return all;
}
// The share of a triangle in SphereSums::stretch, by its definition.
template <class T>
T plain_stretch(const SphereTriangle& t) {
  using Three = Corners<T>;
  const auto size_of = [](const Three& c) { return std::sqrt(squared_length(cross(c[1] - c[0], c[2] - c[0]))) / 2; };
  const auto flat = [&](const Three& surface, const Three& sphere) {
    T sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      sum += dot(surface[(k + 1) % 3] - surface[k], surface[(k + 2) % 3] - surface[k]) *
             squared_length(sphere[(k + 1) % 3] - sphere[(k + 2) % 3]);
    return size_of(surface) * sum / (8 * (size_of(sphere) * size_of(sphere)));
  };
  const Three surface{as<T>(t.surface[0]), as<T>(t.surface[1]), as<T>(t.surface[2])};
  const Three sphere{as<T>(t.sphere[0]), as<T>(t.sphere[1]), as<T>(t.sphere[2])};
  std::size_t last = 0;
  const auto across = [&](std::size_t k) { return squared_length(sphere[(k + 1) % 3] - sphere[(k + 2) % 3]); };
  for (std::size_t k = 1; k < 3; ++k)
    if (across(k) > across(last)) last = k;
  const std::size_t i = (last + 1) % 3, j = (last + 2) % 3;
  const Vec<T> a = sphere[i], b = sphere[j], c = sphere[last], n = cross(a, b);
  const Vec<T> foot = c - T(dot(c, n) / squared_length(n)) * n;
  const T s = dot(cross(foot, b), n), r = dot(cross(a, foot), n);
  if (!(s > 0 && r > 0)) return flat(surface, sphere);
  const Vec<T> middle = T(1 / std::sqrt(squared_length(foot))) * foot;
  const Vec<T> below = T(1 / (s + r)) * (s * surface[i] + r * surface[j]);
  return flat({surface[i], below, surface[last]}, {a, middle, c}) +
         flat({below, surface[j], surface[last]}, {middle, b, c});
}
inline double program_stretch(const SphereTriangle& t) {
  const Triangle only{{0, 1, 2}};
  return spherical::measure_sphere_map(t.surface, std::span(&only, 1), t.sphere).stretch;
}

// ---- cost ----

// Processor nanoseconds of a call, the least of some rounds over all cases. The sum keeps the calls from vanishing.
template <class Cases, class Kernel>
double nanoseconds(const Cases& cases, const Kernel& kernel) {
  double least = HUGE_VAL;
  volatile double sink = 0;
  for (int round = 0; round < 7; ++round) {
    timespec from{}, to{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
    double sum = 0;
    for (const auto& c : cases) sum += static_cast<double>(kernel(c));
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &to);
    sink = sink + sum;
    least = std::min(
        least, 1e9 * static_cast<double>(to.tv_sec - from.tv_sec) + static_cast<double>(to.tv_nsec - from.tv_nsec));
  }
  return least / static_cast<double>(cases.size());
}

template <class Cases, class Exact>
std::vector<long double> exact_of(const Cases& cases, const Exact& exact) {
  std::vector<long double> values;
  for (const auto& c : cases) values.push_back(exact(c));
  return values;
}
template <class Cases, class Kernel>
KernelError errors_of(const Cases& cases, std::span<const long double> exact, const Kernel& kernel) {
  KernelError error;
  for (std::size_t k = 0; k < cases.size(); ++k)
    error.add(static_cast<long double>(kernel(cases[k])), exact[k], cases[k].name);
  return error;
}

}  // namespace lodestone::test
