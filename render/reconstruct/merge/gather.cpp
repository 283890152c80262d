#include "render/reconstruct/merge/gather.h"

#include <algorithm>
#include <utility>

#include "render/reconstruct/views/cell_corners.h"
#include "render/reconstruct/views/condense_map.h"

namespace lodestone {
namespace {

// True if triangles fill the corner of each cell.
bool is_surrounded(const CellsAround& a) {
  constexpr unsigned first = cell_prs | cell_psq, second = cell_prq | cell_rsq;
  const auto full = [](unsigned cell, unsigned pair, unsigned single) {
    return (cell & pair) == pair || (cell & single);
  };
  return full(a.p, first, cell_prq) && full(a.q, second, cell_psq) && full(a.r, second, cell_prs) &&
         full(a.s, first, cell_rsq);
}

std::size_t width_of(const MergeView& view) { return static_cast<std::size_t>(view.map->view.width); }

template <class Visit>
void for_pixels_of(std::span<const MergeView> views, const RowBlock& block, const Visit& visit) {
  for_pixels(views[block.view], block.first, block.last, visit);
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

namespace {

// Pixels of a few rows within one and within two pixels of a border, in a row.
class Spread {
 public:
  // Rows [first, last), of which those outside of the view repeat its outermost ones.
  Spread(const MergeView& view, const PixelArray<std::uint8_t>& flags, int first, int last)
      : first_(first), width_(width_of(view)), near_(static_cast<std::size_t>(last - first) * width_) {
    std::vector<std::uint8_t> row(width_ + 4, 0);
    for (int y = first; y < last; ++y) {
      const int real = std::clamp(y, 0, view.map->view.height - 1);
      const std::size_t begin = static_cast<std::size_t>(real) * width_;
      std::fill(row.begin(), row.end(), std::uint8_t{0});
      for_pixels(view, real, real + 1, [&](std::size_t i) { row[i - begin + 2] = flags[i] & on_border; });
      std::uint8_t* own = near_.data() + static_cast<std::size_t>(y - first) * width_;
      for (std::size_t x = 0; x < width_; ++x) {
        const unsigned one = row[x + 1] | row[x + 2] | row[x + 3];
        own[x] = static_cast<std::uint8_t>((one ? beside_border : 0) | (one | row[x] | row[x + 4] ? near_border : 0));
      }
    }
  }
  [[nodiscard]] const std::uint8_t* row(int y) const {
    return near_.data() + static_cast<std::size_t>(y - first_) * width_;
  }

 private:
  int first_;
  std::size_t width_;
  std::vector<std::uint8_t> near_;
};

// Marks pixels within one and two pixels of a border: along the rows first, then across them.
PixelFlags spread(std::span<const MergeView> views, std::span<const RowBlock> blocks, const PixelFlags& flags,
                  Scheduler& scheduler) {
  PixelFlags result(flags.size());
  scheduler.for_chunks(flags.size(), 1,
                       [&](ChunkRange range) { result[range.index] = flags[range.index].like<std::uint8_t>(); });
  for_blocks(blocks, scheduler, [&](const RowBlock& block, std::size_t) {
    const PixelArray<std::uint8_t>& own = flags[block.view];
    const Spread rows(views[block.view], own, block.first - 2, block.last + 2);
    for (int y = block.first; y < block.last; ++y) {
      const std::size_t begin = static_cast<std::size_t>(y) * width_of(views[block.view]);
      const std::uint8_t *a = rows.row(y - 2), *b = rows.row(y - 1), *c = rows.row(y), *d = rows.row(y + 1),
                         *e = rows.row(y + 2);
      for_pixels(views[block.view], y, y + 1, [&](std::size_t i) {
        const std::size_t x = i - begin;
        const unsigned one = b[x] | c[x] | d[x], two = one | a[x] | e[x];
        result[block.view][i] =
            static_cast<std::uint8_t>((own[i] & (on_border | on_rim)) | (one & beside_border) | (two & near_border));
      });
    }
  });
  return result;
}

}  // namespace

PixelFlags find_borders(std::span<const MergeView> views, Scheduler& scheduler) {
  PixelFlags flags(views.size());
  scheduler.for_chunks(views.size(), 1,
                       [&](ChunkRange range) { flags[range.index] = views[range.index].kept.like<std::uint8_t>(); });
  const std::vector<RowBlock> blocks = row_blocks(views);
  for_blocks(blocks, scheduler, [&](const RowBlock& block, std::size_t) {
    const MergeView& view = views[block.view];
    for_pixels_of(views, block, [&](std::size_t i) {
      const std::size_t width = width_of(view);
      const CellsAround kept = cells_around(view.kept, i, width);
      if (!is_vertex(kept) || is_surrounded(kept)) return;
      const CellsAround all = cells_around(view.mesh.cells, i, width);
      const bool rim = kept.p == all.p && kept.q == all.q && kept.r == all.r && kept.s == all.s;
      flags[block.view][i] = rim ? on_border | on_rim : on_border;
    });
  });
  return spread(views, blocks, flags, scheduler);
}

namespace {

// Size of a block of rows, and, summed up, its beginning.
struct Amounts {
  std::size_t far = 0, frozen = 0, beside = 0;  // vertices
  std::size_t triangles = 0, beside_triangles = 0;
};

class Gatherer {
 public:
  Gatherer(std::span<const MergeView> views, CellChoice cells, const PixelFlags& flags, Scheduler& scheduler)
      : views_(views), cells_(cells), flags_(flags), scheduler_(scheduler), blocks_(row_blocks(views)) {}

  Gathered run() {
    const Amounts all = count();
    Gathered result;
    result.far = all.far, result.frozen = all.frozen;
    MergedMesh& mesh = result.mesh;
    const std::size_t vertices = all.far + all.frozen + all.beside;
    // First touching memory takes as long as filling it: by all workers, too.
    number_.resize(views_.size());
    scheduler_.for_chunks(views_.size() + 5, 1, [&](ChunkRange range) {
      switch (range.index) {
        case 0:  // with room for what comes between the pieces
          mesh.triangles.reserve(all.triangles + all.beside_triangles + all.beside_triangles / 2);
          return mesh.triangles.resize(all.triangles);
        case 1:
          return mesh.position.resize(vertices);
        case 2:
          return mesh.normal.resize(vertices);
        case 3:
          return mesh.view.resize(vertices), mesh.feature.resize(vertices), mesh.pixel.resize(vertices);
        case 4:
          return result.beside.resize(all.beside_triangles);
        default:
          number_[range.index - 5] = views_[range.index - 5].map->triangle.like<std::uint32_t>();
      }
    });
    for_blocks(blocks_, scheduler_, [&](const RowBlock& b, std::size_t k) { take_vertices(b, first_[k], mesh); });
    for_blocks(blocks_, scheduler_, [&](const RowBlock& b, std::size_t k) { take_triangles(b, first_[k], result); });
    return result;
  }

 private:
  [[nodiscard]] bool is_beside(std::size_t view, std::size_t i) const {
    return !flags_.empty() && (flags_[view][i] & beside_border) != 0;
  }
  [[nodiscard]] std::size_t& count_of(std::size_t view, std::size_t i, Amounts& amounts) const {
    const unsigned flag = flags_.empty() ? 0 : flags_[view][i];
    return flag & beside_border ? amounts.beside : flag & near_border ? amounts.frozen : amounts.far;
  }
  [[nodiscard]] const PixelArray<std::uint8_t>& cells_of(std::size_t view) const { return cells_(views_[view]); }

  template <class Visit>
  void for_triangles(const RowBlock& block, const Visit& visit) const {
    const auto& cells = cells_of(block.view);
    const auto width = static_cast<std::uint32_t>(width_of(views_[block.view]));
    for_pixels_of(views_, block, [&](std::size_t i) {
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
      for_pixels_of(views_, block, [&](std::size_t i) {
        if (is_vertex(cells_around(cells_of(block.view), i, width_of(views_[block.view]))))
          ++count_of(block.view, i, own);
      });
      for_triangles(block, [&](auto, auto, auto, bool beside) { ++(beside ? own.beside_triangles : own.triangles); });
      first_[k] = own;
    });
    Amounts sum;
    for (Amounts& block : first_) {
      const Amounts own = std::exchange(block, sum);
      sum = {sum.far + own.far, sum.frozen + own.frozen, sum.beside + own.beside, sum.triangles + own.triangles,
             sum.beside_triangles + own.beside_triangles};
    }
    for (Amounts& block : first_) block.frozen += sum.far, block.beside += sum.far + sum.frozen;
    return sum;
  }

  void take_vertices(const RowBlock& block, Amounts next, MergedMesh& mesh) {
    const MergeView& view = views_[block.view];
    for_pixels_of(views_, block, [&](std::size_t i) {
      if (!is_vertex(cells_around(cells_of(block.view), i, width_of(view)))) return;
      const std::size_t v = count_of(block.view, i, next)++;
      number_[block.view][i] = static_cast<std::uint32_t>(v);
      mesh.position[v] = view.vertex ? (*view.vertex)[i] : view.map->position[i];
      mesh.feature[v] = view.links != nullptr && ((*view.links)[i] & on_feature) != 0;
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
  std::vector<PixelArray<std::uint32_t>> number_;  // of each view's pixels; not set if a pixel is not a vertex
};

}  // namespace

Gathered gather(std::span<const MergeView> views, CellChoice cells, const PixelFlags& flags, Scheduler& scheduler) {
  return Gatherer(views, cells, flags, scheduler).run();
}

}  // namespace lodestone
