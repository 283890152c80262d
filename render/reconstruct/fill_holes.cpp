#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "render/reconstruct/seam_mesh.h"

namespace lodestone {
namespace {

using Loop = std::vector<std::uint32_t>;

// Loops of border edges, as they run; each passes a vertex once: what comes back to a vertex is a loop of its own.
std::vector<Loop> simple_loops(const SeamMesh& seam) {
  std::vector<Loop> loops;
  std::vector<std::vector<std::uint32_t>> done(seam.mesh.vertex_count());  // ends of edges that are in a loop
  const auto is_done = [&](std::uint32_t a, std::uint32_t b) {
    return std::find(done[a].begin(), done[a].end(), b) != done[a].end();
  };
  for (std::uint32_t v = 0; v < seam.mesh.vertex_count(); ++v) {
    if (!seam.border[v]) continue;
    for (const EditMesh::Gap& gap : seam.mesh.gaps(v)) {
      if (gap.next == EditMesh::none || !seam.is_border(v, gap.next) || is_done(v, gap.next)) continue;
      Loop path;
      std::unordered_map<std::uint32_t, std::size_t> place;
      std::uint32_t a = v, b = gap.next;
      while (b != EditMesh::none && !is_done(a, b)) {
        done[a].push_back(b);
        if (const auto at = place.find(a); at != place.end()) {
          loops.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(at->second), path.end());
          for (std::size_t k = at->second; k < path.size(); ++k)
            if (path[k] != a) place.erase(path[k]);
          path.resize(at->second);
        }
        place[a] = path.size();
        path.push_back(a);
        const std::uint32_t next = seam.mesh.next_on_border(a, b);
        a = b, b = next;
      }
      if (!path.empty()) loops.push_back(std::move(path));
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

bool is_outline(const SeamMesh& seam, const Loop& loop) {
  return std::all_of(loop.begin(), loop.end(), [&](std::uint32_t v) { return seam.rim[v] != 0; });
}

// Ears are cut where the new triangle is roundest and turned least against the normals. Where none fits, a new vertex
// in the middle takes the rest.
class HoleFiller {
 public:
  HoleFiller(SeamMesh& seam, Loop loop) : s_(seam), loop_(std::move(loop)) {}

  std::size_t run() {
    std::size_t added = 0;
    while (loop_.size() > 3) {
      std::size_t best = loop_.size();
      float least = std::numeric_limits<float>::infinity();
      for (std::size_t i = 0; i < loop_.size(); ++i)
        if (const float c = cost(i); c < least) least = c, best = i;
      if (best == loop_.size()) return added + fan();
      const std::uint32_t a = before(best), b = loop_[best], c = after(best);
      if (s_.mesh.add(c, b, a) == EditMesh::none) return added + fan();
      ++added;
      loop_.erase(loop_.begin() + static_cast<std::ptrdiff_t>(best));
    }
    if (loop_.size() == 3 && s_.mesh.add(loop_[2], loop_[1], loop_[0]) != EditMesh::none) ++added;
    return added;
  }

 private:
  [[nodiscard]] std::uint32_t before(std::size_t i) const { return loop_[(i + loop_.size() - 1) % loop_.size()]; }
  [[nodiscard]] std::uint32_t after(std::size_t i) const { return loop_[(i + 1) % loop_.size()]; }

  [[nodiscard]] float cost(std::size_t i) const {
    const std::uint32_t a = before(i), b = loop_[i], c = after(i);
    // The chord must not be an edge yet.
    if (s_.mesh.at(a, c) != EditMesh::none || s_.mesh.at(c, a) != EditMesh::none)
      return std::numeric_limits<float>::infinity();
    const Vec3f area = area_vector(s_, c, b, a), mean = s_.normal[a] + s_.normal[b] + s_.normal[c];
    const float size = length(area), norm = length(mean), chord = length(s_.position[c] - s_.position[a]);
    const float facing = size > 0 && norm > 0 ? dot(area, mean) / (size * norm) : -1;
    return chord * (facing > 0 ? 2 - facing : 4 - 4 * facing);
  }

  std::size_t fan() {
    Vec3f middle, normal;
    for (const std::uint32_t v : loop_) middle = middle + s_.position[v], normal = normal + s_.normal[v];
    const float norm = length(normal);
    const std::uint32_t centre = s_.mesh.add_vertex();
    s_.position.push_back((1 / static_cast<float>(loop_.size())) * middle);
    s_.normal.push_back(norm > 0 ? (1 / norm) * normal : Vec3f{});
    s_.frozen.push_back(0);
    s_.rim.push_back(0);
    s_.border.push_back(1);
    s_.part.push_back(s_.part[loop_.front()]);
    std::size_t added = 0;
    for (std::size_t i = 0; i < loop_.size(); ++i) added += s_.mesh.add(after(i), loop_[i], centre) != EditMesh::none;
    return added;
  }

  SeamMesh& s_;
  Loop loop_;
};

// One fan of triangles at a vertex, from a triangle on.
std::vector<std::uint32_t> fan_of(const EditMesh& mesh, std::uint32_t v, std::uint32_t first) {
  std::vector<std::uint32_t> fan{first};
  for (std::size_t k = 0; k < fan.size(); ++k)
    for (const std::uint32_t t : mesh.around(v)) {
      if (std::find(fan.begin(), fan.end(), t) != fan.end()) continue;
      const auto& c = mesh.triangle(fan[k]).v;
      for (const std::uint32_t w : c)
        if (w != v && (mesh.at(v, w) == t || mesh.at(w, v) == t)) {
          fan.push_back(t);
          break;
        }
    }
  return fan;
}

}  // namespace

FillResult fill_holes(SeamMesh& seam, const FillConfig& config) {
  FillResult result;
  for (const Loop& loop : simple_loops(seam)) {
    const double around = perimeter(seam, loop);
    const bool wanted = config.rims || !is_outline(seam, loop);
    if (loop.size() < 3 || !wanted || around > config.longest * config.spacing) {
      ++result.open;
      result.open_length += around;
      continue;
    }
    result.triangles += HoleFiller(seam, loop).run();
    ++result.filled;
  }
  return result;
}

std::size_t drop_crumbs(SeamMesh& seam, std::size_t least_triangles) {
  std::vector<std::uint8_t> reached(seam.mesh.triangle_count(), 0);
  std::vector<std::uint32_t> piece;
  std::size_t dropped = 0;
  for (std::uint32_t first = 0; first < seam.mesh.triangle_count(); ++first) {
    if (!seam.mesh.alive(first) || reached[first]) continue;
    piece.assign(1, first);
    reached[first] = 1;
    bool goes_on = false;  // outside of this part of the mesh
    for (std::size_t k = 0; k < piece.size(); ++k)
      for (const std::uint32_t v : seam.mesh.triangle(piece[k]).v) {
        goes_on |= seam.frozen[v] != 0;
        for (const std::uint32_t t : seam.mesh.around(v))
          if (!reached[t]) reached[t] = 1, piece.push_back(t);
      }
    if (goes_on || piece.size() >= least_triangles) continue;
    for (const std::uint32_t t : piece) seam.mesh.remove(t);
    dropped += piece.size();
  }
  return dropped;
}

std::size_t split_vertices(SeamMesh& seam) {
  std::size_t added = 0;
  const std::size_t count = seam.mesh.vertex_count();
  for (std::uint32_t v = 0; v < count; ++v) {
    if (seam.frozen[v] || !seam.border[v]) continue;  // inside of a grid all is one fan
    while (!seam.mesh.around(v).empty()) {
      const std::vector<std::uint32_t> fan = fan_of(seam.mesh, v, seam.mesh.around(v).front());
      if (fan.size() == seam.mesh.around(v).size()) break;
      const std::uint32_t own = seam.mesh.add_vertex();
      seam.position.push_back(seam.position[v]);
      seam.normal.push_back(seam.normal[v]);
      seam.frozen.push_back(0);
      seam.rim.push_back(seam.rim[v]);
      seam.border.push_back(seam.border[v]);
      seam.part.push_back(seam.part[v]);
      for (const std::uint32_t t : fan) {
        Triangle moved = seam.mesh.triangle(t);
        std::replace(moved.v.begin(), moved.v.end(), v, own);
        seam.mesh.remove(t);
        [[maybe_unused]] const std::uint32_t placed = seam.mesh.add(moved.v[0], moved.v[1], moved.v[2]);
      }
      ++added;
    }
  }
  return added;
}

}  // namespace lodestone
