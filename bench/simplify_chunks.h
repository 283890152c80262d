// Chunks of generated surfaces as a builder cuts them, and the error of what a simplifier makes of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <vector>

#include "core/mesh/generate.h"
#include "core/simplify/contract/simplifier.h"

namespace lodestone::bench {

struct Chunk {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> locked;  // used outside the chunk too
  double mean_edge = 0;

  [[nodiscard]] SimplifyInput input(double edges_of_displacement, double share) const {
    return {positions, triangles, locked, static_cast<float>(edges_of_displacement * mean_edge),
            static_cast<std::size_t>(share * static_cast<double>(triangles.size()))};
  }
};

inline double mean_edge(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const auto& [v] : triangles)
    for (int k = 0; k < 3; ++k) sum += length(to_double(positions[v[k]]) - to_double(positions[v[(k + 1) % 3]]));
  return sum / (3.0 * static_cast<double>(std::max<std::size_t>(triangles.size(), 1)));
}

// The `count` fullest cells of the coarsest grid whose `count` fullest cells hold at most `wanted` triangles each on
// average. Vertices are numbered by first use.
inline std::vector<Chunk> cut(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles,
                              std::size_t wanted, std::size_t count) {
  Vec3f lo = positions[0], hi = positions[0];
  for (const Vec3f& p : positions) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  const float extent = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
  std::vector<std::uint64_t> code(triangles.size());
  std::vector<std::pair<std::size_t, std::uint64_t>> fullest;
  for (std::uint64_t n = 1, most = triangles.size(); most > wanted * count; ++n) {
    std::unordered_map<std::uint64_t, std::size_t> filling;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto& v = triangles[t].v;
      const Vec3f centre = (1.0f / 3) * (positions[v[0]] + positions[v[1]] + positions[v[2]]) - lo;
      const auto axis = [&](float x) {
        return std::min<std::uint64_t>(static_cast<std::uint64_t>(x / extent * static_cast<float>(n)), n - 1);
      };
      code[t] = axis(centre.x) + n * (axis(centre.y) + n * axis(centre.z));
      ++filling[code[t]];
    }
    fullest.clear();
    for (const auto& [cell, filled] : filling) fullest.emplace_back(filled, cell);
    std::sort(fullest.rbegin(), fullest.rend());
    fullest.resize(std::min(count, fullest.size()));
    most = 0;
    for (const auto& [filled, cell] : fullest) most += filled;
  }
  constexpr std::uint64_t several = ~0ull, unused = several - 1;
  std::vector<std::uint64_t> owner(positions.size(), unused);
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cell;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    cell[code[t]].push_back(t);
    for (const std::uint32_t x : triangles[t].v)
      owner[x] = owner[x] == unused || owner[x] == code[t] ? code[t] : several;
  }
  std::vector<Chunk> chunks;
  for (const auto& entry : fullest) {
    Chunk c;
    std::unordered_map<std::uint32_t, std::uint32_t> local;
    for (const std::uint32_t t : cell[entry.second]) {
      Triangle mine;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t x = triangles[t].v[k];
        const auto [at, is_new] = local.try_emplace(x, static_cast<std::uint32_t>(c.positions.size()));
        if (is_new) c.positions.push_back(positions[x]), c.locked.push_back(owner[x] == several);
        mine.v[k] = at->second;
      }
      c.triangles.push_back(mine);
    }
    c.mean_edge = mean_edge(c.positions, c.triangles);
    chunks.push_back(std::move(c));
  }
  return chunks;
}

// The simplified chunk and its place; locks belong to their vertices.
inline Chunk applied(const Chunk& chunk, const SimplifyResult& result) {
  Chunk c;
  std::vector<std::uint32_t> local(result.parent.size(), ~0u);
  for (const auto& [v] : chunk.triangles) {
    const Triangle t{{result.parent[v[0]], result.parent[v[1]], result.parent[v[2]]}};
    if (is_degenerate(t)) continue;
    Triangle mine;
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& id = local[t.v[k]];
      if (id == ~0u) {
        id = static_cast<std::uint32_t>(c.positions.size());
        c.positions.push_back(result.positions[t.v[k]]);
        c.locked.push_back(chunk.locked[t.v[k]]);
      }
      mine.v[k] = id;
    }
    c.triangles.push_back(mine);
  }
  c.mean_edge = mean_edge(c.positions, c.triangles);
  return c;
}

// Squared distance of p from a triangle (Ericson 2005, section 5.1.5).
inline double squared_distance(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const auto from = [&](Vec3d q) { return dot(p - q, p - q); };
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return from(a);
  const Vec3d bp = p - b, cp = p - c;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d3 >= 0 && d4 <= d3) return from(b);
  if (d6 >= 0 && d5 <= d6) return from(c);
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return from(a + (d1 / (d1 - d3)) * ab);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return from(a + (d2 / (d2 - d6)) * ac);
  if (va <= 0 && d4 >= d3 && d5 >= d6) return from(b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
  const double scale = 1 / (va + vb + vc);
  return from(a + (vb * scale) * ab + (vc * scale) * ac);
}

// Closest points by a uniform grid of triangles, searched in growing shells.
class ClosestTriangle {
 public:
  ClosestTriangle(const std::vector<Vec3f>& positions, const std::vector<Triangle>& triangles, double cell)
      : positions_(positions), triangles_(triangles), cell_(cell) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      std::array<long, 3> lo{}, hi{};
      for (int k = 0; k < 3; ++k) {
        const std::array<long, 3> at = cell_of(to_double(positions[triangles[t].v[k]]));
        for (int a = 0; a < 3; ++a) lo[a] = k == 0 ? at[a] : std::min(lo[a], at[a]);
        for (int a = 0; a < 3; ++a) hi[a] = k == 0 ? at[a] : std::max(hi[a], at[a]);
      }
      for (long x = lo[0]; x <= hi[0]; ++x)
        for (long y = lo[1]; y <= hi[1]; ++y)
          for (long z = lo[2]; z <= hi[2]; ++z) cells_[key(x, y, z)].push_back(t);
    }
  }
  [[nodiscard]] double squared(Vec3d p) const {
    const auto [cx, cy, cz] = cell_of(p);
    double best = std::numeric_limits<double>::max();
    for (long r = 0; r < 64; ++r) {
      if (best <= static_cast<double>(r - 1) * cell_ * static_cast<double>(r - 1) * cell_ && r > 0) break;
      for (long x = -r; x <= r; ++x)
        for (long y = -r; y <= r; ++y)
          for (long z = -r; z <= r; ++z) {
            if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != r) continue;
            const auto found = cells_.find(key(cx + x, cy + y, cz + z));
            if (found == cells_.end()) continue;
            for (const std::uint32_t t : found->second) {
              const auto& v = triangles_[t].v;
              best = std::min(best, squared_distance(p, to_double(positions_[v[0]]), to_double(positions_[v[1]]),
                                                     to_double(positions_[v[2]])));
            }
          }
    }
    return best;
  }

 private:
  [[nodiscard]] std::array<long, 3> cell_of(Vec3d p) const {
    return {static_cast<long>(std::floor(p.x / cell_)), static_cast<long>(std::floor(p.y / cell_)),
            static_cast<long>(std::floor(p.z / cell_))};
  }
  static std::uint64_t key(long x, long y, long z) {
    return static_cast<std::uint64_t>((x & 0x1fffff) | (y & 0x1fffff) << 21 | (z & 0x1fffff) << 42);
  }
  const std::vector<Vec3f>& positions_;
  const std::vector<Triangle>& triangles_;
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

struct ChunkError {
  double rms = 0, max = 0;  // both directions together, in mean edges of the chunk
};

// From vertices and barycentres of each mesh to the other one, every `stride`-th.
inline ChunkError error_of(const Chunk& before, const Chunk& after, std::size_t stride = 4) {
  double worst = 0;
  const auto mean_square = [&](const Chunk& from, const Chunk& to, std::size_t step) {
    const ClosestTriangle closest(to.positions, to.triangles, 2 * to.mean_edge);
    double sum = 0;
    std::size_t n = 0;
    const auto add = [&](Vec3d p) {
      const double d = closest.squared(p);
      sum += d, worst = std::max(worst, d), ++n;
    };
    for (std::size_t v = 0; v < from.positions.size(); v += step) add(to_double(from.positions[v]));
    for (std::size_t t = 0; t < from.triangles.size(); t += step) {
      const auto& v = from.triangles[t].v;
      add((1.0 / 3) *
          (to_double(from.positions[v[0]]) + to_double(from.positions[v[1]]) + to_double(from.positions[v[2]])));
    }
    return sum / static_cast<double>(std::max<std::size_t>(n, 1));
  };
  if (after.triangles.empty()) return {};
  const double both = (mean_square(before, after, stride) + mean_square(after, before, 1)) / 2;
  return {std::sqrt(both) / before.mean_edge, std::sqrt(worst) / before.mean_edge};
}

}  // namespace lodestone::bench
