#include "render/reconstruct/gather.h"

#include <algorithm>

#include "render/reconstruct/condense_map.h"

namespace lodestone {
namespace {

constexpr std::uint8_t beside_border = 1, on_border = 2, on_rim = 4;

struct Around {
  std::uint8_t p = 0, q = 0, r = 0, s = 0;  // the cells in which the pixel is that corner
};

Around cells_around(const std::vector<std::uint8_t>& cells, std::size_t i, std::size_t width) {
  return {cells[i], i >= 1 ? cells[i - 1] : std::uint8_t{0}, i >= width ? cells[i - width] : std::uint8_t{0},
          i >= width + 1 ? cells[i - width - 1] : std::uint8_t{0}};
}

bool is_vertex(const Around& a) {
  return (a.p & (cell_prs | cell_psq | cell_prq)) || (a.q & (cell_psq | cell_prq | cell_rsq)) ||
         (a.r & (cell_prs | cell_prq | cell_rsq)) || (a.s & (cell_prs | cell_psq | cell_rsq));
}

// Whether triangles fill the corner of each cell.
bool is_surrounded(const Around& a) {
  constexpr unsigned first = cell_prs | cell_psq, second = cell_prq | cell_rsq;
  const auto full = [](unsigned cell, unsigned pair, unsigned single) {
    return (cell & pair) == pair || (cell & single);
  };
  return full(a.p, first, cell_prq) && full(a.q, second, cell_psq) && full(a.r, second, cell_prs) &&
         full(a.s, first, cell_rsq);
}

std::size_t width_of(const MergeView& view) { return static_cast<std::size_t>(view.map->view.width); }

// Mean of the triangles around a pixel, weighted by area: what the surface looks like at this resolution.
Vec3f surface_normal(const MergeView& view, std::size_t i) {
  const auto width = static_cast<std::uint32_t>(width_of(view));
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

// Of each pixel of a view: whether it is a border vertex, a rim one, or within two pixels of a border.
std::vector<std::uint8_t> border_flags(const MergeView& view) {
  const std::size_t width = width_of(view), height = static_cast<std::size_t>(view.map->view.height);
  std::vector<std::uint8_t> flags(view.kept.size(), 0);
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const Around kept = cells_around(view.kept, i, width);
    if (!is_vertex(kept) || is_surrounded(kept)) continue;
    const Around all = cells_around(view.mesh.cells, i, width);
    const bool rim = kept.p == all.p && kept.q == all.q && kept.r == all.r && kept.s == all.s;
    flags[i] |= rim ? on_border | on_rim : on_border;
    const std::size_t x = i % width, y = i / width;
    for (std::size_t ny = y - std::min<std::size_t>(y, 2); ny <= std::min(y + 2, height - 1); ++ny)
      for (std::size_t nx = x - std::min<std::size_t>(x, 2); nx <= std::min(x + 2, width - 1); ++nx)
        flags[ny * width + nx] |= beside_border;
  }
  return flags;
}

}  // namespace

std::vector<RowBlock> row_blocks(std::span<const MergeView> views) {
  std::vector<RowBlock> blocks;
  for (std::size_t v = 0; v < views.size(); ++v)
    for (int y = 0; y < views[v].map->view.height; y += block_rows)
      blocks.push_back({v, y, std::min(y + block_rows, views[v].map->view.height)});
  return blocks;
}

void for_blocks(std::span<const RowBlock> blocks, Scheduler& scheduler,
                const std::function<void(const RowBlock&, std::size_t)>& body) {
  scheduler.for_chunks(blocks.size(), 1, [&](ChunkRange range) { body(blocks[range.index], range.index); });
}

Gathered gather(std::span<const MergeView> views, CellChoice cells, Scheduler& scheduler) {
  Gathered result;
  for (const MergeView& view : views) result.number.emplace_back(view.map->view.pixels());
  const std::vector<RowBlock> blocks = row_blocks(views);
  std::vector<std::size_t> vertices(blocks.size() + 1, 0), triangles(blocks.size() + 1, 0);
  const auto for_pixels = [&](const RowBlock& block, const auto& visit) {
    const std::size_t width = width_of(views[block.view]);
    for (std::size_t i = static_cast<std::size_t>(block.first) * width;
         i < static_cast<std::size_t>(block.last) * width; ++i)
      visit(i);
  };
  for_blocks(blocks, scheduler, [&](const RowBlock& block, std::size_t k) {
    const auto& chosen = cells(views[block.view]);
    for_pixels(block, [&](std::size_t i) {
      if (is_vertex(cells_around(chosen, i, width_of(views[block.view])))) ++vertices[k + 1];
      triangles[k + 1] += static_cast<std::size_t>(__builtin_popcount(chosen[i] & cell_triangles));
    });
  });
  for (std::size_t k = 0; k < blocks.size(); ++k) vertices[k + 1] += vertices[k], triangles[k + 1] += triangles[k];
  MergedMesh& mesh = result.mesh;
  mesh.position.resize(vertices.back()), mesh.normal.resize(vertices.back()), mesh.view.resize(vertices.back());
  mesh.pixel.resize(vertices.back()), mesh.feature.resize(vertices.back()), mesh.triangles.resize(triangles.back());
  for_blocks(blocks, scheduler, [&](const RowBlock& block, std::size_t k) {
    const MergeView& view = views[block.view];
    std::size_t next = vertices[k];
    for_pixels(block, [&](std::size_t i) {
      if (!is_vertex(cells_around(cells(view), i, width_of(view)))) return;
      result.number[block.view][i] = static_cast<std::uint32_t>(next);
      mesh.position[next] = view.vertex.empty() ? view.map->position[i] : view.vertex[i];
      mesh.feature[next] = !view.links.empty() && (view.links[i] & on_feature) != 0;
      mesh.normal[next] = view.map->normal[i];
      mesh.view[next] = static_cast<ViewNumber>(block.view);
      mesh.pixel[next] = static_cast<std::uint32_t>(i);
      ++next;
    });
  });
  for_blocks(blocks, scheduler, [&](const RowBlock& block, std::size_t k) {
    const MergeView& view = views[block.view];
    const auto& number = result.number[block.view];
    std::size_t next = triangles[k];
    for_pixels(block, [&](std::size_t i) {
      if (const std::uint8_t cell = cells(view)[i])
        for_triangles_of_cell(cell, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(width_of(view)),
                              [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                                mesh.triangles[next++] = {{number[a], number[b], number[c]}};
                              });
    });
  });
  return result;
}

CutOut cut_out_seams(std::span<const MergeView> views, std::span<const std::uint32_t> parts, Gathered& gathered,
                     Scheduler& scheduler) {
  MergedMesh& mesh = gathered.mesh;
  std::vector<std::vector<std::uint8_t>> flags(views.size());
  scheduler.for_chunks(views.size(), 1,
                       [&](ChunkRange range) { flags[range.index] = border_flags(views[range.index]); });
  const auto flag = [&](std::uint32_t v) { return flags[mesh.view[v]][mesh.pixel[v]]; };
  CutOut part;
  std::vector<std::uint32_t> local(mesh.position.size(), EditMesh::none);
  std::vector<Triangle> cut;
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const bool near = std::any_of(t.v.begin(), t.v.end(), [&](std::uint32_t v) { return flag(v) & beside_border; });
    if (near) cut.push_back(t);
    return near;
  });
  for (Triangle& t : cut)
    for (std::uint32_t& v : t.v) {
      if (local[v] == EditMesh::none) {
        local[v] = static_cast<std::uint32_t>(part.vertex.size());
        part.vertex.push_back(v);
      }
      v = local[v];
    }
  SeamMesh& seam = part.seam;
  const std::size_t count = part.vertex.size();
  seam.position.resize(count), seam.normal.resize(count), seam.frozen.resize(count), seam.rim.resize(count);
  seam.part.resize(count);
  seam.mesh = EditMesh(count);
  scheduler.for_chunks(count, 4096, [&](ChunkRange range) {
    for (std::size_t k = range.begin; k < range.end; ++k) {
      const std::uint32_t v = part.vertex[k];
      seam.position[k] = mesh.position[v];
      seam.normal[k] = surface_normal(views[mesh.view[v]], mesh.pixel[v]);
      seam.frozen[k] = !(flag(v) & beside_border);
      seam.rim[k] = (flag(v) & on_rim) != 0;
      seam.part[k] = parts.empty() ? 0 : parts[views[mesh.view[v]].map->triangle[mesh.pixel[v]]];
    }
  });
  for (const Triangle& t : cut) seam.mesh.add(t.v[0], t.v[1], t.v[2]);
  return part;
}

void put_back(const CutOut& part, MergedMesh& mesh) {
  std::vector<std::uint32_t> global = part.vertex;
  for (std::size_t k = global.size(); k < part.seam.position.size(); ++k) {
    global.push_back(static_cast<std::uint32_t>(mesh.position.size()));
    mesh.position.push_back(part.seam.position[k]);
    mesh.normal.push_back(part.seam.normal[k]);
    mesh.view.push_back(no_view);
    mesh.pixel.push_back(0);
    mesh.feature.push_back(0);
  }
  for (std::uint32_t t = 0; t < part.seam.mesh.triangle_count(); ++t) {
    if (!part.seam.mesh.alive(t)) continue;
    const auto& v = part.seam.mesh.triangle(t).v;
    mesh.triangles.push_back({{global[v[0]], global[v[1]], global[v[2]]}});
  }
}

}  // namespace lodestone
