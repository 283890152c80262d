#include <algorithm>
#include <cmath>
#include <limits>

#include "render/reconstruct/seams/seam_mesh.h"

namespace lodestone {
namespace {

using Loop = std::vector<VertexId>;

// Every loop of border edges.
std::vector<Loop> border_loops(const SeamMesh& seam) {
  std::vector<Loop> loops;
  std::vector<bool> done(seam.borders.edge_count(), false);
  for (BorderEdgeId e{0}; e < done.size(); ++e) {
    if (!seam.borders.alive(e) || done[e]) continue;
    Loop& loop = loops.emplace_back();
    for (BorderEdgeId f = e; !done[f]; f = seam.borders.edge(f).next) {
      done[f] = true;
      loop.push_back(seam.borders.edge(f).from);
    }
  }
  return loops;
}

double perimeter(const SeamMesh& seam, const Loop& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    sum += length(seam.position[loop[(i + 1) % loop.size()]] - seam.position[loop[i]]);
  return sum;
}

// True if a step across an edge, out of the surface, ends beyond the border of the model.
bool ends_at(const SeamMesh& seam, VertexId from, VertexId to) {
  const TriangleId inside = seam.mesh.at(from, to);
  const Vec3f along = seam.position[to] - seam.position[from];
  const Vec3f across = cross(along, area_vector(seam, from, to, seam.mesh.opposite(inside, from, to)));
  const float size = length(across);
  const Vec3f step = size > 0 ? (0.5f * length(along) / size) * across : Vec3f{};
  return seam.model_border->is_beyond(0.5f * (seam.position[from] + seam.position[to]) + step);
}

// Around a gap of the model, not one between pieces of its surface.
bool is_outline(const SeamMesh& seam, const Loop& loop) {
  if (!std::all_of(loop.begin(), loop.end(), [&](VertexId v) { return seam.rim[v] != 0; })) return false;
  if (!seam.model_border) return true;
  std::size_t ends = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) ends += ends_at(seam, loop[i], loop[(i + 1) % loop.size()]);
  return 2 * ends >= loop.size();
}

// Ears are cut where the new triangle is roundest and agrees best with the normals. If none fits, a new vertex in the
// middle closes the rest.
class HoleFiller {
 public:
  HoleFiller(SeamMesh& seam, Loop loop) : s_(seam), loop_(std::move(loop)) {}

  std::size_t run() {
    std::size_t added = 0;
    cost_.resize(loop_.size());
    for (std::size_t i = 0; i < loop_.size(); ++i) cost_[i] = cost(i);
    while (loop_.size() > 3) {
      const auto least = std::min_element(cost_.begin(), cost_.end());
      if (!(*least < impossible)) return added + fan();
      const auto best = static_cast<std::size_t>(least - cost_.begin());
      if (s_.mesh.add(after(best), loop_[best], before(best)) == EditMesh::none) {
        *least = impossible;  // another ear has taken the chord
        continue;
      }
      ++added;
      loop_.erase(loop_.begin() + static_cast<std::ptrdiff_t>(best));
      cost_.erase(least);
      for (const std::size_t i : {(best + loop_.size() - 1) % loop_.size(), best % loop_.size()}) cost_[i] = cost(i);
    }
    if (loop_.size() == 3 && s_.mesh.add(loop_[2], loop_[1], loop_[0]) != EditMesh::none) return added + 1;
    return loop_.size() == 3 ? added + fan() : added;
  }

 private:
  [[nodiscard]] VertexId before(std::size_t i) const { return loop_[(i + loop_.size() - 1) % loop_.size()]; }
  [[nodiscard]] VertexId after(std::size_t i) const { return loop_[(i + 1) % loop_.size()]; }

  [[nodiscard]] float cost(std::size_t i) const {
    const VertexId a = before(i), b = loop_[i], c = after(i);
    // The chord must not be an edge yet.
    if (s_.mesh.at(a, c) != EditMesh::none || s_.mesh.at(c, a) != EditMesh::none) return impossible;
    const Vec3f area = area_vector(s_, c, b, a), mean = s_.normal[a] + s_.normal[b] + s_.normal[c];
    const float size = length(area), norm = length(mean), chord = length(s_.position[c] - s_.position[a]);
    const float facing = size > 0 && norm > 0 ? dot(area, mean) / (size * norm) : -1;
    return chord * (facing > 0 ? 2 - facing : 4 - 4 * facing);
  }

  std::size_t fan() {
    Vec3f middle, normal;
    for (const VertexId v : loop_) middle = middle + s_.position[v], normal = normal + s_.normal[v];
    const float norm = length(normal);
    const VertexId centre = s_.add_vertex((1 / static_cast<float>(loop_.size())) * middle,
                                          norm > 0 ? (1 / norm) * normal : Vec3f{}, loop_.front());
    std::size_t added = 0;
    for (std::size_t i = 0; i < loop_.size(); ++i) added += s_.mesh.add(after(i), loop_[i], centre) != EditMesh::none;
    return added;
  }

  static constexpr float impossible = std::numeric_limits<float>::infinity();
  SeamMesh& s_;
  Loop loop_;
  std::vector<float> cost_;
};

}  // namespace

VertexId SeamMesh::add_vertex(Vec3f p, Vec3f n, VertexId like) {
  position.push_back(p);
  normal.push_back(n);
  frozen.push_back(0);
  rim.push_back(rim[like]);
  part.push_back(part[like]);
  (void)borders.add_vertex();
  return mesh.add_vertex();
}

FillResult fill_holes(SeamMesh& seam, const FillConfig& config) {
  FillResult result;
  for (const Loop& loop : border_loops(seam)) {
    const double around = perimeter(seam, loop);
    const bool wanted = config.rims || !is_outline(seam, loop);
    if (loop.size() < 3 || !wanted || around > config.longest * config.spacing) {
      ++result.open;
      result.open_length += around;
      continue;
    }
    result.triangles += HoleFiller(seam, loop).run();
    result.longest = std::max(result.longest, around);
    ++result.filled;
  }
  return result;
}

std::size_t drop_crumbs(SeamMesh& seam, std::span<const std::uint32_t> patch_triangles, const CrumbConfig& config) {
  std::vector<std::size_t> size(patch_triangles.size(), 0), largest;  // of each piece; of the pieces of each part
  for (std::uint32_t patch = 0; patch < size.size(); ++patch)
    size[seam.borders.united(patch)] += patch_triangles[patch];
  const auto part_of = [&](TriangleId seed) { return seam.part[seam.mesh.corners(seed)[0]]; };
  for (std::uint32_t patch = 0; patch < size.size(); ++patch) {
    const TriangleId seed = seam.patch_seed[patch];
    if (seed == EditMesh::none || !seam.mesh.alive(seed)) continue;
    if (part_of(seed) >= largest.size()) largest.resize(part_of(seed) + 1, 0);
    largest[part_of(seed)] = std::max(largest[part_of(seed)], size[seam.borders.united(patch)]);
  }
  const auto is_crumb = [&](std::uint32_t patch, std::uint32_t part) {
    const std::size_t own = size[seam.borders.united(patch)];
    const bool is_alone = own == largest[part] || (config.rest && part == 0);
    return own < (is_alone ? config.least : std::max(config.least, config.least_beside));
  };
  std::vector<TriangleId> piece;
  std::size_t dropped = 0;
  for (std::uint32_t patch = 0; patch < size.size(); ++patch) {
    const TriangleId seed = seam.patch_seed[patch];
    if (seed == EditMesh::none || !seam.mesh.alive(seed) || !is_crumb(patch, part_of(seed))) continue;
    piece.assign(1, seed);
    std::vector<VertexId> vertices;
    while (!piece.empty()) {
      const TriangleId t = piece.back();
      piece.pop_back();
      if (!seam.mesh.alive(t)) continue;
      const auto corners = seam.mesh.corners(t);
      seam.mesh.remove(t);
      ++dropped;
      for (const VertexId v : corners)
        piece.insert(piece.end(), seam.mesh.around(v).begin(), seam.mesh.around(v).end());
      vertices.insert(vertices.end(), corners.begin(), corners.end());
    }
    for (const VertexId v : vertices) seam.borders.forget(v);
  }
  return dropped;
}

std::size_t split_vertices(SeamMesh& seam) {
  std::size_t added = 0;
  for (const VertexId v : seam.borders.pinched())
    added += seam.mesh.part_fans(v, [&](const std::vector<TriangleId>& fan) {
      const VertexId own = seam.add_vertex(seam.position[v], seam.normal[v], v);
      for (BorderEdgeId e = seam.borders.first(v); e != BorderLoops::none; e = seam.borders.edge(e).sibling)
        if (std::find(fan.begin(), fan.end(), seam.mesh.at(v, seam.borders.edge(e).to)) != fan.end()) {
          seam.borders.move_start(e, own);
          break;
        }
      return own;
    });
  return added;
}

}  // namespace lodestone
