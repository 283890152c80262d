// Damped Newton steps on the sphere, four vertices at a time.
#pragma once

#include "core/spherical/parameterize/orientation.h"
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
    std::uint32_t faces = 0;
    for (const SweepGroup& group : block.groups) faces = std::max(faces, group.faces);
    corners_.resize(faces + 1);
  }

  void run() {
    neighbours_ = block_.neighbours.data();
    constants_ = block_.constants.data();
    for (const SweepGroup& group : block_.groups) {
      move(group);
      neighbours_ += 4 * (group.faces + 1), constants_ += 16 * group.faces;
    }
  }

 private:
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

  [[nodiscard]] FaceConstants constants(std::uint32_t face) const {
    const double* from = constants_ + 16 * face;
    return {load4(from), load4(from + 4), load4(from + 8), load4(from + 12)};
  }

  void move(const SweepGroup& group) {
    const Frame frame = frame_at(gather(state_.directions.data(), group.vertex));
    const Model at = model(group, frame);
    Step step = cut(group, newton(at));
    unsigned pending = (1u << group.count) - 1;
    for (int trials = 0; trials < most_trials && pending != 0; ++trials) {
      const Vec4x3 q = on_sphere(frame.p + (step.s1 * frame.e1 + step.s2 * frame.e2));
      const Trial there = trial(group, q);
      const unsigned lower = bits(there.energy < at.energy) & pending;
      pending &= ~accept(group, q, lower, there.uncertain);
      step = {all4d(0.5) * step.s1, all4d(0.5) * step.s2};
    }
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
  [[nodiscard, gnu::always_inline]] Model model(const SweepGroup& group, const Frame& frame) {
    const Double4 zero = all4d(0), half = all4d(0.5), two = all4d(2), three = all4d(3), six = all4d(6);
    Model m{zero, zero, zero, zero, zero, zero};
    Double4 radial = zero, a1, a2, a_squared;
    const auto place = [&](std::uint32_t k, Double4& x, Double4& y, Double4& squared) {
      const Vec4x3 at = gather(state_.directions.data(), neighbours_ + 4 * k), to = at - frame.p;
      corners_[k].neighbour = at;
      x = dot(to, frame.e1), y = dot(to, frame.e2), squared = dot(to, to);
    };
    place(0, a1, a2, a_squared);
    for (std::uint32_t k = 0; k < group.faces; ++k) {
      Double4 b1, b2, b_squared;
      place(k + 1, b1, b2, b_squared);
      const FaceConstants c = constants(k);
      const Double4 across1 = b1 - a1, across2 = b2 - a2, down = half * (b_squared - a_squared);
      const Double4 spokes = c.first * b_squared + c.second * a_squared;
      const Double4 n = c.vertex * (across1 * across1 + across2 * across2 + down * down) + spokes;
      const Double4 inverse = all4d(1) / (a1 * b2 - a2 * b1), squared = inverse * inverse;
      const Double4 stretch = n * squared, guard_n = guard_ * c.guard * n, guard_n2 = guard_n * n;
      m.energy = m.energy + (stretch + guard_n2 * n);
      // Derivatives of N and, relative to D, of D; then of the energy by N and by the logarithm of D.
      const Double4 n1 = zero - two * (c.first * b1 + c.second * a1), n2 = zero - two * (c.first * b2 + c.second * a2);
      const Double4 d1 = inverse * (half * (a_squared * b2 - b_squared * a2) - across2);
      const Double4 d2 = inverse * (half * (b_squared * a1 - a_squared * b1) + across1);
      corners_[k].rate1 = d1, corners_[k].rate2 = d2;
      const Double4 by_n = squared + three * guard_n2, by_d = zero - two * stretch;
      m.g1 = m.g1 + (by_n * n1 + by_d * d1);
      m.g2 = m.g2 + (by_n * n2 + by_d * d2);
      const Double4 by_nn = six * guard_n, by_nd = zero - two * squared, by_dd = six * stretch;
      const Double4 u1 = by_nn * n1 + by_nd * d1, u2 = by_nn * n2 + by_nd * d2;
      const Double4 w1 = by_nd * n1 + by_dd * d1, w2 = by_nd * n2 + by_dd * d2;
      m.h11 = m.h11 + (u1 * n1 + w1 * d1);
      m.h12 = m.h12 + (u1 * n2 + w1 * d2);
      m.h22 = m.h22 + (u2 * n2 + w2 * d2);
      // The second derivative of N, less the derivative along p: the sphere curves away from its tangent plane.
      radial = radial + (by_n * (two * (c.first + c.second) - spokes) + two * stretch);
      a1 = b1, a2 = b2, a_squared = b_squared;
    }
    m.h11 = m.h11 + radial, m.h22 = m.h22 + radial;
    return m;
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
  [[nodiscard, gnu::always_inline]] Step cut(const SweepGroup& group, const Step& step) const {
    Double4 steepest = all4d(barrier_share);
    for (std::uint32_t k = 0; k < group.faces; ++k)
      steepest = max(steepest, all4d(0) - (step.s1 * corners_[k].rate1 + step.s2 * corners_[k].rate2));
    const Double4 size = sqrt(step.s1 * step.s1 + step.s2 * step.s2);
    const Double4 scale = min(all4d(barrier_share) / steepest, all4d(longest_step) / max(size, all4d(longest_step)));
    return {scale * step.s1, scale * step.s2};
  }

  // The energy with the vertices at q.
  [[nodiscard, gnu::always_inline]] Trial trial(const SweepGroup& group, const Vec4x3& q) const {
    // A difference, a product, their difference, another product and two sums: seven roundings. The magnitudes of the
    // terms add up to at most sqrt(3) |a| |b| <= a^2 + b^2.
    const Double4 bound = all4d(8 * 0x1p-53), zero = all4d(0);
    Mask4 uncertain = zero < zero;
    Vec4x3 a = corners_[0].neighbour - q;
    Double4 a_squared = dot(a, a), energy = zero;
    for (std::uint32_t k = 0; k < group.faces; ++k) {
      const Vec4x3 b = corners_[k + 1].neighbour - q, across = b - a;
      const FaceConstants c = constants(k);
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
  std::vector<Corner> corners_;
  const Id* neighbours_ = nullptr;
  const double* constants_ = nullptr;
};

inline constexpr SphereKernel sweep_functions{
    .build = build_block,
    .sweep = [](const SphereState& state, const SweepBlock& block) { Sweep(state, block).run(); }};

}  // namespace LODESTONE_LANES
}  // namespace lodestone::spherical
