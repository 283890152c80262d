#include "core/simplify/quadric/splitter.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/math/vec3.h"

namespace lodestone::quadric {
namespace {

// Integers in the order of the floats, so that even NaNs have a place.
std::int32_t ordered(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  return bits >= 0 ? bits : bits ^ 0x7fff'ffff;
}

Vec3f thrice_barycentre(const SimplifyInput& input, std::uint32_t t) {
  const auto& v = input.triangles[t].v;
  return input.positions[v[0]] + input.positions[v[1]] + input.positions[v[2]];
}

}  // namespace

std::size_t Splitter::count_vertices(const SimplifyInput& input, std::size_t begin, std::size_t end) {
  ++stamp_;
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i)
    for (const std::uint32_t v : input.triangles[order_[i].triangle].v)
      if (seen_[v] != stamp_) seen_[v] = stamp_, ++count;
  return count;
}

void Splitter::cut(const SimplifyInput& input, std::size_t max_vertices, bool by_place) {
  seen_.assign(input.positions.size(), 0);
  stamp_ = 0;
  ends_.assign(1, 0);
  halve(input, 0, order_.size(), max_vertices, by_place);
}

void Splitter::halve(const SimplifyInput& input, std::size_t begin, std::size_t end, std::size_t max_vertices,
                     bool by_place) {
  if (count_vertices(input, begin, end) <= max_vertices) {
    ends_.push_back(end);
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  if (by_place) part_by_median(input, begin, middle, end);
  halve(input, begin, middle, max_vertices, by_place);
  halve(input, middle, end, max_vertices, by_place);
}

// Brings the triangles below the median along the longest axis in front of the others.
void Splitter::part_by_median(const SimplifyInput& input, std::size_t begin, std::size_t middle, std::size_t end) {
  Box3f box;
  for (std::size_t i = begin; i < end; ++i) box.extend(thrice_barycentre(input, order_[i].triangle));
  const std::array<float, 3> extent{box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
  const auto axis = std::max_element(extent.begin(), extent.end()) - extent.begin();
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3f b = thrice_barycentre(input, order_[i].triangle);
    order_[i].key = ordered(axis == 0 ? b.x : axis == 1 ? b.y : b.z);
  }
  const auto first = order_.begin();
  std::nth_element(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(middle),
                   first + static_cast<std::ptrdiff_t>(end));
}

std::size_t Splitter::find_shared(const SimplifyInput& input) {
  constexpr std::uint32_t unused = 0xffff'ffffu;
  seen_.assign(input.positions.size(), unused);
  shared_.assign(input.positions.size(), 0);
  for (std::uint32_t part = 0; part + 1 < ends_.size(); ++part)
    for (std::size_t i = ends_[part]; i < ends_[part + 1]; ++i)
      for (const std::uint32_t v : input.triangles[order_[i].triangle].v) {
        shared_[v] |= seen_[v] != unused && seen_[v] != part;
        seen_[v] = part;
      }
  return static_cast<std::size_t>(std::count(shared_.begin(), shared_.end(), 1));
}

std::size_t Splitter::split(const SimplifyInput& input, std::size_t max_vertices) {
  order_.resize(input.triangles.size());
  for (std::uint32_t t = 0; t < order_.size(); ++t) order_[t] = {0, t};
  cut(input, max_vertices, false);
  // A block's triangles come cell by cell, and halves of that order have short seams. Those of one large cell need not.
  constexpr std::size_t one_in = 12;
  if (find_shared(input) > input.positions.size() / one_in) {
    cut(input, max_vertices, true);
    // The order that nth_element leaves within a part is unspecified.
    const auto by_id = [](const Keyed& a, const Keyed& b) { return a.triangle < b.triangle; };
    for (std::size_t p = 0; p + 1 < ends_.size(); ++p)
      std::sort(order_.begin() + static_cast<std::ptrdiff_t>(ends_[p]),
                order_.begin() + static_cast<std::ptrdiff_t>(ends_[p + 1]), by_id);
    (void)find_shared(input);
  }
  local_.resize(input.positions.size());
  seen_.assign(input.positions.size(), 0);
  seen_wedge_.assign(input.wedge_vertex.size(), 0);
  local_wedge_.resize(input.wedge_vertex.size());
  stamp_ = 0;
  return ends_.size() - 1;
}

void Splitter::append_corners(const Triangle& corners, const Triangle& local) {
  Triangle c = corners;
  for (std::size_t k = 0; k < 3; ++k) {
    std::uint32_t& w = c.v[k];
    if (seen_wedge_[w] != stamp_) {
      seen_wedge_[w] = stamp_;
      local_wedge_[w] = static_cast<std::uint32_t>(part_.wedges.size());
      part_.wedges.push_back(w);
      part_.wedge_vertex.push_back(local.v[k]);
    }
    w = local_wedge_[w];
  }
  part_.corners.push_back(c);
}

const Part& Splitter::part(const SimplifyInput& input, std::size_t index) {
  ++stamp_;
  part_.vertices.clear();
  part_.positions.clear();
  part_.triangles.clear();
  part_.locked.clear();
  part_.wedges.clear();
  part_.wedge_vertex.clear();
  part_.corners.clear();
  for (std::size_t i = ends_[index]; i < ends_[index + 1]; ++i) {
    Triangle t = input.triangles[order_[i].triangle];
    for (std::uint32_t& v : t.v) {
      if (seen_[v] != stamp_) {
        seen_[v] = stamp_;
        local_[v] = static_cast<std::uint32_t>(part_.vertices.size());
        part_.vertices.push_back(v);
        part_.positions.push_back(input.positions[v]);
        part_.locked.push_back(input.locked[v] | shared_[v]);
      }
      v = local_[v];
    }
    part_.triangles.push_back(t);
    if (!input.corners.empty()) append_corners(input.corners[order_[i].triangle], t);
  }
  return part_;
}

}  // namespace lodestone::quadric
