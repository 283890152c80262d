// Stage 4, a lane per pixel: colours of what the visibility buffer holds. Attributes are read here and nowhere before,
// for what is seen alone.
//
// A *surface* is what the pixels of a group see: a triangle each and where on it, as weights of its corners. Stages
// that need more than the weights fetch it themselves; what a frame does not call for is left out when the loop is
// instantiated.
#pragma once

#include <cstddef>

#include "core/base/prefetch.h"
#include "render/backends/soft/clipped_weights.h"
#include "render/backends/soft/kernels.h"
#include "render/backends/soft/lanes.h"
#include "render/renderer.h"
#include "render/shading.h"

namespace lodestone::soft::LODESTONE_LANES {

struct Surface {
  const DrawnCell* cell[width];
  const std::uint32_t* v[width];  // VertexIds
  Float weight[3];                // perspective-correct, sum 1
  bool morphing;                  // any of the cells
};

// Weights at (x, y), in subpixels, on the records of a group. Linear on the surface is linear in the window after
// division by w: shares over w, in proportion. The share of a corner is the edge function of the opposite edge, exact
// in double; their common factor does not matter.
template <class RecordOf>
[[gnu::always_inline]] inline void find_weights(const ResolveJob& job, const RecordOf& record, Int x, Int y,
                                                Surface& s) {
  static_assert(offsetof(TriangleRecord, z) == 24 && offsetof(TriangleRecord, inverse_w) == 36);
  const auto quads = [&](int number) {
    return load_quads([&](int k) { return reinterpret_cast<const float*>(&record(k)) + 4 * number; });
  };
  const Quads ab = quads(0), cz = quads(1), zw = quads(2);
  const auto cross = [](Double ax, Double ay, Double bx, Double by) { return to_float(ax * by - ay * bx); };
  const auto from_point = [](Float p, Int q) { return to_double(as_int(p) - q); };
  const Double ax = from_point(ab.a, x), ay = from_point(ab.b, y), bx = from_point(ab.c, x), by = from_point(ab.d, y),
               cx = from_point(cz.a, x), cy = from_point(cz.b, y);
  const Float wa = cross(bx, by, cx, cy) * zw.b, wb = cross(cx, cy, ax, ay) * zw.c, wc = cross(ax, ay, bx, by) * zw.d;
  const Float scale = 1.0f / ((wa + wb) + wc);
  s.weight[0] = scale * wa, s.weight[1] = scale * wb, s.weight[2] = scale * wc;
  for (unsigned clipped = bits(zw.b == 0.0f); clipped != 0; clipped &= clipped - 1) {
    const int k = std::countr_zero(clipped);
    const std::array<float, 3> w = clipped_weights(*job.frame, *s.cell[k], record(k).v, *job.viewport, {x[k], y[k]});
    for (std::size_t i = 0; i < 3; ++i) s.weight[i][k] = w[i];
  }
}

// What the references stand for at (x, y), in subpixels. Fragments know where they are.
[[gnu::always_inline]] inline Surface find_surface(const ResolveJob& job, const TileSources& sources, Int group, Int x,
                                                   Int y) {
  static_assert(offsetof(Fragment, weight_b) == 24 && sizeof(Fragment) == 32);
  Surface s;
  const Fragment* fragment[width]{};
  const TriangleRecord* record[width]{};
  const Fragment* any_fragment = nullptr;
  const TriangleRecord* any_record = nullptr;
  const Int is_record = group < 0;
  std::uint32_t references[width];
  store(references, group);
  bool morphing = false;
  for (int k = 0; k < width; ++k) {
    TriangleNumber number;
    if (Reference::is_record(references[k])) {
      any_record = record[k] = &sources.record(references[k]);
      number = record[k]->triangle;
      s.v[k] = record[k]->v.data();
    } else {
      any_fragment = fragment[k] = &sources.fragment(references[k]);
      number = fragment[k]->triangle;
      s.v[k] = fragment[k]->v.data();
    }
    s.cell[k] = &job.drawn->cell_of(number);
    morphing |= s.cell[k]->morphing;
  }
  s.morphing = morphing;
  if (any_record) {
    const auto of = [&](int k) -> const TriangleRecord& {
      return Reference::is_record(references[k]) ? *record[k] : *any_record;
    };
    find_weights(job, of, x, y, s);
    if (!any_fragment) return s;
  }
  const Quads q = load_quads([&](int k) {
    const Fragment* f = Reference::is_record(references[k]) ? any_fragment : fragment[k];
    return reinterpret_cast<const float*>(f) + 4;
  });
  const Float a = (1.0f - q.c) - q.d;
  if (!any_record) {
    s.weight[0] = a, s.weight[1] = q.c, s.weight[2] = q.d;
  } else {
    s.weight[0] = select(is_record, s.weight[0], a);
    s.weight[1] = select(is_record, s.weight[1], q.c);
    s.weight[2] = select(is_record, s.weight[2], q.d);
  }
  return s;
}

// unpack_normal, lane by lane.
[[gnu::always_inline]] inline Points unpacked(Int packed) {
  const auto from_snorm16 = [](Int v) { return max(to_float(v) / 32767.0f, all(-1.0f)); };
  const auto with_sign = [](Float v, Float sign) { return select(sign < 0.0f, -v, v); };
  const Float u = from_snorm16((packed << 16) >> 16), v = from_snorm16(packed >> 16);
  const Float z = 1.0f - abs(u) - abs(v);
  const Int below = z < 0.0f;
  const Float x = select(below, with_sign(1.0f - abs(v), u), u), y = select(below, with_sign(1.0f - abs(u), v), v);
  const Float scale = 1.0f / sqrt(x * x + y * y + z * z);
  return {scale * x, scale * y, scale * z};
}

// Normals of corner i, morphed as morph_vertex does.
[[gnu::always_inline]] inline Points corner_normals(const Surface& s, std::size_t i) {
  const auto packed = [](const PackedNormal& n) { return std::bit_cast<std::int32_t>(n); };
  const Int own = gathered([&](int k) { return packed(s.cell[k]->normals[s.v[k][i]]); });
  const Points n = unpacked(own);
  if (!s.morphing) return n;
  const auto coarser = [&](int k) {
    const DrawnCell& cell = *s.cell[k];
    return packed(cell.morphing ? cell.coarser_normals[cell.parents[s.v[k][i]]] : cell.normals[s.v[k][i]]);
  };
  const auto lambda = [&](int k) {
    return std::bit_cast<std::int32_t>(s.cell[k]->morphing ? s.cell[k]->lambdas[s.v[k][i]] : 1.0f);
  };
  const Float l = as_float(gathered(lambda)), rest = 1.0f - l;
  const Int is_own = l >= 1.0f;
  if (bits(is_own) == all_lanes) return n;
  const Points m = unpacked(gathered(coarser));
  const Float x = l * n.x + rest * m.x, y = l * n.y + rest * m.y, z = l * n.z + rest * m.z;
  const Float norm2 = x * x + y * y + z * z;
  const Float scale = 1.0f / sqrt(norm2);
  const Int is_coarser = ~is_own & ((l <= 0.0f) | ~(norm2 > 1e-12f));
  const auto pick = [&](Float a, Float b, Float sum) { return select(is_own, a, select(is_coarser, b, scale * sum)); };
  return {pick(n.x, m.x, x), pick(n.y, m.y, y), pick(n.z, m.z, z)};
}

[[gnu::always_inline]] inline Points interpolated_normals(const Surface& s) {
  const Points a = corner_normals(s, 0), b = corner_normals(s, 1), c = corner_normals(s, 2);
  const auto mix = [&](Float p, Float q, Float r) { return (s.weight[0] * p + s.weight[1] * q) + s.weight[2] * r; };
  return {mix(a.x, b.x, c.x), mix(a.y, b.y, c.y), mix(a.z, b.z, c.z)};
}

// render/shading.h.
inline Float brightness(const Points& n, Vec3f light) {
  const Float norm2 = n.x * n.x + n.y * n.y + n.z * n.z;
  const Float cosine = abs(n.x * light.x + n.y * light.y + n.z * light.z) / sqrt(max(norm2, all(shading::least_norm2)));
  return shading::ambient + (1 - shading::ambient) * min(cosine, all(1.0f));
}

template <bool Tint>
inline Points albedo(const Surface& s) {
  if constexpr (!Tint) return {all(shading::albedo.x), all(shading::albedo.y), all(shading::albedo.z)};
  Points p{};
  for (int k = 0; k < width; ++k) {
    const Vec3f tint = shading::albedo_of(s.cell[k]->level, true);
    p.x[k] = tint.x, p.y[k] = tint.y, p.z[k] = tint.z;
  }
  return p;
}

// Colour of the surfaces, each channel in [0, 1].
template <bool Tint>
inline Points shade(const ResolveJob& job, const Surface& s) {
  const Float light = brightness(interpolated_normals(s), job.frame->light);
  const Points colour = albedo<Tint>(s);
  return {light * colour.x, light * colour.y, light * colour.z};
}

inline Int to_bytes(const Points& colour) {
  const auto byte = [](Float v) { return truncated(v * 255.0f + 0.5f); };
  static_assert(std::endian::native == std::endian::little);
  return byte(colour.x) | byte(colour.y) << 8 | byte(colour.z) << 16 | static_cast<std::int32_t>(0xff00'0000u);
}

inline Int background() { return all(std::bit_cast<std::int32_t>(shading::background)); }

template <int Samples, bool Tint>
struct GroupResolver {
  const ResolveJob& job;
  const TileBuffer<Samples>& tile;

  // Colours as bytes of `width` pixels from (x, y) of the tile.
  Int operator()(int x, int y) const {
    const std::size_t at = static_cast<std::size_t>(y * tile_size + x);
    const Int px = (iota() + (job.rect.x0 + x)) * subpixels + subpixels / 2,
              py = all((job.rect.y0 + y) * subpixels + subpixels / 2);
    if constexpr (Samples == 1) {
      const Int seen = load<Float>(&tile.depth[at]) < 1.0f;
      if (bits(seen) == 0) return background();
      const Points colour = shade<Tint>(job, surface(at, 0, seen, px, py));
      return select(seen, to_bytes(colour), background());
    } else {
      return averaged(at, px, py);
    }
  }

 private:
  // Of sample s, at (px, py). At least one lane is seen; the others repeat it.
  [[gnu::always_inline]] Surface surface(std::size_t at, std::size_t s, Int seen, Int px, Int py) const {
    const std::uint32_t* references = &tile.reference[s * tile_pixels + at];
    const auto any = static_cast<std::int32_t>(references[std::countr_zero(bits(seen))]);
    return find_surface(job, tile.sources, select(seen, load<Int>(references), all(any)), px, py);
  }

  // Every triangle of a pixel is shaded once, at the centre where it covers all samples and at its first one elsewhere,
  // so that nothing is read off outside a triangle; each sample counts for a quarter.
  Int averaged(std::size_t at, Int px, Int py) const {
    Int number[Samples], seen[Samples];
    Int background_samples = all(0);
    for (std::size_t s = 0; s < Samples; ++s) {
      seen[s] = load<Float>(&tile.depth[s * tile_pixels + at]) < 1.0f;
      background_samples -= ~seen[s];
      number[s] = numbers(at, s, bits(seen[s]));
    }
    if (bits(background_samples == Samples) == all_lanes) return background();
    constexpr float part = 1.0f / Samples;
    const auto& b = shading::background;
    const Float empty = to_float(background_samples) * part;
    const auto channel = [&](std::size_t k) { return empty * (static_cast<float>(b[k]) / 255); };
    Points sum{channel(0), channel(1), channel(2)};
    for (std::size_t s = 0; s < Samples; ++s) {
      Int first = seen[s], count = all(0);
      for (std::size_t r = 0; r < Samples; ++r) {
        const Int same = seen[r] & (number[r] == number[s]);
        if (r < s) first &= ~same;
        count -= same;
      }
      const unsigned covered = bits(first);
      if (covered == 0) continue;
      const Int whole = count == Samples;
      const SnappedPoint offset = sample_offsets<Samples>[s];
      Surface seen_here = surface(at, s, first, px + (~whole & offset.x), py + (~whole & offset.y));
      move_to_centre(at, bits(whole) & covered, seen_here);
      const Points colour = shade<Tint>(job, seen_here);
      const Float weight = to_float(count) * part;
      const auto add = [&](Float& to, Float what) { to = select(first, to + weight * what, to); };
      add(sum.x, colour.x), add(sum.y, colour.y), add(sum.z, colour.z);
    }
    return to_bytes(sum);
  }

  // Triangles of the lanes of `covered`.
  Int numbers(std::size_t at, std::size_t s, unsigned covered) const {
    std::int32_t number[width]{};
    for (; covered != 0; covered &= covered - 1) {
      const int k = std::countr_zero(covered);
      number[k] = static_cast<std::int32_t>(
          tile.sources.triangle(tile.reference[s * tile_pixels + at + static_cast<std::size_t>(k)]));
    }
    return load<Int>(number);
  }

  // A fragment knows its place on the triangle at its own sample alone; the mean over a whole pixel is its centre.
  void move_to_centre(std::size_t at, unsigned whole, Surface& s) const {
    for (; whole != 0; whole &= whole - 1) {
      const int k = std::countr_zero(whole);
      const std::uint32_t* reference = &tile.reference[at + static_cast<std::size_t>(k)];
      if (Reference::is_record(*reference)) continue;
      float b = 0, c = 0;
      for (std::size_t r = 0; r < Samples; ++r) {
        const Fragment& fragment = tile.sources.fragment(reference[r * tile_pixels]);
        b += fragment.weight_b, c += fragment.weight_c;
      }
      b *= 1.0f / Samples, c *= 1.0f / Samples;
      s.weight[0][k] = (1 - b) - c, s.weight[1][k] = b, s.weight[2][k] = c;
    }
  }
};

// Normals lie all over the memory; those of the next row are asked for while one is shaded.
template <int Samples>
inline void prefetch_row(const ResolveJob& job, const TileBuffer<Samples>& tile, std::size_t y, std::size_t columns) {
  for (std::size_t x = 0; x < columns; ++x) {
    const std::size_t at = y * tile_size + x;
    if (tile.depth[at] == 1 || Reference::is_record(tile.reference[at])) continue;
    const Fragment& fragment = tile.sources.fragment(tile.reference[at]);
    const DrawnCell& cell = job.drawn->cell_of(fragment.triangle);
    for (const std::uint32_t v : fragment.v) {
      prefetch(cell.normals + v);
      if (!cell.morphing) continue;
      prefetch(cell.parents + v);
      prefetch(cell.lambdas + v);
    }
  }
}

template <int Samples, bool Tint>
void resolve_tile(const ResolveJob& job, const TileBuffer<Samples>& tile) {
  const PixelRect& rect = job.rect;
  const GroupResolver<Samples, Tint> resolve{job, tile};
  const int columns = rect.x1 - rect.x0, rows = rect.y1 - rect.y0;
  for (int y = 0; y < rows; ++y) {
    if (y + 1 < rows) prefetch_row(job, tile, static_cast<std::size_t>(y + 1), static_cast<std::size_t>(columns));
    const std::size_t pixel = static_cast<std::size_t>(rect.y0 + y) * static_cast<std::size_t>(job.image->size.width) +
                              static_cast<std::size_t>(rect.x0);
    std::memcpy(&job.image->depth[pixel], &tile.depth[static_cast<std::size_t>(y) * tile_size],
                static_cast<std::size_t>(columns) * sizeof(float));
    for (int x = 0; x < columns; x += width) {
      std::int32_t bytes[width];
      store(bytes, resolve(x, y));
      const int count = std::min(width, columns - x);
      std::memcpy(&job.image->rgba[4 * (pixel + static_cast<std::size_t>(x))], bytes,
                  static_cast<std::size_t>(count) * 4);
    }
  }
}

template <int Samples>
void resolve(const ResolveJob& job, const TileBuffer<Samples>& tile) {
  if (job.frame->tint_by_level) return resolve_tile<Samples, true>(job, tile);
  resolve_tile<Samples, false>(job, tile);
}

}  // namespace lodestone::soft::LODESTONE_LANES
