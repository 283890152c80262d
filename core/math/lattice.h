// The lattice that the vertices of a model may stand on: integer multiples of 2^-bits in normalised coordinates, one
// for the whole model and for all of its levels (docs/decisions/0008). Its points are exact in float32.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/math/vec3.h"

namespace lodestone {

struct Lattice {
  static constexpr int most_bits = 24;  // of the significand of a float
  static constexpr int automatic = -1;  // where a lattice is asked for: see choose_lattice

  int bits = 0;  // 0: no lattice, vertices stand anywhere

  [[nodiscard]] explicit constexpr operator bool() const { return bits != 0; }
  friend constexpr bool operator==(const Lattice&, const Lattice&) = default;

  // Points along an axis of the unit cube, less one: coordinates are integers from 0 to this.
  [[nodiscard]] constexpr std::uint32_t last() const { return 1u << bits; }
  [[nodiscard]] constexpr float step() const { return 1.0f / static_cast<float>(last()); }

  // Bound of the distance between a point of the unit cube and its nearest lattice point, half a diagonal, rounded up;
  // 0 without a lattice.
  [[nodiscard]] float error() const {
    constexpr float half_diagonal = 0.8660255f;  // above sqrt(3) / 2
    return bits == 0 ? 0 : std::nextafter(half_diagonal * step(), std::numeric_limits<float>::max());
  }

  // The nearest point of the lattice inside the unit cube. Always inlined: kernels compiled for one processor alone use
  // it, and their copy must not become everybody's.
  [[nodiscard, gnu::always_inline]] Vec3f nearest(Vec3d p) const { return {nearest(p.x), nearest(p.y), nearest(p.z)}; }
  [[nodiscard, gnu::always_inline]] float nearest(double v) const {
    const double scaled = v * last() + 0.5;
    const double inside = scaled >= 0 ? (scaled < last() ? scaled : last()) : 0;  // also for NaN
    return static_cast<float>(static_cast<std::int32_t>(inside)) * step();
  }

  // True if p is a point of the lattice; always, without one.
  [[nodiscard]] bool holds(Vec3f p) const { return bits == 0 || nearest(to_double(p)) == p; }
};

// The coarsest lattice, of 16 bits at least, whose step is at most 1/256 of the median edge and 1/16 of the edge that
// one in twenty is shorter than. Judged by a regular sample of the triangles, those with two equal ids or positions
// that are not finite left out; a mesh without any gets the finest lattice.
[[nodiscard]] Lattice choose_lattice(std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                                     double scale);

// The two halves of it: every how many triangles, from the first, one is looked at; and the choice by the lengths of
// the edges of those, over the scale.
[[nodiscard]] std::size_t lattice_sample_stride(std::size_t triangles);
[[nodiscard]] Lattice lattice_for(std::vector<double> edges);
// Appends the lengths of the edges of a triangle that count.
void append_edges(const Vec3d& a, const Vec3d& b, const Vec3d& c, double scale, std::vector<double>& edges);

}  // namespace lodestone
