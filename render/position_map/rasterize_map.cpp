#include "render/position_map/rasterize_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include "core/base/error.h"
#include "render/position_map/resolve_pixel.h"

namespace lodestone {
namespace {

constexpr int tile_bits = 6, tile_size = 1 << tile_bits, tile_pixels = tile_size * tile_size;
constexpr std::int32_t subpixels = 256, half = subpixels / 2;
constexpr int wide_row = 8;  // pixels: from here on divisions are faster than to look at each
constexpr std::size_t vertex_grain = 1 << 16, triangle_grain = 1 << 16;

constexpr std::int64_t centre(int pixel) { return std::int64_t{pixel} * subpixels + half; }

struct PixelBox {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;  // inclusive
  [[nodiscard]] bool empty() const { return x0 > x1 || y0 > y1; }
};

// Pixels whose centre is in the closed bounding box, inside the picture.
PixelBox box_of(const SnappedVertex& a, const SnappedVertex& b, const SnappedVertex& c, const MapView& view) {
  // Two by two: the compiler makes a loop of a list.
  const auto least = [](int u, int v, int w) { return std::min(std::min(u, v), w); };
  const auto largest = [](int u, int v, int w) { return std::max(std::max(u, v), w); };
  return {std::max((least(a.x, b.x, c.x) + half - 1) >> 8, 0), std::max((least(a.y, b.y, c.y) + half - 1) >> 8, 0),
          std::min((largest(a.x, b.x, c.x) - half) >> 8, view.width - 1),
          std::min((largest(a.y, b.y, c.y) - half) >> 8, view.height - 1)};
}

// The nearest triangles so far in the pixels of a tile.
struct TileSight {
  std::array<double, tile_pixels> z;
  std::span<std::uint32_t, tile_pixels> triangle;
};

class MapRasterizer {
 public:
  MapRasterizer(const IndexedMesh& mesh, const MapView& view, Scheduler& scheduler)
      : mesh_(mesh),
        view_(view),
        scheduler_(scheduler),
        nearest_(view.nearest > 0 ? nearest_z(view) : -std::numeric_limits<double>::infinity()),
        columns_(static_cast<std::size_t>((view.width + tile_size - 1) >> tile_bits)),
        tiles_(columns_ * static_cast<std::size_t>((view.height + tile_size - 1) >> tile_bits)) {}

  PositionMap draw(MapChannels channels) {
    snap_vertices();
    sort_into_tiles();
    list_tiles();
    triangle_ = std::make_unique_for_overwrite<std::uint32_t[]>(listed_tiles_.size() * tile_pixels);
    if (!channels.surface) depth_ = std::make_unique_for_overwrite<float[]>(listed_tiles_.size() * tile_pixels);
    PixelMarks marks(view_.width, view_.height);
    scheduler_.for_chunks(listed_tiles_.size(), 1, [&](ChunkRange range) { draw_tile(range.index, marks); });
    PositionMap map = empty_map(mesh_, view_, channels, marks.groups());
    scheduler_.for_chunks(listed_tiles_.size(), 1, [&](ChunkRange range) { resolve_tile(range.index, map); });
    return map;
  }

 private:
  void snap_vertices() {
    vertices_.resize(mesh_.positions.size());
    scheduler_.for_chunks(vertices_.size(), vertex_grain, [&](ChunkRange range) {
      for (std::size_t v = range.begin; v < range.end; ++v) vertices_[v] = snap_to_window(view_, mesh_.positions[v]);
    });
  }

  template <class Visit>
  void for_tiles_of(std::size_t t, const Visit& visit) const {
    const auto& v = mesh_.triangles[t].v;
    const PixelBox box = box_of(vertices_[v[0]], vertices_[v[1]], vertices_[v[2]], view_);
    if (box.empty()) return;
    for (int y = box.y0 >> tile_bits; y <= box.y1 >> tile_bits; ++y)
      for (int x = box.x0 >> tile_bits; x <= box.x1 >> tile_bits; ++x)
        visit(static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x));
  }

  // A counting sort of (tile, triangle): chunks count, then write where earlier chunks and tiles end.
  void sort_into_tiles() {
    const std::size_t count = mesh_.triangles.size(), chunks = chunk_count(count, triangle_grain);
    std::vector<std::size_t> place(chunks * tiles_, 0);
    scheduler_.for_chunks(count, triangle_grain, [&](ChunkRange range) {
      std::size_t* own = place.data() + range.index * tiles_;
      for (std::size_t t = range.begin; t < range.end; ++t) for_tiles_of(t, [&](std::size_t tile) { ++own[tile]; });
    });
    first_.assign(tiles_ + 1, 0);
    std::size_t sum = 0;
    for (std::size_t tile = 0; tile < tiles_; ++tile) {
      first_[tile] = sum;
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) sum += std::exchange(place[chunk * tiles_ + tile], sum);
    }
    first_[tiles_] = sum;
    listed_.resize(sum);
    scheduler_.for_chunks(count, triangle_grain, [&](ChunkRange range) {
      std::size_t* own = place.data() + range.index * tiles_;
      for (std::size_t t = range.begin; t < range.end; ++t)
        for_tiles_of(t, [&](std::size_t tile) { listed_[own[tile]++] = static_cast<std::uint32_t>(t); });
    });
  }

  // Tiles that no triangle overlaps take neither time nor memory.
  void list_tiles() {
    for (std::size_t tile = 0; tile < tiles_; ++tile)
      if (first_[tile] < first_[tile + 1]) listed_tiles_.push_back(static_cast<std::uint32_t>(tile));
  }

  [[nodiscard]] PixelBox box_of_tile(std::size_t tile) const {
    const int x0 = static_cast<int>(tile % columns_) << tile_bits, y0 = static_cast<int>(tile / columns_) << tile_bits;
    return {x0, y0, std::min(x0 + tile_size, view_.width) - 1, std::min(y0 + tile_size, view_.height) - 1};
  }
  [[nodiscard]] std::span<std::uint32_t, tile_pixels> triangles_of(std::size_t place) const {
    return std::span<std::uint32_t, tile_pixels>(triangle_.get() + place * tile_pixels, tile_pixels);
  }

  // `place`: of the tile in the list.
  void draw_tile(std::size_t place, PixelMarks& marks) const {
    const std::size_t tile = listed_tiles_[place];
    const PixelBox rect = box_of_tile(tile);
    TileSight sight{.z = {}, .triangle = triangles_of(place)};
    sight.z.fill(std::numeric_limits<double>::infinity());
    std::ranges::fill(sight.triangle, no_triangle);
    for (std::size_t k = first_[tile]; k < first_[tile + 1]; ++k) draw_triangle(listed_[k], rect, sight);
    for (int y = rect.y0; y <= rect.y1; ++y) {
      const std::uint32_t* row = sight.triangle.data() + static_cast<std::ptrdiff_t>(y - rect.y0) * tile_size;
      marks.add_row(rect.x0, rect.x1 + 1, y, [&](int x) { return row[x - rect.x0] != no_triangle; });
    }
    if (!depth_) return;
    std::ranges::transform(sight.z, depth_.get() + place * tile_pixels, [&](double z) {
      return static_cast<float>(view_.projection == Projection::perspective ? -1 / z : z);
    });
  }

  void resolve_tile(std::size_t place, PositionMap& map) const {
    const PixelBox rect = box_of_tile(listed_tiles_[place]);
    const auto triangle = triangles_of(place);
    for (int y = rect.y0; y <= rect.y1; ++y)
      for (int x = rect.x0; x <= rect.x1; ++x) {
        const auto own = static_cast<std::size_t>((y - rect.y0) * tile_size + x - rect.x0);
        if (triangle[own] == no_triangle) continue;
        const std::size_t i =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width) + static_cast<std::size_t>(x);
        map.triangle[i] = triangle[own];
        depth_ ? void(map.depth[i] = depth_[place * tile_pixels + own]) : resolve_pixel(mesh_, i, map);
      }
  }

  void draw_triangle(std::uint32_t t, const PixelBox& rect, TileSight& sight) const {
    const auto& v = mesh_.triangles[t].v;
    const SnappedVertex &a = vertices_[v[0]], &b = vertices_[v[1]], &c = vertices_[v[2]];
    const TriangleCoverage coverage(a, b, c);
    if (coverage.area == 0) return;
    PixelBox box = box_of(a, b, c, view_);
    box = {std::max(box.x0, rect.x0), std::max(box.y0, rect.y0), std::min(box.x1, rect.x1), std::min(box.y1, rect.y1)};
    const bool wide = box.x1 - box.x0 >= wide_row;
    if (wide && coverage.misses(centre(box.x0), centre(box.y0), centre(box.x1), centre(box.y1))) return;
    for (int y = box.y0; y <= box.y1; ++y) {
      int first = box.x0, last = box.x1;
      if (wide) {
        const auto row = coverage.row(centre(y), centre(box.x0), subpixels, box.x1 - box.x0 + 1);
        first = box.x0 + static_cast<int>(row.first), last = box.x0 + static_cast<int>(row.second);
      }
      for (int x = first; x <= last; ++x) {
        double z = 0;
        if (!coverage.at(centre(x), centre(y), z)) continue;
        const auto own = static_cast<std::size_t>((y - rect.y0) * tile_size + x - rect.x0);
        // Triangles come in ascending order, so the first of equally near ones has the lowest number.
        if (!(z < sight.z[own]) || z < nearest_) continue;
        sight.z[own] = z;
        sight.triangle[own] = t;
      }
    }
  }

  const IndexedMesh& mesh_;
  const MapView& view_;
  Scheduler& scheduler_;
  double nearest_;  // as SnappedVertex has it
  std::size_t columns_, tiles_;
  std::vector<SnappedVertex> vertices_;
  std::vector<std::size_t> first_;           // of each tile in `listed_`
  std::vector<std::uint32_t> listed_;        // triangles, ascending within a tile
  std::vector<std::uint32_t> listed_tiles_;  // those with triangles; pixels of each of them:
  std::unique_ptr<std::uint32_t[]> triangle_;
  std::unique_ptr<float[]> depth_;  // null: computed with the positions
};

void check_in_front(const IndexedMesh& mesh, const MapView& view) {
  if (view.projection == Projection::orthographic) return;
  for (const Vec3f& p : mesh.positions)
    if (!(view.depth(to_double(p)) > 0))
      throw InputError(describe("view", "", "a vertex is not in front of the eye", "move the eye away from the model"));
}

}  // namespace

SnappedVertex snap_to_window(const MapView& view, Vec3f position) {
  const WindowPoint w = to_window(view, to_double(position));
  static constexpr double limit = 1 << 29;
  const auto snap = [](double v) {
    return static_cast<std::int32_t>(std::nearbyint(std::clamp(v * 256, -limit, limit)));
  };
  return {snap(w.x), snap(w.y), view.projection == Projection::perspective ? -1 / w.depth : w.depth};
}

TriangleCoverage::TriangleCoverage(const SnappedVertex& a, const SnappedVertex& b, const SnappedVertex& c) {
  const auto doubled = [](const SnappedVertex& p, const SnappedVertex& q, const SnappedVertex& r) {
    return std::int64_t{q.x - p.x} * (r.y - p.y) - std::int64_t{q.y - p.y} * (r.x - p.x);
  };
  area = doubled(a, b, c);
  const SnappedVertex &second = area < 0 ? c : b, &third = area < 0 ? b : c;
  area = area < 0 ? -area : area;
  const auto edge = [](const SnappedVertex& p, const SnappedVertex& q) {
    const std::int64_t dx = q.x - p.x, dy = q.y - p.y;
    return Edge{p.x, p.y, dx, dy, dy < 0 || (dy == 0 && dx > 0) ? 0 : -1};
  };
  edge_[0] = edge(second, third), edge_[1] = edge(third, a), edge_[2] = edge(a, second);
  z_[0] = a.z, z_[1] = second.z, z_[2] = third.z;
}

bool TriangleCoverage::at(std::int64_t x, std::int64_t y, double& z) const {
  std::int64_t e[3];
  for (std::size_t k = 0; k < 3; ++k) {
    e[k] = edge_[k].dx * (y - edge_[k].y) - edge_[k].dy * (x - edge_[k].x);
    if (e[k] + edge_[k].bias < 0) return false;
  }
  z = ((static_cast<double>(e[0]) * z_[0] + static_cast<double>(e[1]) * z_[1]) + static_cast<double>(e[2]) * z_[2]) /
      static_cast<double>(area);
  return true;
}

std::pair<std::int64_t, std::int64_t> TriangleCoverage::row(std::int64_t y, std::int64_t first, std::int64_t step,
                                                            std::int64_t count) const {
  std::int64_t from = 0, to = count - 1;
  for (const Edge& edge : edge_) {
    const std::int64_t start = edge.dx * (y - edge.y) - edge.dy * (first - edge.x) + edge.bias, fall = edge.dy * step;
    // Covered is where start - fall i is not negative.
    if (fall > 0)
      to = start < 0 ? -1 : std::min(to, start / fall);
    else if (fall < 0)
      from = start < 0 ? std::max(from, (-start - fall - 1) / -fall) : from;
    else if (start < 0)
      to = -1;
  }
  return {from, to};
}

bool TriangleCoverage::misses(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1) const {
  return std::ranges::any_of(edge_, [&](const Edge& edge) {
    const std::int64_t x = edge.dy > 0 ? x0 : x1, y = edge.dx > 0 ? y1 : y0;  // where the function is greatest
    return edge.dx * (y - edge.y) - edge.dy * (x - edge.x) + edge.bias < 0;
  });
}

PositionMap rasterize_map(const IndexedMesh& mesh, const MapView& view, MapChannels channels, Scheduler& scheduler) {
  check_view(view);
  check_in_front(mesh, view);
  return MapRasterizer(mesh, view, scheduler).draw(channels);
}

}  // namespace lodestone
