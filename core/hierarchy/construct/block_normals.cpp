#include "core/hierarchy/construct/block_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/hierarchy/construct/facing_normal.h"
#include "core/hierarchy/model/pack_normals.h"

namespace lodestone {
namespace {

constexpr float kept_cosine = 0.9396926f, kept_sine = 0.3420201f;  // 20 degrees
constexpr float lost_cosine = 0.5f;                                // from 60 degrees on nothing of a normal is kept
constexpr float fold_cosine = 0.8660254f;                          // 30 degrees: wedges farther apart are a fold
constexpr float lost_squared = lost_cosine * lost_cosine;
// The length of the sum of the triangles over the sum of their lengths. Above it less than a tenth of the area is more
// than 60 degrees off the rest; such corners are not looked at one by one, for speed.
constexpr float together = 0.95f;
constexpr std::uint32_t no_normal = 0xffff'ffffu;

// Unpacks octahedral normals, as unpack_normal does, but not to unit length.
Float4x3 unpacked(const PackedNormal* normals) {
  Int4 uv;
  std::memcpy(&uv, normals, sizeof uv);
  const Float4 u = __builtin_convertvector(uv << 16 >> 16, Float4), v = __builtin_convertvector(uv >> 16, Float4);
  const Float4 one = all4(32767), z = one - abs(u) - abs(v);
  const Int4 below = z < 0.0f;
  return {below ? copysign(one - abs(v), u) : u, below ? copysign(one - abs(u), v) : v, z};
}

Float4 dot(const Float4x3& a, const Float4x3& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }

// Four vertices. The sums have their components in the order z, x, y.
struct Four {
  Float4x3 normal, towards;  // of any length
  Float4 squared, along;     // of `towards`; the normals along it
  Int4 far;
};

Four compare(const PackedNormal* normals, Float4 a, Float4 b, Float4 c, Float4 d) {
  const auto [z, x, y, unused] = transposed(a, b, c, d);
  Four f;
  f.normal = unpacked(normals);
  f.towards = {x, y, z};
  f.squared = dot(f.towards, f.towards);
  f.along = dot(f.normal, f.towards);
  const Float4 kept = kept_cosine * kept_cosine * f.squared * dot(f.normal, f.normal);
  f.far = (f.squared > 0.0f) & ((f.along <= 0.0f) | (f.along * f.along < kept));
  return f;
}

Four compare_at(const std::array<std::uint32_t, 4>& i, std::span<const PackedNormal> normals,
                std::span<const Float4> sums) {
  const std::array four{normals[i[0]], normals[i[1]], normals[i[2]], normals[i[3]]};
  return compare(four.data(), sums[i[0]], sums[i[1]], sums[i[2]], sums[i[3]]);
}

// The directions at 20 degrees from the sums, on the sides of the normals; less the farther these are from them.
std::array<PackedNormal, 4> turned(const Four& f) {
  const auto& [n, towards, squared, along, far] = f;
  const Float4 share = along / squared;
  const Float4x3 aside{n.x - share * towards.x, n.y - share * towards.y, n.z - share * towards.z};
  const Float4 width2 = dot(aside, aside), ratio2 = select(width2 > 1e-6f * dot(n, n), squared / width2, Float4{});
  Float4 scale;
  for (int k = 0; k < 4; ++k) {
    const float cosine = along[k] / std::sqrt(squared[k] * dot(n, n)[k]);
    const float kept = std::max(cosine - lost_cosine, 0.0f) / (kept_cosine - lost_cosine);
    scale[k] = kept * (kept_sine / kept_cosine) * std::sqrt(ratio2[k]);
  }
  const auto rows =
      transposed(towards.x + scale * aside.x, towards.y + scale * aside.y, towards.z + scale * aside.z, Float4{});
  std::array<PackedNormal, 4> packed;
  pack_normals(std::array{rows.a, rows.b, rows.c, rows.d}, packed);
  return packed;
}

// True if both are within the angle of a fold, or one of them is zero.
bool continues(Float4 own, Float4 all) {
  const auto product = [](Float4 a, Float4 b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const float along = product(own, all);
  return along >= 0 && along * along >= fold_cosine * fold_cosine * product(own, own) * product(all, all);
}

// True if some of the triangles may be far off their mean.
bool is_spread(Float4 sum) {
  const float squared = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2];
  return squared < together * together * (sum[3] * sum[3]);
}

}  // namespace

void BlockNormals::begin(const Block& block) {
  block_ = block;
  const std::size_t vertices = block.vertex.empty() ? block.locked.size() : block.vertices;
  if (first_.size() < vertices) first_.resize(vertices, no_normal);
  if (first_use_.size() < block.locked.size()) first_use_.resize(block.locked.size(), no_normal);
  shared_.clear(), shared_vertices_.clear(), shared_normals_.clear(), shared_sums_.clear(), places_.clear();
  spread_.clear(), spread_of_.clear(), cells_.clear();
}

void BlockNormals::turn(std::span<const std::uint32_t> vertex, std::span<PackedNormal> normals,
                        std::span<Float4> sums) {
  find_same(vertex, normals);
  join(sums);
  find_far(normals, sums);
  for (std::size_t first = 0; first < far_.size(); first += 4) {
    std::array<std::uint32_t, 4> i;
    for (std::size_t k = 0; k < 4; ++k) i[k] = far_[std::min(first + k, far_.size() - 1)];
    const Four f = compare_at(i, normals, sums);
    const std::array<PackedNormal, 4> packed = turned(f);
    for (std::size_t k = 0; k < 4; ++k)
      if (f.far[k]) normals[i[k]] = packed[k];
  }
}

void BlockNormals::find_far(std::span<const PackedNormal> normals, std::span<const Float4> sums) {
  far_.resize(normals.size() + 1);  // one is written beyond those that are counted
  std::size_t count = 0;
  std::uint32_t i = 0;
  const auto list = [&](const Int4& far, std::size_t lanes) {
    for (std::size_t k = 0; k < lanes && !equal(far, Int4{}); ++k) {
      far_[count] = i + static_cast<std::uint32_t>(k);
      count += far[k] != 0;
    }
    i += 4;
  };
  const auto end = static_cast<std::uint32_t>(normals.size());
  while (i + 4 <= end) list(compare(&normals[i], sums[i], sums[i + 1], sums[i + 2], sums[i + 3]).far, 4);
  if (i < end)
    list(compare_at({i, std::min(i + 1, end - 1), std::min(i + 2, end - 1), end - 1}, normals, sums).far, end - i);
  far_.resize(count);
}

// Wedges of one vertex that have one normal: pairs of each and the first of them.
void BlockNormals::find_same(std::span<const std::uint32_t> vertex, std::span<const PackedNormal> normals) {
  next_.resize(std::max(next_.size(), vertex.size()));
  same_.clear();
  for (std::uint32_t i = 0; i < vertex.size(); ++i) {
    std::uint32_t& first = first_[vertex[i]];
    std::uint32_t same = first;
    while (same != no_normal && normals[same] != normals[i]) same = next_[same];
    if (same == no_normal)
      next_[i] = std::exchange(first, i);
    else
      same_.emplace_back(i, same);
  }
  for (const std::uint32_t v : vertex) first_[v] = no_normal;
}

// Gives these wedges the sum of them, but for those between which the surface folds.
void BlockNormals::join(std::span<Float4> sums) {
  all_.resize(std::max(all_.size(), sums.size()));
  for (const auto& [i, same] : same_) all_[same] = sums[same];
  for (const auto& [i, same] : same_) all_[same] += sums[i];
  const auto is_joined = [&](std::uint32_t wedge, std::uint32_t same) { return continues(sums[wedge], all_[same]); };
  if (std::ranges::all_of(same_, [&](auto pair) { return is_joined(pair.first, pair.second); }) &&
      std::ranges::all_of(same_, [&](auto pair) { return is_joined(pair.second, pair.second); })) {
    for (const auto& [i, same] : same_) sums[i] = sums[same] = all_[same];
    return;
  }
  joined_.resize(all_.size());
  for (const auto& [i, same] : same_) joined_[same] = is_joined(same, same) ? sums[same] : Float4{};
  for (const auto& [i, same] : same_)
    if (is_joined(i, same)) joined_[same] += sums[i];
  for (const auto& [i, same] : same_)
    for (const std::uint32_t wedge : {i, same})
      if (is_joined(wedge, same)) sums[wedge] = joined_[same];
}

// Numbers those whose triangles face apart. After turn: wedges that it has joined have equal sums and one number.
void BlockNormals::list_spread(std::span<const PackedNormal> normals, std::span<const Float4> sums,
                               std::span<std::uint32_t> spread_of) {
  for (std::size_t i = 0; i < normals.size(); ++i) {
    spread_of[i] = no_normal;
    if (!is_spread(sums[i])) continue;
    spread_of[i] = static_cast<std::uint32_t>(spread_.size());
    spread_.push_back(normals[i]);
  }
  for (const auto& [i, same] : same_)
    if (spread_of[i] != no_normal && spread_of[same] != no_normal && normals[i] == normals[same])
      spread_of[i] = spread_of[same];
}

// The triangles at those normals, sorted by these. Cells whose normals are all together are passed over.
void BlockNormals::gather_corners() {
  corners_.clear();
  for (const Cell& cell : cells_) {
    const std::span spread_of = std::span(spread_of_).subspan(cell.first, cell.normals.size());
    if (std::ranges::all_of(spread_of, [](std::uint32_t s) { return s == no_normal; })) continue;
    for (const Triangle& t : cell.triangles) {
      const auto at = [&](std::size_t k) { return spread_of[t.v[k]]; };
      if ((at(0) & at(1) & at(2)) == no_normal) continue;
      const auto p = [&](std::size_t k) { return to_double(cell.positions[t.v[k]]); };
      const Vec3d triangle = cross(p(1) - p(0), p(2) - p(0));
      for (std::size_t k = 0; k < 3; ++k)
        if (at(k) != no_normal) corners_.push_back({at(k), triangle});
    }
  }
  std::ranges::stable_sort(corners_, {}, &Corner::spread);
}

// Replaces those that are more than 60 degrees off a triangle.
void BlockNormals::face_corners() {
  std::vector<Vec3d> triangles;
  for (std::size_t first = 0, end = 0; first < corners_.size(); first = end) {
    PackedNormal& normal = spread_[corners_[first].spread];
    const Vec3d n = to_double(unpack_normal(normal));
    bool is_off = false;
    triangles.clear();
    for (; end < corners_.size() && corners_[end].spread == corners_[first].spread; ++end) {
      const Vec3d& t = triangles.emplace_back(corners_[end].triangle);
      const double along = dot(n, t), squared = dot(t, t);
      is_off |= squared > 0 && (along <= 0 || along * along < lost_squared * squared);
    }
    if (is_off) normal = pack_normal(to_float(facing_normal(triangles)));
  }
}

void BlockNormals::add(const CoarseCell& cell) {
  const std::size_t own = cell.normals.size() - cell.shared.size();
  turn(cell.vertex.first(cell.vertex.empty() ? 0 : own), cell.normals.first(own), cell.sums.first(own));
  cells_.push_back({cell.normals, cell.positions, cell.triangles, own, spread_of_.size()});
  spread_of_.resize(spread_of_.size() + cell.normals.size(), no_normal);
  const std::span spread_of = std::span(spread_of_).last(cell.normals.size());
  list_spread(cell.normals.first(own), cell.sums.first(own), spread_of);
  for (std::size_t k = 0; k < cell.shared.size(); ++k) {
    const std::uint32_t p = cell.shared[k];
    if (block_.locked[p]) continue;
    std::uint32_t& use = first_use_[p];
    if (use == no_normal) {
      use = static_cast<std::uint32_t>(shared_.size());
      shared_.push_back(p);
      shared_vertices_.push_back(block_.vertex.empty() ? p : block_.vertex[p]);
      shared_normals_.push_back(cell.normals[own + k]);
      shared_sums_.push_back(Float4{});
    }
    shared_sums_[use] += cell.sums[own + k];
    spread_of[own + k] = use;  // its place, until finish
    places_.emplace_back(&cell.normals[own + k], use);
  }
}

void BlockNormals::finish() {
  turn(block_.vertex.empty() ? std::span<const std::uint32_t>() : shared_vertices_, shared_normals_, shared_sums_);
  shared_spread_of_.resize(shared_.size());
  list_spread(shared_normals_, shared_sums_, shared_spread_of_);
  for (const auto& [place, use] : places_) *place = shared_normals_[use];
  for (const std::uint32_t p : shared_) first_use_[p] = no_normal;
  if (spread_.empty()) return;
  for (const Cell& cell : cells_)
    for (std::size_t i = cell.own; i < cell.normals.size(); ++i)
      if (std::uint32_t& s = spread_of_[cell.first + i]; s != no_normal) s = shared_spread_of_[s];
  gather_corners();
  face_corners();
  for (const Cell& cell : cells_)
    for (std::size_t i = 0; i < cell.normals.size(); ++i)
      if (const std::uint32_t s = spread_of_[cell.first + i]; s != no_normal) cell.normals[i] = spread_[s];
}

}  // namespace lodestone
