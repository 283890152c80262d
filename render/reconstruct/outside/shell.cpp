#include "render/reconstruct/outside/shell.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/base/disjoint_sets.h"
#include "render/reconstruct/outside/shell_grid.h"

namespace lodestone {
namespace {

constexpr std::uint32_t none = 0xFFFF'FFFFu;
// Half the thickness that a sheet without thickness gets, in spacings.
constexpr double sheet_half = 0.02;

// Corners of a cube are numbered by bits: 1 x, 2 y, 4 z. A tetrahedron goes from corner 0 to corner 7 along three axes;
// the corners in positive order, so that the last lies on the side of the first three's normal.
constexpr std::array<std::array<int, 4>, 6> tetrahedra{
    {{0, 1, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 3, 2, 7}, {0, 6, 4, 7}, {0, 5, 1, 7}}};

GridPoint corner_of(GridPoint p, int corner) {
  return {p.x + (corner & 1), p.y + (corner >> 1 & 1), p.z + (corner >> 2)};
}

class ShellMaker {
 public:
  ShellMaker(const FreeSpace& space, const ShellGrid& grid, Scheduler& scheduler)
      : space_(space), grid_(grid), scheduler_(scheduler) {}

  MergedMesh run() {
    find_blocks();
    number_vertices();
    MergedMesh mesh;
    mesh.position.resize(vertices_), mesh.normal.resize(vertices_), mesh.view.resize(vertices_);
    mesh.pixel.resize(vertices_), mesh.feature.resize(vertices_);
    std::vector<std::vector<Triangle>> triangles(blocks_.size());
    scheduler_.for_chunks(blocks_.size(), 8, [&](ChunkRange range) {
      for (std::size_t k = range.begin; k < range.end; ++k) {
        place_vertices(k, mesh);
        make_triangles(k, triangles[k]);
      }
    });
    std::size_t count = 0;
    for (const auto& own : triangles) count += own.size();
    mesh.triangles.reserve(count);
    for (const auto& own : triangles) mesh.triangles.insert(mesh.triangles.end(), own.begin(), own.end());
    return mesh;
  }

 private:
  // Crossed edges that start at the points of a block: bit k - 1 of `mask` is set for the edge to the corner k of the
  // point's cube; vertices on them are numbered from `first` + `of_point` on.
  struct Crossings {
    std::uint32_t first = 0;
    std::array<std::uint16_t, ShellGrid::block_points> of_point{};
    std::array<std::uint8_t, ShellGrid::block_points> mask{};
  };

  void find_blocks() {
    std::vector<std::uint8_t> crossed(grid_.blocks());
    scheduler_.for_chunks(grid_.blocks(), 256, [&](ChunkRange range) {
      for (std::size_t b = range.begin; b < range.end; ++b) crossed[b] = !grid_.is_uniform(b);
    });
    place_.assign(grid_.blocks(), none);
    for (std::size_t b = 0; b < crossed.size(); ++b)
      if (crossed[b]) place_[b] = static_cast<std::uint32_t>(blocks_.size()), blocks_.push_back(b);
  }

  void number_vertices() {
    crossings_.resize(blocks_.size());
    scheduler_.for_chunks(blocks_.size(), 16, [&](ChunkRange range) {
      for (std::size_t k = range.begin; k < range.end; ++k)
        for_points(blocks_[k], [&](GridPoint p, std::size_t place) {
          const bool own = grid_.is_solid(p);
          for (int corner = 1; corner < 8; ++corner) {
            const GridPoint q = corner_of(p, corner);
            if (grid_.contains(q) && grid_.is_solid(q) != own)
              crossings_[k].mask[place] |= static_cast<std::uint8_t>(1 << (corner - 1));
          }
        });
    });
    for (Crossings& c : crossings_) {
      c.first = vertices_;
      for (std::size_t place = 0; place < ShellGrid::block_points; ++place) {
        c.of_point[place] = static_cast<std::uint16_t>(vertices_ - c.first);
        vertices_ += static_cast<std::uint32_t>(std::popcount(c.mask[place]));
      }
    }
  }

  template <class Visit>
  void for_points(std::size_t block, const Visit& visit) const {
    for (std::size_t place = 0; place < ShellGrid::block_points; ++place) visit(grid_.point_at(block, place), place);
  }

  void place_vertices(std::size_t k, MergedMesh& mesh) const {
    std::vector<ViewNumber> views;
    grid_.views_of(blocks_[k], views);
    for_points(blocks_[k], [&](GridPoint p, std::size_t place) {
      std::uint32_t v = crossings_[k].first + crossings_[k].of_point[place];
      for (int corner = 1; corner < 8; ++corner) {
        if (!(crossings_[k].mask[place] >> (corner - 1) & 1)) continue;
        const GridPoint q = corner_of(p, corner);
        const bool outward = grid_.is_solid(p);
        place_vertex(outward ? q : p, outward ? p : q, views, v++, mesh);
      }
    });
  }

  void place_vertex(GridPoint free, GridPoint solid, std::span<const ViewNumber> views, std::uint32_t v,
                    MergedMesh& mesh) const {
    Vec3d a = grid_.position(free), b = grid_.position(solid);
    if (const SheetPoint* sheet = grid_.sheet_at(solid)) return place_on_sheet(*sheet, a, b, v, mesh);
    const Vec3d outward = a - b;
    for (int round = 0; round < 6; ++round) {
      const Vec3d middle = 0.5 * (a + b);
      (space_.distance(middle, views) > 0 ? a : b) = middle;
    }
    Vec3d p = 0.5 * (a + b);
    const SurfaceHit hit = space_.nearest(p, views);
    mesh.view[v] = hit.view, mesh.pixel[v] = hit.pixel;
    mesh.normal[v] = hit.view == no_view ? to_float((1 / length(outward)) * outward) : hit.normal;
    if (hit.view != no_view && std::abs(hit.distance) < 0.5 * grid_.spacing())
      p = p - hit.distance * to_double(hit.normal);
    mesh.position[v] = to_float(p);
  }

  // On the side of the sheet's plane on which the free end lies.
  void place_on_sheet(const SheetPoint& sheet, Vec3d free, Vec3d solid, std::uint32_t v, MergedMesh& mesh) const {
    const PositionMap& map = space_.maps()[sheet.view];
    const Vec3d n = to_double(map.normal[sheet.pixel]), sample = to_double(map.position[sheet.pixel]);
    const double side = dot(free - sample, n) < 0 ? -1 : 1;
    const Vec3d middle = 0.5 * (free + solid);
    const double off = dot(middle - sample, n) - side * sheet_half * grid_.spacing();
    mesh.position[v] = to_float(middle - off * n);
    mesh.normal[v] = to_float(side * n);
    mesh.view[v] = sheet.view, mesh.pixel[v] = sheet.pixel;
  }

  // The vertex on the edge between two corners of a cube.
  [[nodiscard]] std::uint32_t vertex_at(GridPoint cube, int a, int b) const {
    const int from = a & b, way = a ^ b;  // of the two, one's bits are among the other's
    const GridPoint p = corner_of(cube, from);
    const Crossings& c = crossings_[place_[grid_.block_of(p)]];
    const std::size_t place = ShellGrid::place_in_block(p);
    const unsigned below = c.mask[place] & ((1u << (way - 1)) - 1);
    return c.first + c.of_point[place] + static_cast<std::uint32_t>(std::popcount(below));
  }

  void make_triangles(std::size_t k, std::vector<Triangle>& triangles) const {
    for_points(blocks_[k], [&](GridPoint p, std::size_t) {
      if (!grid_.contains(corner_of(p, 7))) return;
      unsigned solid = 0;
      for (int corner = 0; corner < 8; ++corner)
        solid |= static_cast<unsigned>(grid_.is_solid(corner_of(p, corner))) << corner;
      if (solid == 0 || solid == 255) return;
      for (const auto& tetrahedron : tetrahedra) cross_tetrahedron(p, tetrahedron, solid, triangles);
    });
  }

  void cross_tetrahedron(GridPoint p, std::array<int, 4> t, unsigned solid, std::vector<Triangle>& triangles) const {
    const auto is_solid = [&](int corner) { return (solid >> corner & 1) != 0; };
    const auto count = std::count_if(t.begin(), t.end(), is_solid);
    if (count == 0 || count == 4) return;
    const bool lone_is_solid = count == 1;
    const auto at = [&](std::size_t a, std::size_t b) { return vertex_at(p, t[a], t[b]); };
    // Even permutations that bring a corner to the front.
    constexpr std::array<std::array<std::size_t, 4>, 4> to_front{
        {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
    if (count != 2) {
      const auto lone = std::find_if(t.begin(), t.end(), [&](int c) { return is_solid(c) == lone_is_solid; });
      const auto& o = to_front[static_cast<std::size_t>(lone - t.begin())];
      const std::uint32_t a = at(o[0], o[1]), b = at(o[0], o[2]), c = at(o[0], o[3]);
      triangles.push_back(lone_is_solid ? Triangle{{a, b, c}} : Triangle{{a, c, b}});
      return;
    }
    // Even permutations that bring two corners to the front.
    constexpr std::array<std::array<std::size_t, 4>, 6> pairs{
        {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}}};
    for (const auto& o : pairs) {
      if (!is_solid(t[o[0]]) || !is_solid(t[o[1]])) continue;
      const std::uint32_t a = at(o[0], o[2]), b = at(o[0], o[3]), c = at(o[1], o[3]), d = at(o[1], o[2]);
      triangles.push_back({{a, b, c}});
      triangles.push_back({{a, c, d}});
    }
  }

  const FreeSpace& space_;
  const ShellGrid& grid_;
  Scheduler& scheduler_;
  std::vector<std::size_t> blocks_;   // that the surface passes through
  std::vector<std::uint32_t> place_;  // of each block in that list; none
  std::vector<Crossings> crossings_;  // of each in the list
  std::uint32_t vertices_ = 0;
};

struct Component {
  Box3f box;
  double volume = 0;  // six times
};

// Leaves out hollows, which cannot be seen, and what is too small to be a part.
void keep_hulls(MergedMesh& mesh, double smallest, ShellReport& report) {
  DisjointSets sets(mesh.position.size());
  for (const Triangle& t : mesh.triangles) sets.unite(t.v[0], t.v[1]), sets.unite(t.v[1], t.v[2]);
  std::vector<Component> component(mesh.position.size());
  for (const Triangle& t : mesh.triangles) {
    Component& c = component[sets.find(t.v[0])];
    for (const std::uint32_t v : t.v) c.box.extend(mesh.position[v]);
    const Vec3d p = to_double(mesh.position[t.v[0]]), q = to_double(mesh.position[t.v[1]]),
                r = to_double(mesh.position[t.v[2]]);
    c.volume += dot(p, cross(q, r));
  }
  const auto is_crumb = [&](const Component& c) {
    return std::max({c.box.hi.x - c.box.lo.x, c.box.hi.y - c.box.lo.y, c.box.hi.z - c.box.lo.z}) <
           static_cast<float>(smallest);
  };
  std::vector<std::uint32_t> number(mesh.position.size(), none);
  std::uint32_t kept = 0;
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    const std::uint32_t root = sets.find(v);
    const Component& c = component[root];
    const bool crumb = is_crumb(c), hollow = !crumb && !(c.volume > 0);
    if (root == v) report.crumbs += crumb, report.cavities += hollow;
    if (crumb || hollow) continue;
    mesh.position[kept] = mesh.position[v], mesh.normal[kept] = mesh.normal[v];
    mesh.view[kept] = mesh.view[v], mesh.pixel[kept] = mesh.pixel[v];
    number[v] = kept++;
  }
  mesh.position.resize(kept), mesh.normal.resize(kept), mesh.view.resize(kept), mesh.pixel.resize(kept);
  mesh.feature.resize(kept);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return number[t.v[0]] == none; });
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& v : t.v) v = number[v];
}

}  // namespace

MergedMesh make_shell(std::span<const PositionMap> maps, double spacing, ShellReport& report, Scheduler& scheduler) {
  Box3f box;
  for (const PositionMap& map : maps)
    map.groups().for_pixels(0, map.view.pixels(), [&](std::size_t i) {
      if (map.sees(i)) box.extend(map.position[i]);
    });
  if (box.empty()) return {};
  const FreeSpace space(maps, 1.5 * spacing, scheduler);
  const ShellGrid grid(space, box, spacing, scheduler);
  report.grid_points = ShellGrid::block_points * grid.blocks(), report.sheet_points = grid.sheet_points();
  MergedMesh mesh = ShellMaker(space, grid, scheduler).run();
  keep_hulls(mesh, 2 * spacing, report);
  return mesh;
}

}  // namespace lodestone
