#include "core/mesh/noise.h"

#include <array>
#include <cmath>

namespace lodestone {
namespace {

std::uint32_t hash(std::uint32_t h) {
  h = (h ^ (h >> 16)) * 0x7FEB352Du;
  h = (h ^ (h >> 15)) * 0x846CA68Bu;
  return h ^ (h >> 16);
}

double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }
double mix(double a, double b, double t) { return a + t * (b - a); }

struct Lattice {
  std::uint32_t cell;  // as unsigned: it wraps
  double at;           // position within the cell, in [0, 1)
};

Lattice lattice(double x) {
  const double floor = std::floor(x);
  return {static_cast<std::uint32_t>(static_cast<std::int64_t>(floor)), x - floor};
}

// Multiples of large odd numbers, so that neighbouring corners differ in many bits before they are hashed.
constexpr std::uint32_t step_x = 0x9E3779B1u, step_y = 0x85EBCA77u, step_z = 0xC2B2AE3Du;

// Edge midpoints of a cube: directions without a preferred axis. Four of the twelve are there twice.
constexpr std::array<std::array<float, 3>, 16> gradients{{{1, 1, 0},
                                                          {-1, 1, 0},
                                                          {1, -1, 0},
                                                          {-1, -1, 0},
                                                          {1, 0, 1},
                                                          {-1, 0, 1},
                                                          {1, 0, -1},
                                                          {-1, 0, -1},
                                                          {0, 1, 1},
                                                          {0, -1, 1},
                                                          {0, 1, -1},
                                                          {0, -1, -1},
                                                          {1, 1, 0},
                                                          {-1, 1, 0},
                                                          {0, -1, 1},
                                                          {0, -1, -1}}};

double slope(std::uint32_t corner, double x, double y, double z) {
  const std::array<float, 3>& g = gradients[hash(corner) >> 28];
  return g[0] * x + g[1] * y + g[2] * z;
}

double slope(std::uint32_t corner, double x, double y) {
  const std::array<float, 3>& g = gradients[hash(corner) >> 28];
  return (g[0] + g[2]) * x + (g[1] - g[2]) * y;
}

double gradient_noise(std::uint32_t seed, Vec3d p) {
  const auto [i, x] = lattice(p.x);
  const auto [j, y] = lattice(p.y);
  const auto [k, z] = lattice(p.z);
  const std::uint32_t base = seed + i * step_x + j * step_y + k * step_z;
  const double u = fade(x), v = fade(y), w = fade(z);
  const auto edge = [&](std::uint32_t corner, double dy, double dz) {
    return mix(slope(corner, x, dy, dz), slope(corner + step_x, x - 1, dy, dz), u);
  };
  const double near = mix(edge(base, y, z), edge(base + step_y, y - 1, z), v);
  const double far = mix(edge(base + step_z, y, z - 1), edge(base + step_y + step_z, y - 1, z - 1), v);
  return mix(near, far, w);
}

double gradient_noise(std::uint32_t seed, double px, double py) {
  const auto [i, x] = lattice(px);
  const auto [j, y] = lattice(py);
  const std::uint32_t base = seed + i * step_x + j * step_y;
  const double u = fade(x), v = fade(y);
  const double near = mix(slope(base, x, y), slope(base + step_x, x - 1, y), u);
  const double far = mix(slope(base + step_y, x, y - 1), slope(base + step_x + step_y, x - 1, y - 1), u);
  return mix(near, far, v);
}

// Every octave has a hash of its own: with one for all, the zeros at lattice points would coincide.
template <class Octave>
double sum_octaves(const FractalNoise& noise, const Octave& octave) {
  double sum = 0, amplitude = 1, frequency = noise.frequency;
  for (int k = 0; k < noise.octaves; ++k) {
    sum += amplitude * octave(hash(noise.seed + static_cast<std::uint32_t>(k) * step_z), frequency);
    amplitude *= noise.gain;
    frequency *= 2;
  }
  return sum;
}

}  // namespace

double fractal_noise(const FractalNoise& noise, Vec3d p) {
  return sum_octaves(noise, [&](std::uint32_t seed, double f) { return gradient_noise(seed, f * p); });
}

double fractal_noise(const FractalNoise& noise, double x, double y) {
  return sum_octaves(noise, [&](std::uint32_t seed, double f) { return gradient_noise(seed, f * x, f * y); });
}

}  // namespace lodestone
