// Fractal gradient noise (Perlin 1985, with the fifth-degree fade of Perlin 2002), seeded, on an integer hash instead
// of a permutation table: no period, and the same bits on every machine.
#pragma once

#include <cstdint>

#include "core/base/vec3.h"

namespace lodestone {

struct FractalNoise {
  std::uint32_t seed = 1;
  int octaves = 8;       // at least 1; each of twice the frequency of the one before
  double frequency = 1;  // of the first, in periods per unit
  double gain = 0.5;     // amplitude of an octave over that of the one before
};

// The sum of the octaves at p, the first of amplitude about 1. Smooth up to the second derivative.
[[nodiscard]] double fractal_noise(const FractalNoise& noise, Vec3d p);
[[nodiscard]] double fractal_noise(const FractalNoise& noise, double x, double y);  // cheaper by half: in the plane

}  // namespace lodestone
