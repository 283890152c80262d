// Stage 1, a lane per vertex: morph (render/lod/morph.h, the same bits), transform, snap.
#pragma once

#include <type_traits>

#include "render/backends/soft/kernels.h"
#include "render/lod/blend.h"
#include "render/lod/limits.h"
#include "render/surface/lanes.h"

namespace lodestone::soft::LODESTONE_LANES {

template <DistanceMetric Metric>
inline Float norms(Float x, Float y, Float z) {
  if constexpr (Metric == DistanceMetric::chebyshev) return max(max(x, y), z);
  return sqrt((x * x + y * y) + z * z);
}

// limited_distance of render/lod/limits.h.
template <DistanceMetric Metric>
inline Float distances(const VertexJob& job, const Points& p) {
  const Vec3f from = job.viewpoint;
  Float d = norms<Metric>(abs(p.x - from.x), abs(p.y - from.y), abs(p.z - from.z));
  for (const DetailLimit& limit : job.limits) {
    const auto outside = [](float lo, float hi, Float v) { return max(max(lo - v, v - hi), all(0.0f)); };
    const Box3f& box = limit.box;
    d = max(d, limit.radius - norms<Metric>(outside(box.lo.x, box.hi.x, p.x), outside(box.lo.y, box.hi.y, p.y),
                                            outside(box.lo.z, box.hi.z, p.z)));
  }
  return d;
}

inline Float smoothstep(Float t) { return t * t * (3.0f - 2.0f * t); }

// blend_share of render/lod/blend.cpp where t lies between 0 and 1.
template <Blend B>
inline Float inner_share(Float t) {
  if constexpr (B == Blend::linear) {
    return t;
  } else if constexpr (B == Blend::smoothstep) {
    return smoothstep(t);
  } else if constexpr (B == Blend::smootherstep) {
    const auto lower = [](Float u) { return u * u * u * (u * (u * 6.0f - 15.0f) + 10.0f); };
    return select(t <= 0.5f, lower(t), 1.0f - lower(1.0f - t));
  } else if constexpr (B == Blend::early) {
    return smoothstep(min(2.0f * t, all(1.0f)));
  } else if constexpr (B == Blend::late) {
    return smoothstep(max(2.0f * t - 1.0f, all(0.0f)));
  } else {
    static_assert(B == Blend::step);
    return select(t < 0.5f, all(0.0f), all(1.0f));
  }
}

// The library's cosine, and curves of a user's own.
inline Float each_share(Blend blend, Float t) {
  for (int k = 0; k < width; ++k) t[k] = blend_share(blend, t[k]);
  return t;
}
inline constexpr Blend one_by_one = Blend::cosine;

// How the vertices of a cell move: not at all, by a lambda that is known, or by one that follows from distances.
struct Still {};
struct Given {};
template <DistanceMetric Metric, Blend B>
struct Morph {};

template <DistanceMetric Metric, Blend B>
inline Float lambda_of(const VertexJob& job, const Points& w, Morph<Metric, B>) {
  const float begin = job.band_begin, end = job.band_end;
  const Float d = distances<Metric>(job, w);
  const Int own = begin < end ? d <= begin : d < begin;
  const Int parents = ~own & (d >= end);
  const Float ends = select(own, all(1.0f), all(0.0f));
  if (bits(own | parents) == all_lanes) return ends;
  const Float t = (d - begin) / (end - begin);
  Float share;
  if constexpr (B == one_by_one)
    share = each_share(job.blend, t);
  else
    share = inner_share<B>(t);
  share = min(max(share, all(0.0f)), all(1.0f));
  share = select(t > 0.0f, select(t >= 1.0f, all(1.0f), share), all(0.0f));
  return select(own | parents, ends, 1.0f - share);
}

// The parents' places of vertices first, first + 1, ...
inline Points parent_points(const Vec3f* coarser, const Indices& parents, std::size_t first) {
  Vec3f p[width];
  for (std::size_t k = 0; k < width; ++k) p[k] = coarser[parents[first + k]];
  return load_points(p);
}

inline Points morphed(Float lambda, const Points& w, const Vec3f* coarser, const Indices& parents, std::size_t first) {
  const Int own = lambda >= 1.0f, parent = lambda <= 0.0f;
  if (bits(own) == all_lanes) return w;
  const Points p = parent_points(coarser, parents, first);
  const Float rest = 1.0f - lambda;
  const auto mix = [&](Float a, Float b) { return select(own, a, select(parent, b, lambda * a + rest * b)); };
  return {mix(w.x, p.x), mix(w.y, p.y), mix(w.z, p.z)};
}

// Clip space to the window; see WindowVertex for those that need clipping.
inline Vertices snapped(const VertexJob& job, const Points& p) {
  const auto& m = job.view_projection->m;
  const auto row = [&](int r) { return ((m[4 * r] * p.x + m[4 * r + 1] * p.y) + m[4 * r + 2] * p.z) + m[4 * r + 3]; };
  const Float x = row(0), y = row(1), z = row(2), w = row(3);
  const Viewport& v = *job.viewport;
  const Int inside = (z >= -w) & (z <= w) & (abs(x) <= v.guard_x() * w) & (abs(y) <= v.guard_y() * w) & (w > 0.0f);
  const Float inverse_w = 1.0f / w;
  Vertices out{rounded((1.0f + x * inverse_w) * v.half_width()), rounded((1.0f - y * inverse_w) * v.half_height()),
               max(0.5f + 0.5f * (z * inverse_w), all(0.0f)), inverse_w};
  if (bits(inside) == all_lanes) return out;
  const auto flag = [](Int mask, std::uint32_t bit) { return mask & static_cast<std::int32_t>(bit); };
  const Int outcode = flag(x < -w, Outside::left) | flag(x > w, Outside::right) | flag(y < -w, Outside::bottom) |
                      flag(y > w, Outside::top) | flag(z < -w, Outside::near) | flag(z > w, Outside::far);
  out.x = select(inside, out.x, outcode);
  out.y = select(inside, out.y, all(0));
  out.z = select(inside, out.z, all(0.0f));
  out.inverse_w = select(inside, out.inverse_w, all(0.0f));
  return out;
}

// Arrays of `width` vertices, all of them readable and writable; a cell that does not move has no parents and lambdas.
struct Lanes {
  const Vec3f* positions;
  Indices parents;
  std::size_t first;  // of the parents
  WindowVertex* out;
  float* lambdas;
};

template <class Motion>
inline void transform_lanes(const VertexJob& job, const Lanes& at, Motion motion) {
  Points p = load_points(at.positions);
  if constexpr (!std::is_same_v<Motion, Still>) {
    Float lambda;
    if constexpr (std::is_same_v<Motion, Given>) {
      lambda = load<Float>(at.lambdas);
    } else {
      lambda = lambda_of(job, p, motion);
      store(at.lambdas, lambda);
    }
    p = morphed(lambda, p, job.coarser, at.parents, at.first);
  }
  store_vertices(reinterpret_cast<float*>(at.out), snapped(job, p));
}

template <class Motion>
void transform_all(const VertexJob& job, Motion motion) {
  constexpr bool moves = !std::is_same_v<Motion, Still>;
  const std::size_t n = job.positions.size();
  std::size_t i = 0;
  for (; i + width <= n; i += width)
    transform_lanes(job, {&job.positions[i], job.parents, i, job.out + i, moves ? job.lambdas + i : nullptr}, motion);
  if (i == n) return;
  // The remaining vertices are padded with copies of the last one.
  Vec3f w[width];
  std::uint32_t parents[width];
  WindowVertex out[width];
  float lambdas[width];
  for (std::size_t k = 0; k < width; ++k) {
    const std::size_t from = i + k < n ? i + k : n - 1;
    w[k] = job.positions[from];
    parents[k] = moves ? job.parents[from] : 0;
    lambdas[k] = moves && job.has_lambdas ? job.lambdas[from] : 0;
  }
  transform_lanes(job, {w, std::span<const std::uint32_t>(parents), 0, out, lambdas}, motion);
  for (std::size_t k = i; k < n; ++k) {
    job.out[k] = out[k - i];
    if (moves) job.lambdas[k] = lambdas[k - i];
  }
}

template <DistanceMetric Metric>
void transform_morphing(const VertexJob& job) {
  switch (job.blend) {
    case Blend::linear:
      return transform_all(job, Morph<Metric, Blend::linear>{});
    case Blend::smoothstep:
      return transform_all(job, Morph<Metric, Blend::smoothstep>{});
    case Blend::smootherstep:
      return transform_all(job, Morph<Metric, Blend::smootherstep>{});
    case Blend::early:
      return transform_all(job, Morph<Metric, Blend::early>{});
    case Blend::late:
      return transform_all(job, Morph<Metric, Blend::late>{});
    case Blend::step:
      return transform_all(job, Morph<Metric, Blend::step>{});
    default:
      return transform_all(job, Morph<Metric, one_by_one>{});
  }
}

inline void transform_cell(const VertexJob& job) {
  if (!job.coarser) return transform_all(job, Still{});
  if (job.has_lambdas) return transform_all(job, Given{});
  if (job.metric == DistanceMetric::chebyshev) return transform_morphing<DistanceMetric::chebyshev>(job);
  transform_morphing<DistanceMetric::euclidean>(job);
}

}  // namespace lodestone::soft::LODESTONE_LANES
