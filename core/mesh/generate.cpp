// Displacement is gradient noise (perlin2002) summed over octaves down to a few grid edges, so that a finer surface of
// the same seed has the same large shape and more detail.
#include "core/mesh/generate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/error.h"

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

Shape shape(std::string_view name) {
  constexpr std::array<std::string_view, 4> names{"sphere", "terrain", "torus", "box"};
  for (std::size_t i = 0; i < names.size(); ++i)
    if (name == names[i]) return static_cast<Shape>(i);
  throw InputError("unknown shape '" + std::string(name) + "'; known are sphere, terrain, torus, box");
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
  }
  return {};
}

Triangle GeneratedSurface::triangle(std::uint64_t index) const {
  return shape_ == Shape::sphere || shape_ == Shape::box ? cube_triangle(index) : grid_triangle(index);
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
