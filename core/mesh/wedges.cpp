#include "core/mesh/wedges.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

namespace lodestone {
namespace {

// The values at a corner as bits: equal keys share a wedge.
struct Key {
  std::array<std::uint32_t, 5> bits;
  friend auto operator<=>(const Key&, const Key&) = default;
};

std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value + 0.0f); }  // -0 + 0 is +0

struct Corner {
  Key key;
  std::uint64_t index;
};

class WedgeMaker {
 public:
  WedgeMaker(std::span<const Triangle> triangles, const CornerAttributes& attributes)
      : triangles_(triangles), attributes_(&attributes) {
    assert(attributes.uv_of.empty() || attributes.uv_of.size() == triangles.size());
    assert(attributes.normal_of.empty() || attributes.normal_of.size() == triangles.size());
    wedges_.corners.resize(triangles.size());
  }

  // All corners of one vertex.
  void add_vertex(std::uint32_t vertex, std::span<const std::uint64_t> corners) {
    around_.clear();
    for (const std::uint64_t corner : corners) around_.push_back({key_of(corner), corner});
    std::sort(around_.begin(), around_.end(), [](const Corner& a, const Corner& b) { return a.key < b.key; });
    for (std::size_t i = 0; i < around_.size(); ++i) {
      if (i == 0 || around_[i].key != around_[i - 1].key) add_wedge(vertex, around_[i].index);
      wedges_.corners[around_[i].index / 3].v[around_[i].index % 3] = count_ - 1;
    }
  }

  [[nodiscard]] RawWedges result() && { return std::move(wedges_); }

 private:
  [[nodiscard]] Vec2f uv_at(std::uint64_t corner) const {
    const std::uint32_t id = attributes_->uv_of[corner / 3].v[corner % 3];
    return id == no_value ? Vec2f{} : attributes_->uv[id];
  }
  [[nodiscard]] Vec3f normal_at(std::uint64_t corner) const {
    const std::uint32_t id = attributes_->normal_of[corner / 3].v[corner % 3];
    return id == no_value ? Vec3f{} : attributes_->normal[id];
  }

  [[nodiscard]] Key key_of(std::uint64_t corner) const {
    Key key{};
    if (!attributes_->uv_of.empty()) {
      const Vec2f uv = uv_at(corner);
      key.bits[0] = bits_of(uv.x), key.bits[1] = bits_of(uv.y);
    }
    if (!attributes_->normal_of.empty()) {
      const Vec3f n = normal_at(corner);
      key.bits[2] = bits_of(n.x), key.bits[3] = bits_of(n.y), key.bits[4] = bits_of(n.z);
    }
    return key;
  }

  void add_wedge(std::uint32_t vertex, std::uint64_t corner) {
    if (!attributes_->uv_of.empty()) wedges_.uv.push_back(uv_at(corner));
    if (!attributes_->normal_of.empty()) wedges_.normal.push_back(normal_at(corner));
    if (!attributes_->colour.empty()) wedges_.colour.push_back(attributes_->colour[vertex]);
    ++count_;
  }

  std::span<const Triangle> triangles_;
  const CornerAttributes* attributes_;
  RawWedges wedges_;
  std::uint32_t count_ = 0;
  std::vector<Corner> around_;
};

// The corners of all triangles by vertex: those of vertex v are corners[first[v]..first[v + 1]).
struct CornersOfVertices {
  std::vector<std::uint64_t> first, corners;
};

CornersOfVertices sort_corners(std::span<const Triangle> triangles, std::size_t vertex_count) {
  CornersOfVertices result{std::vector<std::uint64_t>(vertex_count + 1),
                           std::vector<std::uint64_t>(3 * triangles.size())};
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t.v) ++result.first[v + 1];
  for (std::size_t v = 0; v < vertex_count; ++v) result.first[v + 1] += result.first[v];
  std::vector<std::uint64_t> next(result.first.begin(), result.first.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) result.corners[next[triangles[t].v[k]]++] = 3 * t + k;
  return result;
}

}  // namespace

RawWedges make_wedges(std::span<const Triangle> triangles, std::size_t vertex_count,
                      const CornerAttributes& attributes) {
  const CornersOfVertices sorted = sort_corners(triangles, vertex_count);
  WedgeMaker maker(triangles, attributes);
  for (std::size_t v = 0; v < vertex_count; ++v)
    maker.add_vertex(static_cast<std::uint32_t>(v),
                     std::span(sorted.corners).subspan(sorted.first[v], sorted.first[v + 1] - sorted.first[v]));
  return std::move(maker).result();
}

}  // namespace lodestone
