#include "core/hierarchy/construct/cell_build.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/round_up.h"

namespace lodestone {
namespace {

// A bound of a length whose square was computed in single precision: of differences, three squares and two sums, which
// are off by 5 times 2^-24 at most, 2.5 times once the root is taken; the root and the product here add one each. Below
// the least normal float squares are off by half of the least float each, whatever their size.
float length_above(float squared, float scale) {
  constexpr float rounding = 1 + 0x3p-23f, vanished = 2 * std::numeric_limits<float>::denorm_min();
  return float_above(std::sqrt(squared + vanished) * scale * rounding);
}

template <class T>
std::span<T> carve(std::byte*& at, std::size_t count) {
  const std::span<T> span(reinterpret_cast<T*>(at), count);
  at += count * sizeof(T);
  return span;
}

}  // namespace

void UsageBox::extend(CellCoord c) {
  lo = {std::min(lo.x, c.x), std::min(lo.y, c.y), std::min(lo.z, c.z)};
  hi = {std::max(hi.x, c.x), std::max(hi.y, c.y), std::max(hi.z, c.z)};
}

void UsageBox::extend(const UsageBox& box) {
  extend(box.lo);
  extend(box.hi);
}

UsageBox UsageBox::parent() const {
  const auto half = [](CellCoord c) {
    return CellCoord{static_cast<std::uint16_t>(c.x >> 1), static_cast<std::uint16_t>(c.y >> 1),
                     static_cast<std::uint16_t>(c.z >> 1)};
  };
  return {half(lo), half(hi)};
}

bool UsageBox::inside(const UsageBox& range) const {
  return lo.x >= range.lo.x && lo.y >= range.lo.y && lo.z >= range.lo.z && hi.x <= range.hi.x && hi.y <= range.hi.y &&
         hi.z <= range.hi.z;
}

void CellSlab::allocate(std::size_t vertices, std::size_t shared, std::size_t triangle_count,
                        const AttributeSet& attributes) {
  // All members are made of 4-byte words (normals of two 2-byte ones), so the arrays can follow each other.
  const std::size_t with_uv = attributes.uv ? vertices : 0, with_colour = attributes.colours ? vertices : 0,
                    with_material = attributes.materials ? vertices : 0;
  const std::size_t bytes = vertices * (sizeof(Vec3f) + sizeof(PackedNormal) + sizeof(std::uint32_t)) +
                            with_uv * sizeof(Vec2f) + with_colour * sizeof(Rgba8) +
                            with_material * sizeof(std::uint32_t) + shared * sizeof(std::uint32_t) +
                            triangle_count * sizeof(Triangle);
  memory_ = std::make_unique_for_overwrite<std::byte[]>(bytes);
  std::byte* at = memory_.get();
  positions = carve<Vec3f>(at, vertices);
  normals = carve<PackedNormal>(at, vertices);
  parents = carve<std::uint32_t>(at, vertices);
  shared_ids = carve<std::uint32_t>(at, shared);
  uv = carve<Vec2f>(at, with_uv);
  colours = carve<Rgba8>(at, with_colour);
  materials = carve<std::uint32_t>(at, with_material);
  triangles = carve<Triangle>(at, triangle_count);
}

void CellBuild::release_transient() {
  // An assigned `{}` would keep the capacity.
  std::vector<std::uint32_t>().swap(ids);
  std::vector<std::uint32_t>().swap(vertex_ids);
  std::vector<UsageBox>().swap(usage);
  std::vector<float>().swap(vertex_errors);
}

void view_payload(const CellBuild& build, bool has_parents, Cell& cell) {
  cell.positions = build.slab.positions;
  cell.normals = build.slab.normals;
  cell.attributes = {build.slab.uv, build.slab.colours, build.slab.materials};
  if (has_parents) cell.parents = build.slab.parents;
  cell.shared_ids = build.slab.shared_ids;
  cell.triangles = build.triangles;
  cell.border_errors = build.border_errors;
}

void sort_by_material(CellBuild& cell) {
  if (cell.slab.materials.empty()) return;
  std::stable_sort(cell.triangles.begin(), cell.triangles.end(), [&](const Triangle& a, const Triangle& b) {
    return cell.slab.materials[a.v[0]] < cell.slab.materials[b.v[0]];
  });
}

void set_box_statistics(CellBuild& cell, int grid) {
  const float per_h = 1 / cell_size(grid);
  // Both norms in one pass, four vertices at a time; the Euclidean one squared, since the square root keeps the order.
  const std::span<const Vec3f> p = cell.slab.positions;
  const Box3f& box = cell.bounds;
  const auto farther = [](Float4 v, float lo, float hi) { return max(v - lo, hi - v); };
  Float4 far2{}, far_axis{};
  for (std::size_t i = 0; i < p.size(); i += 4) {
    const auto at = [&](std::size_t k) { return to_float4(p[std::min(i + k, p.size() - 1)]); };
    const auto v = transposed(at(0), at(1), at(2), at(3));
    const Float4 x = farther(v.a, box.lo.x, box.hi.x), y = farther(v.b, box.lo.y, box.hi.y),
                 z = farther(v.c, box.lo.z, box.hi.z);
    far2 = max((x * x + y * y) + z * z, far2);
    far_axis = max(max(max(x, y), z), far_axis);
  }
  const auto highest = [](Float4 v) { return std::max(std::max(v[0], v[1]), std::max(v[2], v[3])); };
  cell.reach[static_cast<std::size_t>(DistanceMetric::euclidean)] = length_above(highest(far2), per_h);
  cell.reach[static_cast<std::size_t>(DistanceMetric::chebyshev)] = float_above(highest(far_axis) * per_h);
  const Vec3f diagonal = cell.bounds.hi - cell.bounds.lo;
  cell.diameter = length_above(dot(diagonal, diagonal), per_h);
}

void set_edge_statistics(CellBuild& cell, int grid, const EdgeLengths& lengths) {
  cell.max_edge = length_above(lengths.longest2(), 1 / cell_size(grid));
  cell.long_edges = lengths.over();
}

void measure_cell(CellBuild& cell, int grid, float sigma0, std::span<Float4> normals) {
  EdgeLengths lengths(sigma0 * cell_size(grid));
  for (const Triangle& t : cell.triangles) {
    const Float4 a = to_float4(cell.slab.positions[t.v[0]]), b = to_float4(cell.slab.positions[t.v[1]]),
                 c = to_float4(cell.slab.positions[t.v[2]]);
    const Float4 ab = b - a, ca = a - c;
    lengths.add(ab, c - b, ca);
    if (normals.empty()) continue;
    Float4 normal = cross_zxy(ca, ab);
    normal[3] = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (const std::uint32_t v : t.v) normals[v] += normal;
  }
  set_edge_statistics(cell, grid, lengths);
  set_box_statistics(cell, grid);
}

}  // namespace lodestone
