#include "render/reconstruct/merge/cut_out.h"

#include <algorithm>
#include <utility>

namespace lodestone {
namespace {

// Mean normal of the triangles around a pixel, weighted by area: that of the surface at this resolution.
Vec3f surface_normal(const MergeView& view, std::size_t i) {
  const auto width = static_cast<std::uint32_t>(view.map->view.width);
  const auto pixel = static_cast<std::uint32_t>(i);
  Vec3f sum;
  for (const std::uint32_t back : {0u, 1u, width, width + 1}) {
    if (pixel < back || view.mesh.cells[pixel - back] == 0) continue;
    for_triangles_of_cell(view.mesh.cells[pixel - back], pixel - back, width,
                          [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                            if (a != pixel && b != pixel && c != pixel) return;
                            const auto& p = view.map->position;
                            sum = sum + cross(p[b] - p[a], p[c] - p[a]);
                          });
  }
  const float norm = length(sum);
  return norm > 0 ? (1 / norm) * sum : view.map->normal[i];
}

// The cell of a view that a triangle of its pixels lies in: its upper left pixel.
std::size_t cell_of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t width) {
  return std::min({a / width, b / width, c / width}) * width + std::min({a % width, b % width, c % width});
}

struct FoundEdge {
  VertexId from, to, beyond;  // and where the border goes on from `to`
  std::uint32_t patch = 0;
  TriangleId triangle;  // inside of it
};

BorderLoops link_borders(std::span<const std::vector<FoundEdge>> found, std::size_t vertices, std::size_t patches) {
  BorderLoops borders(vertices);
  std::vector<std::uint32_t> patch_of_edge;
  for (const auto& chunk : found)
    for (const FoundEdge& e : chunk) {
      borders.add_edge(e.from, e.to);
      patch_of_edge.push_back(e.patch);
    }
  BorderEdgeId k;
  for (const auto& chunk : found)
    for (const FoundEdge& e : chunk) {
      borders.link(k, borders.find(e.to, e.beyond));
      ++k;
    }
  borders.label(patch_of_edge, patches);
  return borders;
}

}  // namespace

SeamMesh cut_out_seams(std::span<const MergeView> views, std::span<const std::uint32_t> parts, const PixelFlags& flags,
                       const ViewPatches& patches, Gathered& gathered, Scheduler& scheduler) {
  const MergedMesh& mesh = gathered.mesh;
  const std::size_t first = gathered.far, count = mesh.position.size() - first;
  constexpr std::size_t grain = 4096;
  std::vector<Triangle> triangles = std::move(gathered.beside);
  scheduler.for_chunks(triangles.size(), 4 * grain, [&](ChunkRange range) {
    for (std::size_t t = range.begin; t < range.end; ++t)
      for (std::uint32_t& v : triangles[t].v) v -= static_cast<std::uint32_t>(first);
  });
  SeamMesh seam;
  seam.mesh = EditMesh(count, std::move(triangles));
  seam.position.resize(count), seam.normal.resize(count), seam.frozen.resize(count), seam.rim.resize(count);
  seam.part.resize(count);
  std::vector<std::vector<FoundEdge>> found(chunk_count(count, grain));
  scheduler.for_chunks(count, grain, [&](ChunkRange range) {
    for (std::size_t k = range.begin; k < range.end; ++k) {
      const MergeView& view = views[mesh.view[first + k]];
      const std::uint32_t pixel = mesh.pixel[first + k];
      const std::uint8_t flag = flags[mesh.view[first + k]][pixel];
      seam.position[k] = mesh.position[first + k];
      seam.normal[k] = surface_normal(view, pixel);
      seam.frozen[k] = !(flag & beside_border);
      seam.rim[k] = (flag & on_rim) != 0;
      seam.part[k] = parts.empty() ? 0 : parts[view.map->triangle[pixel]];
      if (!(flag & on_border)) continue;
      const VertexId v(k);
      for (const TriangleId t : seam.mesh.around(v)) {
        const auto c = seam.mesh.corners(t);
        const VertexId to = c[0] == v ? c[1] : c[1] == v ? c[2] : c[0];
        if (seam.mesh.at(to, v) != EditMesh::none) continue;
        const std::size_t cell = cell_of(mesh.pixel[first + c[0]], mesh.pixel[first + c[1]], mesh.pixel[first + c[2]],
                                         static_cast<std::uint32_t>(view.map->view.width));
        found[range.index].push_back(
            {v, to, seam.mesh.next_on_border(v, to), patches.of_cell[mesh.view[first + k]][cell], t});
      }
    }
  });
  seam.borders = link_borders(found, count, patches.triangles.size());
  seam.patch_seed.assign(patches.triangles.size(), EditMesh::none);
  for (const auto& chunk : found)
    for (const FoundEdge& e : chunk) seam.patch_seed[e.patch] = e.triangle;
  return seam;
}

void put_back(const SeamMesh& seam, Gathered& gathered) {
  MergedMesh& mesh = gathered.mesh;
  const std::size_t first = gathered.far, old = mesh.position.size() - first;
  std::vector<std::uint32_t> number(seam.position.size(), EditMesh::no_vertex);
  std::size_t next = first;
  for (VertexId k{0}; k < old; ++k) {  // moves towards the front, never over entries still to be moved
    if (k >= gathered.frozen && seam.mesh.around(k).empty()) continue;
    const std::size_t was = first + k;
    mesh.position[next] = seam.position[k], mesh.normal[next] = mesh.normal[was];
    mesh.view[next] = mesh.view[was], mesh.pixel[next] = mesh.pixel[was], mesh.feature[next] = mesh.feature[was];
    number[k] = static_cast<std::uint32_t>(next++);
  }
  const auto resize = [&] {
    mesh.position.resize(next), mesh.normal.resize(next), mesh.view.resize(next, no_view), mesh.pixel.resize(next);
    mesh.feature.resize(next);
  };
  resize();
  for (VertexId k(old); k < number.size(); ++k)
    if (!seam.mesh.around(k).empty()) number[k] = static_cast<std::uint32_t>(next++);
  resize();
  for (VertexId k(old); k < number.size(); ++k)
    if (number[k] != EditMesh::no_vertex)
      mesh.position[number[k]] = seam.position[k], mesh.normal[number[k]] = seam.normal[k];
  for (TriangleId t{0}; t < seam.mesh.triangle_count(); ++t) {
    if (!seam.mesh.alive(t)) continue;
    const auto& v = seam.mesh.triangle(t).v;
    mesh.triangles.push_back({{number[v[0]], number[v[1]], number[v[2]]}});
  }
}

}  // namespace lodestone
