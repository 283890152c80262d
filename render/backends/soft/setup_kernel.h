// Stage 2, a lane per triangle: which triangles of a cell cover a sample at all, and which samples the small ones do.
//
// Where a surface is drawn at about a triangle a pixel, most triangles miss every sample. A first pass over the cell
// tests bounding boxes alone and lists what remains; a second one evaluates the edge functions of those of a few pixels
// for all samples of their boxes (pineda1988) and emits what they cover. Larger ones are left to the tiles.
#pragma once

#include "render/backends/soft/kernels.h"
#include "render/surface/lanes.h"

namespace lodestone::soft::LODESTONE_LANES {

struct Box {
  Int x0, y0, x1, y1;  // pixels, inclusive
  Int width, height;   // subpixels, of the triangle itself
};

// Pixels with a sample in the closed bounding box, inside the picture.
template <int Samples>
inline Box box_of(const Vertices& a, const Vertices& b, const Vertices& c, ImageSize size) {
  constexpr int first = subpixels / 2 - sample_reach<Samples>, last = subpixels / 2 + sample_reach<Samples>;
  const Int x_lo = min(min(a.x, b.x), c.x), x_hi = max(max(a.x, b.x), c.x);
  const Int y_lo = min(min(a.y, b.y), c.y), y_hi = max(max(a.y, b.y), c.y);
  // The shifts round towards minus infinity, for negative coordinates too.
  return {max((x_lo + (subpixels - 1 - last)) >> subpixel_bits, all(0)),
          max((y_lo + (subpixels - 1 - last)) >> subpixel_bits, all(0)),
          min((x_hi - first) >> subpixel_bits, all(size.width - 1)),
          min((y_hi - first) >> subpixel_bits, all(size.height - 1)),
          x_hi - x_lo,
          y_hi - y_lo};
}

// Twice the signed area; positive when a, b, c turn clockwise in the picture. For triangles below 2^14 subpixels;
// meaningless for larger ones.
inline Int doubled_areas(const Vertices& a, const Vertices& b, const Vertices& c) {
  return wrapping_difference(wrapping_product(b.x - a.x, c.y - a.y), wrapping_product(b.y - a.y, c.x - a.x));
}

// Sorts the triangles of a run into those that cover nothing, small ones, large ones and those to be clipped.
template <int Samples>
inline void sort_run(const SetupJob& job, std::uint32_t first, std::uint32_t count, SetupLists& lists) {
  std::uint32_t *small = lists.small, *large = lists.large, *clipped = lists.clipped;
  for (std::uint32_t t = first; t < first + count; t += width) {
    const unsigned valid = first + count - t >= width ? all_lanes : (1u << (first + count - t)) - 1;
    const std::uint32_t last = first + count - 1 - t;
    const Triangle* triangles = job.triangles.data() + t;
    const auto corner = [&](std::size_t i) {
      return load_vertices([&](std::uint32_t k) { return job.vertices + triangles[k < last ? k : last].v[i]; });
    };
    const Vertices a = corner(0), b = corner(1), c = corner(2);
    const unsigned clip = bits((a.inverse_w == 0.0f) | (b.inverse_w == 0.0f) | (c.inverse_w == 0.0f)) & valid;
    const Box box = box_of<Samples>(a, b, c, job.grid->size);
    const Int covering = (box.x0 <= box.x1) & (box.y0 <= box.y1);
    const Int is_small = (box.width < small_extent) & (box.height < small_extent);
    const unsigned candidates = bits(covering) & valid & ~clip;
    const unsigned small_ones = candidates & bits(is_small & (doubled_areas(a, b, c) != 0));
    const Int numbers = static_cast<std::int32_t>(t) + iota();
    small = append(small, numbers, small_ones);
    if (const unsigned large_ones = candidates & ~bits(is_small)) large = append(large, numbers, large_ones);
    if (clip) clipped = append(clipped, numbers, clip);
  }
  lists.small_count = static_cast<std::uint32_t>(small - lists.small);
  lists.large_count = static_cast<std::uint32_t>(large - lists.large);
  lists.clipped_count = static_cast<std::uint32_t>(clipped - lists.clipped);
}

// The edge functions of small triangles, in 32 bits: exact.
struct Edges {
  Int ab, bc, ca;           // at the sample that is looked at
  Int dx_ab, dx_bc, dx_ca;  // b.x - a.x and so on
  Int dy_ab, dy_bc, dy_ca;
  Int bias_ab, bias_bc, bias_ca;  // 0 for top and left edges, -1 for others: makes "> 0" a ">= 0"
};

inline Int bias_of(Int dx, Int dy) { return ~((dy < 0) | ((dy == 0) & (dx > 0))); }

// Edge functions at (x, y) in subpixels; a, b, c clockwise.
inline Edges edges_at(Int x, Int y, const Vertices& a, const Vertices& b, const Vertices& c) {
  Edges e;
  e.dx_ab = b.x - a.x, e.dx_bc = c.x - b.x, e.dx_ca = a.x - c.x;
  e.dy_ab = b.y - a.y, e.dy_bc = c.y - b.y, e.dy_ca = a.y - c.y;
  e.ab = e.dx_ab * (y - a.y) - e.dy_ab * (x - a.x);
  e.bc = e.dx_bc * (y - b.y) - e.dy_bc * (x - b.x);
  e.ca = e.dx_ca * (y - c.y) - e.dy_ca * (x - c.x);
  e.bias_ab = bias_of(e.dx_ab, e.dy_ab);
  e.bias_bc = bias_of(e.dx_bc, e.dy_bc);
  e.bias_ca = bias_of(e.dx_ca, e.dy_ca);
  return e;
}

// The values of the samples that small triangles cover.
struct CoveredSamples {
  Int x, y;  // pixel
  std::uint32_t sample;
  Float z, weight_b, weight_c;
};

// Appends the samples that the lanes of `mask` cover to the bins.
inline void emit(const SetupJob& job, unsigned mask, const CoveredSamples& f, const std::uint32_t* small) {
  std::int32_t tile[width], pixel[width];
  float z[width], weight_b[width], weight_c[width];
  store(tile, (f.y >> tile_bits) * job.grid->columns + (f.x >> tile_bits));
  store(pixel, ((f.y & (tile_size - 1)) << tile_bits) | (f.x & (tile_size - 1)));
  store(z, f.z), store(weight_b, f.weight_b), store(weight_c, f.weight_c);
  for (; mask != 0; mask &= mask - 1) {
    const int k = std::countr_zero(mask);
    const std::uint32_t sample =
        f.sample * static_cast<std::uint32_t>(tile_pixels) + static_cast<std::uint32_t>(pixel[k]);
    job.fragments->push(static_cast<std::size_t>(tile[k]), {sample, z[k], job.first_triangle + small[k],
                                                            job.triangles[small[k]].v, weight_b[k], weight_c[k]});
  }
}

// `width` small triangles of the list; the list must be readable so far.
template <int Samples>
inline void draw_small(const SetupJob& job, const std::uint32_t* small, unsigned valid) {
  const auto corner = [&](std::size_t i) {
    return load_vertices([&](int k) { return job.vertices + job.triangles[small[k]].v[i]; });
  };
  const Vertices a = corner(0), second = corner(1), third = corner(2);
  const Box box = box_of<Samples>(a, second, third, job.grid->size);
  const Int turned = doubled_areas(a, second, third), swap = turned < 0;
  const auto pick = [&](const Vertices& yes, const Vertices& no) {
    return Vertices{select(swap, yes.x, no.x), select(swap, yes.y, no.y), select(swap, yes.z, no.z),
                    select(swap, yes.inverse_w, no.inverse_w)};
  };
  const Vertices b = pick(third, second), c = pick(second, third);
  const Float inverse_area = 1.0f / to_float(select(swap, -turned, turned));
  const Float z_ab = b.z - a.z, z_ac = c.z - a.z;
  const Edges e =
      edges_at((box.x0 << subpixel_bits) + subpixels / 2, (box.y0 << subpixel_bits) + subpixels / 2, a, b, c);

  for (std::int32_t j = 0;; ++j) {
    const Int y = box.y0 + j, row = y <= box.y1;
    if ((bits(row) & valid) == 0) return;
    for (std::int32_t i = 0;; ++i) {
      const Int x = box.x0 + i, in_box = row & (x <= box.x1);
      if ((bits(in_box) & valid) == 0) break;
      for (std::size_t s = 0; s < Samples; ++s) {
        const std::int32_t dx = i * subpixels + sample_offsets<Samples>[s].x,
                           dy = j * subpixels + sample_offsets<Samples>[s].y;
        const Int ab = e.ab + e.dx_ab * dy - e.dy_ab * dx, bc = e.bc + e.dx_bc * dy - e.dy_bc * dx,
                  ca = e.ca + e.dx_ca * dy - e.dy_ca * dx;
        const Int inside = ((ab + e.bias_ab) | (bc + e.bias_bc) | (ca + e.bias_ca)) >= 0;
        if ((bits(inside & in_box) & valid) == 0) continue;
        // The share of a corner is the edge function of the opposite edge. Depth by shares remains between the corners'
        // depths even in slivers, where a plane equation would not.
        const Float share_b = to_float(ca) * inverse_area, share_c = to_float(ab) * inverse_area;
        const Float z = max((a.z + share_b * z_ab) + share_c * z_ac, all(0.0f));
        const unsigned drawn = bits(inside & in_box & (z < 1.0f)) & valid;
        if (drawn == 0) continue;
        // Linear on the surface is linear in the window after division by w.
        const Float wa = to_float(bc) * inverse_area * a.inverse_w, wb = share_b * b.inverse_w,
                    wc = share_c * c.inverse_w;
        const Float scale = 1.0f / ((wa + wb) + wc), weight_b = scale * wb, weight_c = scale * wc;
        emit(job, drawn,
             {x, y, static_cast<std::uint32_t>(s), z, select(swap, weight_c, weight_b),
              select(swap, weight_b, weight_c)},
             small);
      }
    }
  }
}

template <int Samples>
void setup_run(const SetupJob& job, std::uint32_t first, std::uint32_t count, SetupLists& lists) {
  sort_run<Samples>(job, first, count, lists);
  const std::uint32_t n = lists.small_count;
  if (n == 0) return;
  for (std::uint32_t k = 0; k < width; ++k) lists.small[n + k] = lists.small[n - 1];
  for (std::uint32_t i = 0; i < n; i += width)
    draw_small<Samples>(job, lists.small + i, n - i >= width ? all_lanes : (1u << (n - i)) - 1);
}

}  // namespace lodestone::soft::LODESTONE_LANES
