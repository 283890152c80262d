#include "core/hierarchy/construct/block_normals.h"

#include <cmath>
#include <utility>

namespace lodestone {
namespace {

constexpr float kept_cosine = 0.9396926f, kept_sine = 0.3420201f;  // 20 degrees
constexpr std::uint32_t none = 0xffff'ffffu;

}  // namespace

void BlockNormals::begin(const Block& block) {
  block_ = block;
  sums_.resize(block.normals.size());
  for (const std::uint32_t p : block.survivors) sums_[p] = Float4{};
  if (!block.vertex.empty()) group_wedges();
}

void BlockNormals::group_wedges() {
  same_normal_.resize(block_.normals.size());
  next_normal_.resize(block_.normals.size());
  first_normal_.assign(block_.vertices, none);
  for (const std::uint32_t p : block_.survivors) same_normal_[p] = none;
  for (const std::uint32_t p : block_.survivors) {
    if (same_normal_[p] != none) continue;
    std::uint32_t& first = first_normal_[block_.vertex[p]];
    std::uint32_t same = first;
    while (same != none && block_.normals[same] != block_.normals[p]) same = next_normal_[same];
    same_normal_[p] = same != none ? same : p;
    if (same == none) next_normal_[p] = std::exchange(first, p);
  }
}

void BlockNormals::add(const CoarseCell& cell) {
  cell_sums_.assign(cell.survivors.size(), Float4{});
  const Vec3f* const at = cell.positions.data();
  Float4* const sums = cell_sums_.data();
  for (const Triangle& t : cell.triangles) {
    const Float4 normal = to_float4(cross(at[t.v[1]] - at[t.v[0]], at[t.v[2]] - at[t.v[0]]));
    for (const std::uint32_t v : t.v) sums[v] += normal;
  }
  for (const std::uint32_t p : cell.survivors) sums_[first_with_normal(p)] += sums[cell.local[p]];
}

PackedNormal BlockNormals::turned(std::uint32_t survivor) const {
  const Vec3f towards = to_vec3f(sums_[first_with_normal(survivor)]), normal = unpack_normal(block_.normals[survivor]);
  const float squared = dot(towards, towards), along = dot(normal, towards);
  const bool near = along > 0 && along * along >= kept_cosine * kept_cosine * squared;
  if (near || !(squared > 0)) return block_.normals[survivor];
  const Vec3f mean = (1 / std::sqrt(squared)) * towards, aside = normal - dot(normal, mean) * mean;
  const float width = length(aside);
  return pack_normal(width > 1e-3f ? kept_cosine * mean + (kept_sine / width) * aside : mean);
}

}  // namespace lodestone
