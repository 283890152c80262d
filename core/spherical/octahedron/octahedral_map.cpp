// Based on praun2003 (the flat octahedron and its symmetry) and sander2001 (L2 stretch); the polynomial is our own.
#include "core/spherical/octahedron/octahedral_map.h"

namespace lodestone::spherical {
namespace {

// The derivatives of octahedral::a by its arguments, and of octahedral::b by its first.
double a_by_u(double u, double v) { return octahedral::a_u + (2 * octahedral::a_uu * u + octahedral::a_uv * v); }
double a_by_v(double u, double v) { return octahedral::a_v + (octahedral::a_uv * u + 2 * octahedral::a_vv * v); }
double b_by_u(double u, double v) { return octahedral::b_1 + (2 * octahedral::b_2 * u + octahedral::b_uv * v); }

// Five steps take any start, the fourth leaves 3e-13: doubling of digits does the rest.
constexpr int newton_steps = 5;

}  // namespace

SquarePoint square_point(Vec3d d, const Octant& octant) {
  const double whole = (std::abs(d.x) + std::abs(d.y)) + std::abs(d.z);
  const double share_x = std::abs(d.x) / whole, share_y = std::abs(d.y) / whole;
  double u = share_x, v = share_y;
  for (int step = 0; step < newton_steps; ++step) {
    // The components of `along` have the same shares of their sum as those of d. A zero share keeps its zero.
    const Vec3d q = octahedral::along(u, v);
    const double w = 1 - (u + v), b = octahedral::b(u, v);
    const double x_u = octahedral::a(u, v) + u * a_by_u(u, v), x_v = u * a_by_v(u, v);
    const double y_u = v * a_by_v(v, u), y_v = octahedral::a(v, u) + v * a_by_u(v, u);
    const double sum = (q.x + q.y) + q.z;
    const double sum_u = (x_u + y_u) + (w * b_by_u(u, v) - b), sum_v = (x_v + y_v) + (w * b_by_u(v, u) - b);
    const double f = q.x - share_x * sum, g = q.y - share_y * sum;
    const double f_u = x_u - share_x * sum_u, f_v = x_v - share_x * sum_v;
    const double g_u = y_u - share_y * sum_u, g_v = y_v - share_y * sum_v;
    const double scale = 1 / (f_u * g_v - f_v * g_u);
    const double step_u = (f * g_v - g * f_v) * scale, step_v = (g * f_u - f * g_u) * scale;
    u -= step_u, v -= step_v;
  }
  if (octant.z < 0) {
    const double reflected = 1 - v;
    v = 1 - u, u = reflected;
  }
  // From here on 1 - s is exact, which makes the other octants mirror images.
  const double s = 0.5 * (1 + u), t = 0.5 * (1 + v);
  return {octant.x < 0 ? 1 - s : s, octant.y < 0 ? t : 1 - t};
}

}  // namespace lodestone::spherical
