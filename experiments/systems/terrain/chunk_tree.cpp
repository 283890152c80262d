#include "experiments/systems/terrain/chunk_tree.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/hierarchy/model/distance_metric.h"

namespace lodestone {
namespace {

constexpr std::size_t splits_per_chunk = ChunkTree::leaf_side * ChunkTree::leaf_side;  // two triangles each

float blend(float share, float own, float parent) {
  return share <= 0 ? own : share >= 1 ? parent : (1 - share) * own + share * parent;
}

}  // namespace

ChunkTree::ChunkTree(const HeightField& field) : field_(field), triangles_(field) {
  plan();
  choose_tolerances();
  for (Chunk& chunk : chunks_) fill(chunk);
}

void ChunkTree::plan() {
  chunks_.push_back({.square = {0, 0, triangles_.side()}});
  for (std::uint32_t c = 0; c < chunks_.size(); ++c) {
    const Square square = chunks_[c].square;
    const int level = chunks_[c].level, half = square.side / 2;
    if (square.side <= leaf_side) continue;
    chunks_[c].first_child = static_cast<std::uint32_t>(chunks_.size());
    for (const Square child : {Square{square.i, square.j, half},
                               {square.i + half, square.j, half},
                               {square.i, square.j + half, half},
                               {square.i + half, square.j + half, half}}) {
      if (child.i >= field_.columns() - 1 || child.j >= field_.rows() - 1) continue;  // beyond the field
      chunks_.push_back({.square = child, .level = level + 1, .parent = c});
      ++chunks_[c].child_count;
    }
  }
}

void ChunkTree::choose_tolerances() {
  std::vector<std::size_t> count(static_cast<std::size_t>(chunks_.back().level) + 1, 0);
  for (const Chunk& chunk : chunks_) ++count[static_cast<std::size_t>(chunk.level)];
  for (const std::size_t of_level : count) tolerances_.push_back(triangles_.tolerance_for(splits_per_chunk * of_level));
  tolerances_.back() = 0;
}

void ChunkTree::fill(Chunk& chunk) const {
  const Square& s = chunk.square;
  for (int j = s.j; j <= std::min(s.j + s.side, field_.rows() - 1); ++j)
    for (int i = s.i; i <= std::min(s.i + s.side, field_.columns() - 1); ++i)
      chunk.box.extend(field_.place({i, j}, field_.height({i, j})));
  triangulate(chunk);
  for (const Post p : chunk.posts)
    chunk.parent_heights.push_back(
        chunk.level == 0 ? field_.height(p) : triangles_.height(parent_square(chunk), tolerance(chunk.level - 1), p));
  find_rim(chunk);
}

void ChunkTree::triangulate(Chunk& chunk) const {
  const Square& s = chunk.square;
  std::vector<RightTriangles::Corners> corners;
  if (chunk.level < finest()) {
    corners = triangles_.cut(s, tolerance(chunk.level));
  } else {
    for (int j = s.j; j < std::min(s.j + s.side, field_.rows() - 1); ++j)
      for (int i = s.i; i < std::min(s.i + s.side, field_.columns() - 1); ++i) {
        const Post a{i, j}, b{i + 1, j}, c{i + 1, j + 1}, d{i, j + 1};
        const bool main = field_.has_main_diagonal(a);
        corners.push_back({a, b, main ? c : d});
        corners.push_back({main ? a : b, c, d});
      }
  }
  std::map<std::pair<int, int>, std::uint32_t> number;
  const auto number_of = [&](Post p) {
    const auto [at, is_new] = number.try_emplace({p.j, p.i}, static_cast<std::uint32_t>(chunk.posts.size()));
    if (is_new) chunk.posts.push_back(p);
    return at->second;
  };
  for (const auto& [a, b, c] : corners) {
    const std::uint32_t first = number_of(a), second = number_of(b), third = number_of(c);
    chunk.triangles.push_back(field_.facing({{first, second, third}}));
  }
}

// Edges along one side of the square, but not along the end of the field.
void ChunkTree::find_rim(Chunk& chunk) const {
  const Square& s = chunk.square;
  const auto along = [&](int a, int b, int first, int last) {
    return a == b && ((a == first && first > 0) || (a == first + s.side && a < last));
  };
  for (const auto& [v] : chunk.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Post a = chunk.posts[v[k]], b = chunk.posts[v[(k + 1) % 3]];
      if (along(a.i, b.i, s.i, field_.columns() - 1) || along(a.j, b.j, s.j, field_.rows() - 1))
        chunk.rim.push_back({v[k], v[(k + 1) % 3]});
    }
}

// The parent of a chunk that is drawn is not good enough, so that shares are below 1. They grow so that the error,
// which is then between those of the two levels, is seen as the tolerance.
std::vector<DrawnChunk> ChunkTree::chunks_for(Vec3f viewpoint, double reach) const {
  const auto away = [&](const Chunk& chunk) {
    return double{distance(DistanceMetric::euclidean, viewpoint, chunk.box)};
  };
  std::vector<DrawnChunk> drawn;
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t c = open.back();
    const Chunk& chunk = chunks_[c];
    open.pop_back();
    const double begin = tolerance(chunk.level) * reach;
    if (begin > away(chunk) && chunk.child_count > 0) {
      for (std::uint32_t k = 0; k < chunk.child_count; ++k) open.push_back(chunk.first_child + k);
      continue;
    }
    double share = 0;
    if (chunk.level > 0) {
      const double end = tolerance(chunk.level - 1) * reach;
      if (end > begin) share = std::clamp((away(chunks_[chunk.parent]) - begin) / (end - begin), 0.0, 1.0);
    }
    drawn.push_back({c, static_cast<float>(share)});
  }
  std::ranges::sort(drawn, {}, &DrawnChunk::chunk);
  return drawn;
}

float ChunkTree::drawn_height(const DrawnChunk& drawn, std::size_t post) const {
  const Chunk& chunk = chunks_[drawn.chunk];
  return blend(drawn.share, field_.height(chunk.posts[post]), chunk.parent_heights[post]);
}

float ChunkTree::height_over(const DrawnChunk& drawn, Post post) const {
  const Chunk& chunk = chunks_[drawn.chunk];
  const float own =
      chunk.level == finest() ? field_.height(post) : triangles_.height(chunk.square, tolerance(chunk.level), post);
  if (chunk.level == 0) return own;
  return blend(drawn.share, own, triangles_.height(parent_square(chunk), tolerance(chunk.level - 1), post));
}

}  // namespace lodestone
