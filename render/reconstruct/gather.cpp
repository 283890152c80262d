#include "render/reconstruct/gather.h"

#include <algorithm>
#include <utility>

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

template <class Visit>
void for_pixels(std::span<const MergeView> views, const RowBlock& block, const Visit& visit) {
  const std::size_t width = width_of(views[block.view]);
  for (std::size_t i = static_cast<std::size_t>(block.first) * width; i < static_cast<std::size_t>(block.last) * width;
       ++i)
    visit(i);
}

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

PixelFlags find_borders(std::span<const MergeView> views, Scheduler& scheduler) {
  PixelFlags flags;
  for (const MergeView& view : views) flags.emplace_back(view.kept.size());
  const std::vector<RowBlock> blocks = row_blocks(views);
  for_blocks(blocks, scheduler, [&](const RowBlock& block, std::size_t) {
    const MergeView& view = views[block.view];
    for_pixels(views, block, [&](std::size_t i) {
      const std::size_t width = width_of(view);
      const Around kept = cells_around(view.kept, i, width);
      if (!is_vertex(kept) || is_surrounded(kept)) return;
      const Around all = cells_around(view.mesh.cells, i, width);
      const bool rim = kept.p == all.p && kept.q == all.q && kept.r == all.r && kept.s == all.s;
      flags[block.view][i] = rim ? on_border | on_rim : on_border;
    });
  });
  // A row's pixels are beside those of two rows up and down: found from there, so that no two tasks write to one row.
  PixelFlags spread = flags;
  for_blocks(blocks, scheduler, [&](const RowBlock& block, std::size_t) {
    const auto& own = flags[block.view];
    const std::size_t width = width_of(views[block.view]), height = own.size() / width;
    for_pixels(views, block, [&](std::size_t i) {
      const std::size_t x = i % width, y = i / width;
      unsigned near = 0;
      for (std::size_t ny = y - std::min<std::size_t>(y, 2); ny <= std::min(y + 2, height - 1); ++ny)
        for (std::size_t nx = x - std::min<std::size_t>(x, 2); nx <= std::min(x + 2, width - 1); ++nx)
          near |= own[ny * width + nx];
      if (near & on_border) spread[block.view][i] |= beside_border;
    });
  });
  return spread;
}

namespace {

// How much a block of rows holds, and, summed up, where it begins.
struct Amounts {
  std::size_t settled = 0, beside = 0;  // vertices
  std::size_t triangles = 0, beside_triangles = 0;
};

class Gatherer {
 public:
  Gatherer(std::span<const MergeView> views, CellChoice cells, const PixelFlags& flags, Scheduler& scheduler)
      : views_(views), cells_(cells), flags_(flags), scheduler_(scheduler), blocks_(row_blocks(views)) {}

  Gathered run() {
    for (const MergeView& view : views_) number_.emplace_back(view.map->view.pixels());
    const Amounts all = count();
    Gathered result;
    result.settled = all.settled;
    MergedMesh& mesh = result.mesh;
    const std::size_t vertices = all.settled + all.beside;
    mesh.position.resize(vertices), mesh.normal.resize(vertices), mesh.view.resize(vertices);
    mesh.pixel.resize(vertices), mesh.feature.resize(vertices);
    mesh.triangles.resize(all.triangles), result.beside.resize(all.beside_triangles);
    for_blocks(blocks_, scheduler_, [&](const RowBlock& b, std::size_t k) { take_vertices(b, first_[k], mesh); });
    for_blocks(blocks_, scheduler_, [&](const RowBlock& b, std::size_t k) { take_triangles(b, first_[k], result); });
    return result;
  }

 private:
  [[nodiscard]] bool is_beside(std::size_t view, std::size_t i) const {
    return !flags_.empty() && (flags_[view][i] & beside_border) != 0;
  }
  [[nodiscard]] const std::vector<std::uint8_t>& cells_of(std::size_t view) const { return cells_(views_[view]); }

  template <class Visit>
  void for_triangles(const RowBlock& block, const Visit& visit) const {
    const auto& cells = cells_of(block.view);
    const auto width = static_cast<std::uint32_t>(width_of(views_[block.view]));
    for_pixels(views_, block, [&](std::size_t i) {
      if (cells[i] == 0) return;
      for_triangles_of_cell(
          cells[i], static_cast<std::uint32_t>(i), width, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            visit(a, b, c, is_beside(block.view, a) || is_beside(block.view, b) || is_beside(block.view, c));
          });
    });
  }

  Amounts count() {
    first_.resize(blocks_.size());
    for_blocks(blocks_, scheduler_, [&](const RowBlock& block, std::size_t k) {
      Amounts own;
      for_pixels(views_, block, [&](std::size_t i) {
        if (is_vertex(cells_around(cells_of(block.view), i, width_of(views_[block.view]))))
          ++(is_beside(block.view, i) ? own.beside : own.settled);
      });
      for_triangles(block, [&](auto, auto, auto, bool beside) { ++(beside ? own.beside_triangles : own.triangles); });
      first_[k] = own;
    });
    Amounts sum;
    for (Amounts& block : first_) {
      const Amounts own = std::exchange(block, sum);
      sum = {sum.settled + own.settled, sum.beside + own.beside, sum.triangles + own.triangles,
             sum.beside_triangles + own.beside_triangles};
    }
    for (Amounts& block : first_) block.beside += sum.settled;
    return sum;
  }

  void take_vertices(const RowBlock& block, Amounts next, MergedMesh& mesh) {
    const MergeView& view = views_[block.view];
    for_pixels(views_, block, [&](std::size_t i) {
      if (!is_vertex(cells_around(cells_of(block.view), i, width_of(view)))) return;
      const std::size_t v = (is_beside(block.view, i) ? next.beside : next.settled)++;
      number_[block.view][i] = static_cast<std::uint32_t>(v);
      mesh.position[v] = view.vertex.empty() ? view.map->position[i] : view.vertex[i];
      mesh.feature[v] = !view.links.empty() && (view.links[i] & on_feature) != 0;
      mesh.normal[v] = view.map->normal[i];
      mesh.view[v] = static_cast<ViewNumber>(block.view);
      mesh.pixel[v] = static_cast<std::uint32_t>(i);
    });
  }

  void take_triangles(const RowBlock& block, Amounts next, Gathered& result) const {
    const auto& number = number_[block.view];
    for_triangles(block, [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, bool beside) {
      Triangle& t = beside ? result.beside[next.beside_triangles++] : result.mesh.triangles[next.triangles++];
      t = {{number[a], number[b], number[c]}};
    });
  }

  std::span<const MergeView> views_;
  CellChoice cells_;
  const PixelFlags& flags_;
  Scheduler& scheduler_;
  std::vector<RowBlock> blocks_;
  std::vector<Amounts> first_;
  std::vector<std::vector<std::uint32_t>> number_;  // of each view's pixels; not set where a pixel is no vertex
};

}  // namespace

Gathered gather(std::span<const MergeView> views, CellChoice cells, const PixelFlags& flags, Scheduler& scheduler) {
  return Gatherer(views, cells, flags, scheduler).run();
}

CutOut cut_out_seams(std::span<const MergeView> views, std::span<const std::uint32_t> parts, const PixelFlags& flags,
                     const Gathered& gathered, Scheduler& scheduler) {
  const MergedMesh& mesh = gathered.mesh;
  CutOut part;
  std::vector<std::uint32_t> local(mesh.position.size(), EditMesh::none);
  std::vector<Triangle> triangles = gathered.beside;
  for (Triangle& t : triangles)
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
  seam.part.resize(count), seam.border.resize(count);
  seam.mesh = EditMesh(count);
  scheduler.for_chunks(count, 4096, [&](ChunkRange range) {
    for (std::size_t k = range.begin; k < range.end; ++k) {
      const std::uint32_t v = part.vertex[k];
      const std::uint8_t flag = flags[mesh.view[v]][mesh.pixel[v]];
      seam.position[k] = mesh.position[v];
      seam.normal[k] = surface_normal(views[mesh.view[v]], mesh.pixel[v]);
      seam.frozen[k] = !(flag & beside_border);
      seam.rim[k] = (flag & on_rim) != 0;
      seam.border[k] = (flag & on_border) != 0;
      seam.part[k] = parts.empty() ? 0 : parts[views[mesh.view[v]].map->triangle[mesh.pixel[v]]];
    }
  });
  for (const Triangle& t : triangles) seam.mesh.add(t.v[0], t.v[1], t.v[2]);
  return part;
}

void put_back(const CutOut& part, Gathered& gathered) {
  MergedMesh& mesh = gathered.mesh;
  const MergedMesh before = [&] {  // what is beside a border, as it was
    MergedMesh tail;
    const auto from = static_cast<std::ptrdiff_t>(gathered.settled);
    tail.normal.assign(mesh.normal.begin() + from, mesh.normal.end());
    tail.view.assign(mesh.view.begin() + from, mesh.view.end());
    tail.pixel.assign(mesh.pixel.begin() + from, mesh.pixel.end());
    tail.feature.assign(mesh.feature.begin() + from, mesh.feature.end());
    return tail;
  }();
  const std::size_t settled = gathered.settled;
  mesh.position.resize(settled), mesh.normal.resize(settled), mesh.view.resize(settled), mesh.pixel.resize(settled);
  mesh.feature.resize(settled);
  std::vector<std::uint32_t> global(part.seam.position.size(), EditMesh::none);
  for (std::uint32_t k = 0; k < global.size(); ++k) {
    const bool old = k < part.vertex.size();
    if (old && part.vertex[k] < settled) {
      global[k] = part.vertex[k];
      continue;
    }
    if (part.seam.mesh.around(k).empty()) continue;
    global[k] = static_cast<std::uint32_t>(mesh.position.size());
    const std::size_t was = old ? part.vertex[k] - settled : 0;
    mesh.position.push_back(part.seam.position[k]);
    mesh.normal.push_back(old ? before.normal[was] : part.seam.normal[k]);
    mesh.view.push_back(old ? before.view[was] : no_view);
    mesh.pixel.push_back(old ? before.pixel[was] : 0);
    mesh.feature.push_back(old ? before.feature[was] : std::uint8_t{0});
  }
  for (std::uint32_t t = 0; t < part.seam.mesh.triangle_count(); ++t) {
    if (!part.seam.mesh.alive(t)) continue;
    const auto& v = part.seam.mesh.triangle(t).v;
    mesh.triangles.push_back({{global[v[0]], global[v[1]], global[v[2]]}});
  }
}

}  // namespace lodestone
