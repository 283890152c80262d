// Displacement is gradient noise (perlin2002) summed over octaves down to a few grid edges, so that a finer surface of
// the same seed has the same large shape and more detail.
#include "core/mesh/generate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/error.h"
#include "core/base/known_names.h"

namespace lodestone {
namespace {

constexpr float pi = 3.14159265358979f;

std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t seed) {
  std::uint32_t h = seed ^ (x * 0x8da6'b343u) ^ (y * 0xd816'3841u) ^ (z * 0xcb1a'b31fu);
  h = (h ^ (h >> 15)) * 0x2c1b'3c6du;
  h = (h ^ (h >> 12)) * 0x297a'2d39u;
  return h ^ (h >> 15);
}

// Dot product of (x, y, z) with one of the twelve edge directions of a cube.
float gradient(std::uint32_t h, float x, float y, float z) {
  const std::uint32_t k = (h >> 8) % 12;
  const float u = k < 8 ? x : y, v = k < 4 ? y : z;
  return (h & 1 ? -u : u) + (h & 2 ? -v : v);
}

float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }
float mix(float t, float a, float b) { return a + t * (b - a); }

float noise(Vec3f p, std::uint32_t seed) {
  const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  const auto cell = [](float f) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(f)); };
  const std::uint32_t ix = cell(fx), iy = cell(fy), iz = cell(fz);
  const float x = p.x - fx, y = p.y - fy, z = p.z - fz;
  const float u = fade(x), v = fade(y), w = fade(z);
  const auto corner = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    return gradient(hash(ix + i, iy + j, iz + k, seed), x - static_cast<float>(i), y - static_cast<float>(j),
                    z - static_cast<float>(k));
  };
  const auto plane = [&](std::uint32_t k) {
    return mix(v, mix(u, corner(0, 0, k), corner(1, 0, k)), mix(u, corner(0, 1, k), corner(1, 1, k)));
  };
  return mix(w, plane(0), plane(1));
}

std::uint32_t squares(std::uint64_t triangles, double per_square) {
  return std::max(1u, static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / per_square))));
}

// A coordinate of the cube [-1, 1] bent so that squares keep nearly equal areas on the sphere.
float bend(float c) { return std::tan(c * (pi / 4)); }

}  // namespace

Shape shape_named(std::string_view name) {
  constexpr std::array<std::string_view, 5> names{"sphere", "terrain", "torus", "box", "pile"};
  for (std::size_t i = 0; i < names.size(); ++i)
    if (name == names[i]) return static_cast<Shape>(i);
  throw InputError("unknown shape '" + std::string(name) + "'; " + known_names(name, {names.begin(), names.end()}));
}

GeneratedSurface::GeneratedSurface(const GenerateConfig& config) : shape_(config.shape), seed_(config.seed) {
  if (config.triangles < 12 || config.triangles > 2'000'000'000)
    throw InputError("the number of triangles must lie between 12 and 2000000000");
  switch (shape_) {
    case Shape::sphere:
    case Shape::box:
      n_ = m_ = squares(config.triangles, 12);
      triangle_count_ = 12ull * n_ * n_;
      vertex_count_ = 6ull * n_ * n_ + 2;
      break;
    case Shape::terrain:
      n_ = m_ = squares(config.triangles, 2);
      triangle_count_ = 2ull * n_ * n_;
      vertex_count_ = (n_ + 1ull) * (n_ + 1ull);
      break;
    case Shape::torus:
      m_ = std::max(3u, squares(config.triangles, 4));
      n_ = std::max(3u, static_cast<std::uint32_t>((config.triangles / 2 + m_ / 2) / m_));
      triangle_count_ = 2ull * n_ * m_;
      vertex_count_ = std::uint64_t{n_} * m_;
      break;
    case Shape::pile: {
      const std::uint64_t boxes = (config.triangles + 6) / 12;
      triangle_count_ = 12 * boxes, vertex_count_ = 8 * boxes;
      n_ = m_ = 1;
      break;
    }
  }
  // The last octave's waves are about eight edges long.
  octaves_ = std::clamp(static_cast<int>(std::lround(std::log2(std::max(n_, m_)))) - 3, 1, 16);
}

float GeneratedSurface::displacement(Vec3f p, float base_frequency) const {
  constexpr float gain = 0.45f;
  float sum = 0, amplitude = 1, frequency = base_frequency;
  for (int octave = 0; octave < octaves_; ++octave, amplitude *= gain, frequency *= 2)
    sum +=
        amplitude * noise(frequency * p, static_cast<std::uint32_t>(seed_ * 31 + static_cast<std::uint64_t>(octave)));
  return sum;
}

// Surface points of the lattice [0,n]^3 are numbered by layers of z: a full square, rings of 4n points, a full square.
Vec3f GeneratedSurface::lattice_point(std::uint64_t index) const {
  const std::uint64_t side = n_ + 1ull, bottom = side * side, ring = 4ull * n_, rings = ring * (n_ - 1ull);
  std::uint64_t x, y, z;
  if (index < bottom || index >= bottom + rings) {
    const std::uint64_t i = index < bottom ? index : index - bottom - rings;
    x = i % side, y = i / side, z = index < bottom ? 0 : n_;
  } else {
    const std::uint64_t i = (index - bottom) % ring, k = i % n_;
    z = 1 + (index - bottom) / ring;
    switch (i / n_) {  // counter-clockwise from the origin
      case 0:
        x = k, y = 0;
        break;
      case 1:
        x = n_, y = k;
        break;
      case 2:
        x = n_ - k, y = n_;
        break;
      default:
        x = 0, y = n_ - k;
        break;
    }
  }
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

std::uint32_t GeneratedSurface::lattice_index(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
  const std::uint64_t side = n_ + 1ull, bottom = side * side, ring = 4ull * n_;
  if (z == 0) return static_cast<std::uint32_t>(y * side + x);
  if (z == n_) return static_cast<std::uint32_t>(bottom + ring * (n_ - 1ull) + y * side + x);
  std::uint64_t i;
  if (y == 0 && x < n_) {
    i = x;
  } else if (x == n_ && y < n_) {
    i = std::uint64_t{n_} + y;
  } else if (y == n_ && x > 0) {
    i = 2ull * n_ + (n_ - x);
  } else {
    i = 3ull * n_ + (n_ - y);
  }
  return static_cast<std::uint32_t>(bottom + ring * (z - 1ull) + i);
}

// Two triangles per square; six faces, each with its own pair of axes so that normals point outward.
Triangle GeneratedSurface::cube_triangle(std::uint64_t index) const {
  const std::uint64_t square = index / 2, per_face = std::uint64_t{n_} * n_;
  const auto face = static_cast<std::uint32_t>(square / per_face);
  const auto i = static_cast<std::uint32_t>(square % per_face % n_),
             j = static_cast<std::uint32_t>(square % per_face / n_);
  const auto corner = [&](std::uint32_t u, std::uint32_t v) {
    switch (face) {
      case 0:
        return lattice_index(v, u, 0);  // z = 0, seen from below
      case 1:
        return lattice_index(u, v, n_);  // z = n
      case 2:
        return lattice_index(u, 0, v);  // y = 0
      case 3:
        return lattice_index(v, n_, u);  // y = n
      case 4:
        return lattice_index(0, v, u);  // x = 0
      default:
        return lattice_index(n_, u, v);  // x = n
    }
  };
  const std::uint32_t a = corner(i, j), b = corner(i + 1, j), c = corner(i, j + 1), d = corner(i + 1, j + 1);
  return index % 2 == 0 ? Triangle{{a, b, d}} : Triangle{{a, d, c}};
}

Triangle GeneratedSurface::grid_triangle(std::uint64_t index) const {
  const std::uint64_t square = index / 2;
  const std::uint64_t i = square % n_, j = square / n_;
  const bool wraps = shape_ == Shape::torus;
  const std::uint64_t width = wraps ? n_ : n_ + 1ull;
  const std::uint64_t i1 = wraps ? (i + 1) % n_ : i + 1, j1 = wraps ? (j + 1) % m_ : j + 1;
  const auto at = [&](std::uint64_t u, std::uint64_t v) { return static_cast<std::uint32_t>(v * width + u); };
  return index % 2 == 0 ? Triangle{{at(i, j), at(i1, j), at(i1, j1)}} : Triangle{{at(i, j), at(i1, j1), at(i, j1)}};
}

Triangle GeneratedSurface::pile_triangle(std::uint64_t index) const {
  constexpr std::array<Triangle, 12> faces{{{{0, 2, 3}},
                                            {{0, 3, 1}},
                                            {{4, 5, 7}},
                                            {{4, 7, 6}},
                                            {{0, 1, 5}},
                                            {{0, 5, 4}},
                                            {{2, 6, 7}},
                                            {{2, 7, 3}},
                                            {{0, 4, 6}},
                                            {{0, 6, 2}},
                                            {{1, 3, 7}},
                                            {{1, 7, 5}}}};
  const auto first = static_cast<std::uint32_t>(index / 12 * 8);
  const Triangle& t = faces[index % 12];
  return {{first + t.v[0], first + t.v[1], first + t.v[2]}};
}

// Corner k has the bits of x, y, z from the lowest.
Vec3f GeneratedSurface::box_corner(std::uint64_t box, std::uint32_t corner) const {
  std::uint32_t draws = 0;
  const auto uniform = [&](float lo, float hi) {
    const std::uint32_t h = hash(static_cast<std::uint32_t>(box), static_cast<std::uint32_t>(box >> 32), draws++,
                                 static_cast<std::uint32_t>(seed_ * 31));
    return lo + (hi - lo) * static_cast<float>(h >> 8) / 16777216.0f;
  };
  const auto direction = [&] {
    const float z = uniform(-1, 1), angle = uniform(-pi, pi), r = std::sqrt(1 - z * z);
    return Vec3f{r * std::cos(angle), r * std::sin(angle), z};
  };
  const Vec3f centre = std::cbrt(uniform(0, 1)) * direction();
  const Vec3f x = direction(), other = direction();
  const Vec3f sideways = cross(other, x), upright = std::abs(x.x) < 0.7f ? Vec3f{0, -x.z, x.y} : Vec3f{-x.y, x.x, 0};
  const Vec3f across = length(sideways) > 1e-3f ? sideways : upright;
  const Vec3f y = (1 / length(across)) * across, z = cross(x, y);
  // Three times the volume of the ball in all.
  const float side = 1.7f / std::cbrt(static_cast<float>(vertex_count_ / 8));
  const float a = side * uniform(0.4f, 1), b = side * uniform(0.4f, 1), c = side * uniform(0.4f, 1);
  return centre + (corner & 1 ? a : -a) * x + (corner & 2 ? b : -b) * y + (corner & 4 ? c : -c) * z;
}

Vec3f GeneratedSurface::vertex(std::uint64_t index) const {
  const auto n = static_cast<float>(n_), m = static_cast<float>(m_);
  switch (shape_) {
    case Shape::box: {
      const Vec3f p = lattice_point(index);
      return {p.x / n, p.y / n, p.z / n};
    }
    case Shape::sphere: {
      const Vec3f p = lattice_point(index);
      const Vec3f c{bend(2 * p.x / n - 1), bend(2 * p.y / n - 1), bend(2 * p.z / n - 1)};
      const Vec3f s = (1 / length(c)) * c;
      return (1 + 0.15f * displacement(s, 2)) * s;
    }
    case Shape::terrain: {
      const std::uint64_t width = n_ + 1ull;
      const Vec3f p{static_cast<float>(index % width) / n, static_cast<float>(index / width) / n, 0};
      return {p.x, p.y, 0.12f * displacement(p, 4)};
    }
    case Shape::torus: {
      const float u = 2 * pi * static_cast<float>(index % n_) / n, v = 2 * pi * static_cast<float>(index / n_) / m;
      const auto around = [&](float r) {
        const float ring = 1 + r * std::cos(v);
        return Vec3f{ring * std::cos(u), ring * std::sin(u), r * std::sin(v)};
      };
      return around(0.4f + 0.06f * displacement(around(0.4f), 2));
    }
    case Shape::pile:
      return box_corner(index / 8, static_cast<std::uint32_t>(index % 8));
  }
  return {};
}

Triangle GeneratedSurface::triangle(std::uint64_t index) const {
  switch (shape_) {
    case Shape::sphere:
    case Shape::box:
      return cube_triangle(index);
    case Shape::pile:
      return pile_triangle(index);
    default:
      return grid_triangle(index);
  }
}

RawMesh generate_mesh(const GenerateConfig& config) {
  const GeneratedSurface surface(config);
  RawMesh mesh;
  mesh.positions.reserve(surface.vertex_count());
  mesh.triangles.reserve(surface.triangle_count());
  for (std::uint64_t i = 0; i < surface.vertex_count(); ++i) mesh.positions.push_back(to_double(surface.vertex(i)));
  for (std::uint64_t i = 0; i < surface.triangle_count(); ++i) mesh.triangles.push_back(surface.triangle(i));
  return mesh;
}

}  // namespace lodestone
