#include "core/hierarchy/tiles/atlas_parts.h"

#include <cmath>
#include <functional>
#include <map>

#include "core/base/disjoint_sets.h"

namespace lodestone::atlas {
namespace {

constexpr std::int64_t most_repetitions = 2;

bool overlap(const TexelBox& a, const TexelBox& b) {
  constexpr auto room = std::int64_t{2} * gutter;  // closer parts take less room as one
  return a.x0 < b.x1 + room && b.x0 < a.x1 + room && a.y0 < b.y1 + room && b.y0 < a.y1 + room;
}

// Unites boxes until none overlap, or takes one for all where that is no larger. Returns the new number of each.
std::vector<std::uint32_t> merge(std::vector<TexelBox>& parts) {
  DisjointSets sets(parts.size());
  std::vector<TexelBox> boxes = parts;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
      if (sets.find(a) != a) continue;
      for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
        if (sets.find(b) != b || !overlap(boxes[a], boxes[b])) continue;
        sets.unite(a, b);
        boxes[a].include(boxes[b]);
        changed = true;
      }
    }
  }
  TexelBox whole = boxes.front();
  std::uint64_t sum = 0;
  for (std::uint32_t a = 0; a < boxes.size(); ++a) {
    if (sets.find(a) != a) continue;
    whole.include(boxes[a]);
    sum += padded_area(boxes[a]);
  }
  std::vector<std::uint32_t> number(parts.size(), 0);
  if (sum >= padded_area(whole)) {
    parts = {whole};
    return number;
  }
  parts.clear();
  for (std::uint32_t a = 0; a < boxes.size(); ++a) {
    const std::uint32_t root = sets.find(a);
    if (root == a) {
      number[a] = static_cast<std::uint32_t>(parts.size());
      parts.push_back(boxes[a]);
    } else {
      number[a] = number[root];
    }
  }
  return number;
}

}  // namespace

bool find_parts(const Cell& cell, const Cell* parent, Use& use) {
  DisjointSets charts(cell.positions.size());
  for (const Triangle& t : cell.triangles) {
    if (cell.attributes.materials[t.v[0]] != use.material) continue;
    charts.unite(t.v[0], t.v[1]);
    charts.unite(t.v[0], t.v[2]);
  }
  struct Extent {
    double u0 = 1e30, v0 = 1e30, u1 = -1e30, v1 = -1e30;
    void include(Vec2f uv) {
      u0 = std::fmin(u0, uv.x), u1 = std::fmax(u1, uv.x);
      v0 = std::fmin(v0, uv.y), v1 = std::fmax(v1, uv.y);
    }
  };
  std::map<std::uint32_t, Extent> extents;
  for (const std::uint32_t v : use.vertices) {
    Extent& e = extents[charts.find(v)];
    e.include(cell.attributes.uv[v]);
    if (parent) e.include(parent_uv(cell, *parent, v));  // of the same chart
  }
  std::map<std::uint32_t, std::array<std::int64_t, 2>> shifts;
  std::map<std::uint32_t, std::uint32_t> part_of;
  for (const auto& [chart, e] : extents) {
    if (!(e.u1 - e.u0 <= most_repetitions && e.v1 - e.v0 <= most_repetitions)) return false;
    if (!(std::abs(e.u0) < 1e6 && std::abs(e.v0) < 1e6)) return false;
    const auto shift = [](double from, TextureWrap wrap) {
      if (wrap == TextureWrap::clamp) return std::int64_t{0};
      const std::int64_t period = wrap == TextureWrap::mirror ? 2 : 1;
      return period * static_cast<std::int64_t>(std::floor(from / static_cast<double>(period)));
    };
    const auto [du, dv] = shifts[chart] = {shift(e.u0, use.wrap_u), shift(e.v0, use.wrap_v)};
    const auto texel = [](double t, std::int64_t moved, std::uint32_t size) {
      return static_cast<std::int64_t>(std::floor((t - static_cast<double>(moved)) * size));
    };
    part_of[chart] = static_cast<std::uint32_t>(use.parts.size());
    use.parts.push_back({texel(e.u0, du, use.size.width), texel(e.v0, dv, use.size.height),
                         texel(e.u1, du, use.size.width) + 1, texel(e.v1, dv, use.size.height) + 1});
  }
  const std::vector<std::uint32_t> merged = merge(use.parts);
  for (const std::uint32_t v : use.vertices) {
    const std::uint32_t chart = charts.find(v);
    use.shift.push_back(shifts[chart]);
    use.part_of.push_back(merged[part_of[chart]]);
  }
  return true;
}

std::optional<PixelSize> pack(std::span<Use* const> uses, std::uint32_t longest_side) {
  struct Part {
    Use* use;
    std::size_t number;
    PixelSize size;
  };
  std::vector<Part> parts;
  double texels = 0;
  std::uint32_t widest = 0;
  for (Use* use : uses) {
    use->places.resize(use->parts.size());
    for (std::size_t k = 0; k < use->parts.size(); ++k) {
      const PixelSize p{padded(use->parts[k].width()), padded(use->parts[k].height())};
      parts.push_back({use, k, p});
      texels += double{1} * p.width * p.height;
      widest = std::max(widest, p.width);
    }
  }
  std::ranges::stable_sort(parts, std::greater{}, [](const Part& p) { return p.size.height; });
  const auto square = static_cast<std::uint32_t>(std::ceil(std::sqrt(texels) / gutter)) * gutter;
  if (std::max(widest, square) > longest_side || parts.front().size.height > longest_side) return std::nullopt;
  // About a square first; where its shelves waste too much, as wide as it may be.
  PixelSize size;
  const auto fit = [&](std::uint32_t width) {
    PagePacker packer({width, longest_side});
    size = {width, 0};
    for (const Part& part : parts) {
      const PagePlace at = packer.add(part.size);
      if (at.page > 0) return false;
      part.use->places[part.number] = at;
      size.height = std::max(size.height, at.y + part.size.height);
    }
    return true;
  };
  if (fit(std::max(widest, square)) || fit(longest_side / gutter * gutter)) return size;
  return std::nullopt;
}

}  // namespace lodestone::atlas
