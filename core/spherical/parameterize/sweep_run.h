// Damped Newton steps on the sphere, four vertices at a time.
#pragma once

#include <algorithm>
#include <memory>

#include "core/base/prefetch.h"
#include "core/math/orientation.h"
#include "core/spherical/parameterize/sweep_build.h"

namespace lodestone::spherical {
inline namespace LODESTONE_LANES {

inline constexpr double over_relaxation = 1.75;  // of Newton's step, since the neighbours will follow
inline constexpr double barrier_share = 0.7;     // of the way to where a triangle turns over
inline constexpr double longest_step = 0.5;      // as a tangent
inline constexpr int most_trials = 4;            // each half as long as the one before

class Sweep {
 public:
  Sweep(const SphereState& state, const SweepBlock& block) : state_(state), block_(block), guard_(all4d(state.guard)) {
    // As many as the largest batch needs, without a value: a hub of 100,000 faces has 16 MB of them in every sweep.
    std::size_t most = 0;
    for (std::size_t begin = 0; begin < block.groups.size(); begin += batch) {
      std::size_t corners = 0;
      for (std::size_t k = begin; k < std::min(begin + batch, block.groups.size()); ++k)
        corners += block.groups[k].faces + 1;
      most = std::max(most, corners);
    }
    corners_ = std::make_unique_for_overwrite<Corner[]>(most);
  }

  void run() {
    Moving moving[batch];
    const Id* neighbours = block_.neighbours.data();
    const Id* const end = neighbours + block_.neighbours.size();
    const double* constants = block_.constants.data();
    for (std::size_t begin = 0; begin < block_.groups.size(); begin += batch) {
      const std::size_t count = std::min(batch, block_.groups.size() - begin);
      Corner* corners = corners_.get();
      for (std::size_t k = 0; k < count; ++k) {
        const SweepGroup& group = block_.groups[begin + k];
        const std::uint32_t ids = 4 * (group.faces + 1);
        moving[k].group = &group;
        moving[k].neighbours = neighbours, moving[k].constants = constants, moving[k].corners = corners;
        if (neighbours + (batch + 1) * ids <= end)
          for (const Id* id = neighbours + batch * ids; id != neighbours + (batch + 1) * ids; ++id)
            prefetch(&state_.directions[*id]);
        neighbours += ids, constants += 16 * group.faces, corners += group.faces + 1;
      }
      move({moving, count});
    }
  }

 private:
  // Groups that go through each stage one after the other, so that the processor overlaps what waits for divisions.
  static constexpr std::size_t batch = 4;

  struct Corner {
    Vec4x3 neighbour;
    Double4 rate1, rate2;  // of the determinant of the face after it, relative to it, as the vertex moves
  };
  struct Frame {  // right-handed, with the vertex last
    Vec4x3 e1, e2, p;
  };
  struct Model {  // of the energy in the tangent plane
    Double4 energy, g1, g2, h11, h12, h22;
  };
  struct Step {
    Double4 s1, s2;
  };
  struct Trial {
    Double4 energy;
    unsigned uncertain;  // lanes where rounding may hide a face that is turned over
  };
  struct Moving {
    const SweepGroup* group;
    const Id* neighbours;
    const double* constants;
    Corner* corners;
    Frame frame;
    Model model;
    Step step;
    Vec4x3 to;
    unsigned pending;  // lanes that have not moved
  };

  [[nodiscard]] static FaceConstants constants(const Moving& m, std::uint32_t face) {
    const double* from = m.constants + 16 * face;
    return {load4(from), load4(from + 4), load4(from + 8), load4(from + 12)};
  }

  void move(std::span<Moving> batch_of) {
    for (Moving& m : batch_of) {
      m.frame = frame_at(gather(state_.directions.data(), m.group->vertex));
      m.model = model(m);
    }
    for (Moving& m : batch_of) {
      m.step = cut(m, newton(m.model));
      m.to = stepped(m);
      m.pending = (1u << m.group->count) - 1;
    }
    for (Moving& m : batch_of) try_step(m);
    for (Moving& m : batch_of)
      for (int trials = 1; trials < most_trials && m.pending != 0; ++trials) {
        m.step = {all4d(0.5) * m.step.s1, all4d(0.5) * m.step.s2};
        m.to = stepped(m);
        try_step(m);
      }
  }

  [[nodiscard, gnu::always_inline]] static Vec4x3 stepped(const Moving& m) {
    return on_sphere(m.frame.p + (m.step.s1 * m.frame.e1 + m.step.s2 * m.frame.e2));
  }

  void try_step(Moving& m) {
    const Trial there = trial(m);
    const unsigned lower = bits(Mask4(there.energy < m.model.energy)) & m.pending;
    m.pending &= ~accept(*m.group, m.to, lower, there.uncertain);
  }

  // duff2017: no branch, and no place on the sphere where it breaks down.
  [[nodiscard, gnu::always_inline]] static Frame frame_at(const Vec4x3& p) {
    const Double4 one = all4d(1), zero = all4d(0), sign = copysign(one, p.z);
    const Double4 a = zero - one / (sign + p.z), b = p.x * p.y * a;
    return {{one + sign * p.x * p.x * a, sign * b, zero - sign * p.x}, {b, sign + p.y * p.y * a, zero - p.y}, p};
  }

  [[nodiscard, gnu::always_inline]] static Vec4x3 on_sphere(const Vec4x3& q) {
    const Double4 scale = all4d(1) / sqrt(dot(q, q)), shift = all4d(1.5);  // as snapped()
    return {(scale * q.x + shift) - shift, (scale * q.y + shift) - shift, (scale * q.z + shift) - shift};
  }

  // Neighbours are taken relative to the vertex, in its frame, where the determinant is that of two vectors in the
  // plane; their third coordinates are half of their squared lengths, below it.
  //
  // With n = -grad N / 2 N and d = grad D / D, S = N / D^2 and the guard G, which goes with N^3, have the gradients
  // -2 S (n + d) and -6 G n, and S + G has the second derivatives 6 S r r + (24 G - 8/3 S) n n for r = d + 2/3 n, and
  // (S + 3 G) times those of N over N.
  [[nodiscard, gnu::always_inline]] Model model(const Moving& moving) const {
    const Double4 zero = all4d(0), half = all4d(0.5), least = all4d(1e-250);
    const Frame& frame = moving.frame;
    Double4 energy = zero, radial = zero, n_sum1 = zero, n_sum2 = zero, r_sum1 = zero, r_sum2 = zero;
    Double4 h11 = zero, h12 = zero, h22 = zero, a1, a2, a_squared;
    const auto place = [&](std::uint32_t k, Double4& x, Double4& y, Double4& squared) {
      const Vec4x3 at = gather(state_.directions.data(), moving.neighbours + 4 * k), to = at - frame.p;
      moving.corners[k].neighbour = at;
      x = dot(to, frame.e1), y = dot(to, frame.e2), squared = dot(to, to);
    };
    place(0, a1, a2, a_squared);
    const std::uint32_t faces = moving.group->faces;
    for (std::uint32_t k = 0; k < faces; ++k) {
      Double4 b1, b2, b_squared;
      place(k + 1, b1, b2, b_squared);
      const FaceConstants c = constants(moving, k);
      const Double4 across1 = b1 - a1, across2 = b2 - a2, down = half * (b_squared - a_squared);
      const Double4 spokes = c.first * b_squared + c.second * a_squared;
      const Double4 n = c.vertex * (across1 * across1 + across2 * across2 + down * down) + spokes;
      // One division for two; faces of weight zero have N = 0.
      const Double4 det = a1 * b2 - a2 * b1, divisor = max(n, least), both = all4d(1) / (divisor * det);
      const Double4 by_det = divisor * both, by_n = det * both;
      const Double4 stretch = n * (by_det * by_det), guard = guard_ * c.guard * n * (n * n);
      energy = energy + (stretch + guard);
      const Double4 n1 = by_n * (c.first * b1 + c.second * a1), n2 = by_n * (c.first * b2 + c.second * a2);
      const Double4 d1 = by_det * (half * (a_squared * b2 - b_squared * a2) - across2);
      const Double4 d2 = by_det * (half * (b_squared * a1 - a_squared * b1) + across1);
      moving.corners[k].rate1 = d1, moving.corners[k].rate2 = d2;
      const Double4 r1 = d1 + all4d(2.0 / 3) * n1, r2 = d2 + all4d(2.0 / 3) * n2;
      // The gradient is -1/3 of the sum of 6 S r, and the sum of -(2/3 S + 6 G) n.
      const Double4 weight = all4d(6) * stretch, weight_r1 = weight * r1, weight_r2 = weight * r2;
      r_sum1 = r_sum1 + weight_r1, r_sum2 = r_sum2 + weight_r2;
      const Double4 six_guard = all4d(6) * guard, by_n_sum = all4d(1.0 / 9) * weight + six_guard;
      n_sum1 = n_sum1 + by_n_sum * n1, n_sum2 = n_sum2 + by_n_sum * n2;
      const Double4 weight_n = all4d(4) * six_guard - all4d(4.0 / 9) * weight;
      const Double4 weight_n1 = weight_n * n1, weight_n2 = weight_n * n2;
      h11 = h11 + (weight_r1 * r1 + weight_n1 * n1);
      h12 = h12 + (weight_r1 * r2 + weight_n1 * n2);
      h22 = h22 + (weight_r2 * r2 + weight_n2 * n2);
      // The second derivative of N, less the derivative along p: the sphere curves away from its tangent plane.
      const Double4 curved = by_n * ((c.first + c.second) - half * spokes);
      radial = radial + ((all4d(1.0 / 3) * weight + six_guard) * curved + all4d(1.0 / 3) * weight);
      a1 = b1, a2 = b2, a_squared = b_squared;
    }
    const Double4 third = all4d(-1.0 / 3);
    return {energy, third * r_sum1 - n_sum1, third * r_sum2 - n_sum2, h11 + radial, h12, h22 + radial};
  }

  // Newton's step with both curvatures taken as positive.
  [[nodiscard, gnu::always_inline]] static Step newton(const Model& m) {
    const Double4 half = all4d(0.5), one = all4d(1), zero = all4d(0);
    const Double4 mean = half * (m.h11 + m.h22), difference = half * (m.h11 - m.h22);
    const Double4 radius = sqrt(difference * difference + m.h12 * m.h12);
    const Double4 least = all4d(1e-9) * (abs(mean) + radius) + all4d(1e-280);
    const Double4 f1 = one / max(abs(mean + radius), least), f2 = one / max(abs(mean - radius), least);
    // A multiple of the identity, and one of the part without a trace.
    const Double4 same = half * (f1 + f2);
    const Double4 part = select(zero < radius, half * (f1 - f2) / max(radius, all4d(1e-290)), zero);
    const Double4 i11 = same + part * difference, i22 = same - part * difference, i12 = part * m.h12;
    const Double4 back = all4d(-over_relaxation);
    return {back * (i11 * m.g1 + i12 * m.g2), back * (i12 * m.g1 + i22 * m.g2)};
  }

  // Keeps a step away from where the first face turns over, and short.
  [[nodiscard, gnu::always_inline]] static Step cut(const Moving& m, const Step& step) {
    Double4 steepest = all4d(-barrier_share);
    for (std::uint32_t k = 0; k < m.group->faces; ++k)
      steepest = min(steepest, step.s1 * m.corners[k].rate1 + step.s2 * m.corners[k].rate2);
    const Double4 size = sqrt(step.s1 * step.s1 + step.s2 * step.s2);
    const Double4 scale = min(all4d(-barrier_share) / steepest, all4d(longest_step) / max(size, all4d(longest_step)));
    return {scale * step.s1, scale * step.s2};
  }

  // The energy where the vertices are to go.
  [[nodiscard, gnu::always_inline]] Trial trial(const Moving& m) const {
    const Vec4x3& q = m.to;
    // A difference, a product, their difference, another product and two sums: seven roundings. The magnitudes of the
    // terms add up to at most sqrt(3) |a| |b| <= a^2 + b^2.
    const Double4 bound = all4d(8 * 0x1p-53), zero = all4d(0);
    Mask4 uncertain = zero < zero;
    Vec4x3 a = m.corners[0].neighbour - q;
    Double4 a_squared = dot(a, a), energy = zero;
    for (std::uint32_t k = 0; k < m.group->faces; ++k) {
      const Vec4x3 b = m.corners[k + 1].neighbour - q, across = b - a;
      const FaceConstants c = constants(m, k);
      const Double4 b_squared = dot(b, b), det = dot(q, cross(a, b)), inverse = all4d(1) / det;
      const Double4 n = c.vertex * dot(across, across) + (c.first * b_squared + c.second * a_squared);
      const Double4 root = n * inverse;
      energy = energy + (root * inverse + guard_ * c.guard * n * (n * n));
      uncertain = uncertain | ((det < bound * (a_squared + b_squared)) & (zero < c.guard));
      a = b, a_squared = b_squared;
    }
    return {energy, bits(uncertain)};
  }

  // Moves those of the lanes whose faces are all positively oriented there; returns them.
  unsigned accept(const SweepGroup& group, const Vec4x3& q, unsigned lanes, unsigned uncertain) const {
    double x[4], y[4], z[4];
    store(x, q.x), store(y, q.y), store(z, q.z);
    unsigned moved = 0;
    for (unsigned lane = 0; lane < 4; ++lane) {
      if ((lanes >> lane & 1) == 0) continue;
      const Vec3d to{x[lane], y[lane], z[lane]};
      if ((uncertain >> lane & 1) != 0 && !is_positive(group.vertex[lane], to)) continue;
      state_.directions[group.vertex[lane]] = to;
      moved |= 1u << lane;
    }
    return moved;
  }

  [[nodiscard, gnu::noinline]] bool is_positive(Id v, Vec3d to) const {
    const progressive::Ring& ring = state_.rings.ring(v);
    for (std::uint32_t k = 0; k < ring.size; ++k) {
      const Vec3d a = state_.directions[ring.ids[k]].point(), b = state_.directions[ring.ids[ring.next(k)]].point();
      if (orientation(to, a, b) <= 0) return false;
    }
    return true;
  }

  const SphereState& state_;
  const SweepBlock& block_;
  Double4 guard_;
  std::unique_ptr<Corner[]> corners_;
};

inline constexpr SphereKernel sweep_functions{
    .build = build_block,
    .sweep = [](const SphereState& state, const SweepBlock& block) { Sweep(state, block).run(); }};

}  // namespace LODESTONE_LANES
}  // namespace lodestone::spherical
