#include "core/simplify/quadric_parts.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/base/box3.h"

namespace lodestone::quadric {
namespace {

class Parts {
 public:
  Parts(const SimplifyInput& input, std::size_t vertex_limit, PartsScratch& scratch)
      : input_(input), limit_(vertex_limit), s_(scratch) {
    s_.order.resize(input.triangles.size());
    std::iota(s_.order.begin(), s_.order.end(), 0u);
    s_.stamp.assign(input.positions.size(), 0);
    s_.local.resize(input.positions.size());
    s_.part_end.clear();
  }

  void cut(std::size_t begin, std::size_t end) {
    if (count_vertices(begin, end) <= limit_) {
      s_.part_end.push_back(end);
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return s_.order.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t axis = longest_axis(begin, end);
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      const float ka = triple_barycentre(a)[axis], kb = triple_barycentre(b)[axis];
      return ka != kb ? ka < kb : a < b;
    });
    // Within a part the order of the input is kept, whatever nth_element does.
    std::sort(at(begin), at(middle));
    std::sort(at(middle), at(end));
    cut(begin, middle);
    cut(middle, end);
  }

  void mark_shared() {
    s_.shared.assign(input_.locked.begin(), input_.locked.end());
    s_.stamp.assign(s_.stamp.size(), 0);
    std::size_t begin = 0;
    for (std::uint32_t part = 1; part <= s_.part_end.size(); ++part) {
      for (; begin < s_.part_end[part - 1]; ++begin)
        for (const std::uint32_t v : input_.triangles[s_.order[begin]].v) {
          if (s_.stamp[v] != 0 && s_.stamp[v] != part) s_.shared[v] = 1;
          s_.stamp[v] = part;
        }
    }
    s_.stamp.assign(s_.stamp.size(), 0);
    next_stamp_ = 0;
  }

  // The mesh of a part on ids of its own.
  SimplifyInput extract(std::size_t begin, std::size_t end) {
    s_.vertices.clear();
    s_.positions.clear();
    s_.triangles.clear();
    s_.locked.clear();
    ++next_stamp_;
    for (std::size_t i = begin; i < end; ++i) {
      Triangle t = input_.triangles[s_.order[i]];
      for (std::uint32_t& v : t.v) v = local_id(v);
      s_.triangles.push_back(t);
    }
    const std::size_t share = input_.target_triangles * (end - begin) / input_.triangles.size();
    return {s_.positions, s_.triangles, s_.locked, input_.max_displacement, share};
  }

 private:
  [[nodiscard]] std::array<float, 3> triple_barycentre(std::uint32_t t) const {
    const auto& v = input_.triangles[t].v;
    const Vec3f sum = input_.positions[v[0]] + input_.positions[v[1]] + input_.positions[v[2]];
    return {sum.x, sum.y, sum.z};
  }

  std::size_t count_vertices(std::size_t begin, std::size_t end) {
    ++next_stamp_;
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t v : input_.triangles[s_.order[i]].v)
        if (s_.stamp[v] != next_stamp_) s_.stamp[v] = next_stamp_, ++count;
    return count;
  }

  [[nodiscard]] std::size_t longest_axis(std::size_t begin, std::size_t end) const {
    Box3f box;
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t v : input_.triangles[s_.order[i]].v) box.extend(input_.positions[v]);
    const Vec3f size = box.hi - box.lo;
    return size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  }

  std::uint32_t local_id(std::uint32_t v) {
    if (s_.stamp[v] != next_stamp_) {
      s_.stamp[v] = next_stamp_;
      s_.local[v] = static_cast<std::uint32_t>(s_.vertices.size());
      s_.vertices.push_back(v);
      s_.positions.push_back(input_.positions[v]);
      s_.locked.push_back(s_.shared[v]);
    }
    return s_.local[v];
  }

  const SimplifyInput& input_;
  std::size_t limit_;
  PartsScratch& s_;
  std::uint32_t next_stamp_ = 0;
};

}  // namespace

void simplify_in_parts(const SimplifyInput& input, std::size_t vertex_limit, const BlockKernelCall& kernel,
                       PartsScratch& scratch, SimplifyResult& result) {
  std::iota(result.parent.begin(), result.parent.end(), 0u);
  std::copy(input.positions.begin(), input.positions.end(), result.positions.begin());
  result.triangles = 0;
  if (input.triangles.empty()) return;

  Parts parts(input, vertex_limit, scratch);
  parts.cut(0, input.triangles.size());
  parts.mark_shared();
  std::size_t begin = 0;
  for (const std::size_t end : scratch.part_end) {
    const SimplifyInput part = parts.extract(begin, end);
    scratch.result.parent.resize(part.positions.size());
    scratch.result.positions.resize(part.positions.size());
    kernel(part, scratch.result);
    for (std::size_t i = 0; i < scratch.vertices.size(); ++i) {
      const std::uint32_t v = scratch.vertices[i];
      if (scratch.shared[v]) continue;  // stays, and other parts say the same
      result.parent[v] = scratch.vertices[scratch.result.parent[i]];
      result.positions[v] = scratch.result.positions[i];
    }
    result.triangles += scratch.result.triangles;
    begin = end;
  }
}

}  // namespace lodestone::quadric
