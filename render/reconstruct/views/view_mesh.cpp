#include "render/reconstruct/views/view_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/position_map/map_view.h"

namespace lodestone {
namespace {

// The data of a pixel that connecting needs.
struct Corner {
  float depth = 0;
  float right = 0, down = 0;  // change of depth to the next pixel in the tangent plane, clamped to max_slope spacings
  float slack = 0;
  std::uint32_t kind = no_triangle;  // pixels of different kinds are never connected; no_triangle: nothing is seen
};

class CornerReader {
 public:
  CornerReader(const PositionMap& map, const ConnectConfig& config)
      : map_(map),
        config_(config),
        right_(to_float(map.view.right)),
        up_(to_float(map.view.up)),
        forward_(to_float(map.view.forward)),
        pixel_(static_cast<float>(map.view.pixel)),
        central_(map.view.projection == Projection::perspective) {}

  [[nodiscard]] Corner read(std::size_t i) const {
    const float depth = map_.depth[i];
    const Vec3f n = map_.normal[i];
    const Vec3f ray = central_ ? ray_at(i) : forward_;
    const float h = central_ ? pixel_ * depth : pixel_, facing = dot(n, ray), limit = config_.max_slope * h;
    // A triangle that is seen from its edge, or has no normal, tells nothing.
    const float scale = facing != 0 ? h / facing : 0;
    return {depth, std::clamp(-scale * dot(n, right_), -limit, limit), std::clamp(scale * dot(n, up_), -limit, limit),
            config_.slack * h, kind_of(map_.triangle[i], facing)};
  }

  void read_row(int y, std::vector<Corner>& row) const {
    const auto width = static_cast<std::size_t>(map_.view.width);
    row.resize(width);
    const std::size_t first = static_cast<std::size_t>(y) * width;
    map_.groups().for_runs(
        first, first + width,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) row[i - first] = read(i);
        },
        [&](std::size_t begin, std::size_t end) {
          std::fill(row.data() + (begin - first), row.data() + (end - first), Corner{});
        });
  }

 private:
  [[nodiscard]] Vec3f ray_at(std::size_t i) const {
    const auto width = static_cast<std::size_t>(map_.view.width);
    return to_float(
        ray_through(map_.view, static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5).direction);
  }
  // The part, and whether it is the inside that is seen.
  [[nodiscard]] std::uint32_t kind_of(std::uint32_t triangle, float facing) const {
    if (triangle == no_triangle) return no_triangle;
    const std::uint32_t part = config_.parts.empty() ? 0 : config_.parts[triangle];
    return 2 * part + (config_.oriented && facing > 0 ? 1 : 0);
  }

  const PositionMap& map_;
  const ConnectConfig& config_;
  Vec3f right_, up_, forward_;
  float pixel_;
  bool central_;
};

// True if depth may change by `jump` where the slopes at the two ends predict `a` and `b`.
inline bool is_smooth(float jump, float a, float b, float slack) {
  const float lo = std::min(std::min(a, b), 0.0f), hi = std::max(std::max(a, b), 0.0f);
  const float tolerance = slack + 0.25f * (hi - lo);
  return (jump >= lo - tolerance) & (jump <= hi + tolerance);
}

// (dx, dy): the step from a to b, in pixels.
inline bool are_connected(const Corner& a, const Corner& b, float dx, float dy) {
  return (a.kind == b.kind) & (a.kind != no_triangle) &
         is_smooth(b.depth - a.depth, dx * a.right + dy * a.down, dx * b.right + dy * b.down,
                   std::max(a.slack, b.slack) * (dx != 0 && dy != 0 ? 1.4142f : 1.0f));
}

// `links`: links allowed between p and q, r and s, p and r, q and s, p and s, q and r.
struct CellLinks {
  bool pq = true, rs = true, pr = true, qs = true, ps = true, qr = true;
};

std::uint8_t cell_of(const Corner& p, const Corner& q, const Corner& r, const Corner& s, const CellLinks& links) {
  const bool pq = links.pq & are_connected(p, q, 1, 0), rs = links.rs & are_connected(r, s, 1, 0),
             pr = links.pr & are_connected(p, r, 0, 1), qs = links.qs & are_connected(q, s, 0, 1);
  if (pq + rs + pr + qs < 2) return 0;
  const bool ps = links.ps & are_connected(p, s, 1, 1), qr = links.qr & are_connected(q, r, -1, 1);
  constexpr unsigned prs = cell_prs, psq = cell_psq, prq = cell_prq, rsq = cell_rsq;
  const unsigned first = ((pr & rs & ps) ? prs : 0u) | ((ps & qs & pq) ? psq : 0u);
  const unsigned second = ((pr & qr & pq) ? prq : 0u) | ((rs & qs & qr) ? rsq : 0u);
  const auto triangles = [](unsigned bits) { return (bits & (bits - 1)) != 0 ? 2 : bits != 0 ? 1 : 0; };
  unsigned cell = first;
  if (triangles(first) != triangles(second))
    cell = triangles(first) > triangles(second) ? first : second;
  else if (std::abs(q.depth - r.depth) < std::abs(p.depth - s.depth))
    cell = second;
  // All corners of a triangle are of one kind, and triangles of one cell share two.
  const std::uint32_t kind = p.kind != no_triangle && (cell & ~unsigned{cell_rsq}) ? p.kind : s.kind;
  if (cell != 0 && (kind & 1)) cell |= cell_turned;
  return static_cast<std::uint8_t>(cell);
}

}  // namespace

bool are_connected(const PositionMap& map, const ConnectConfig& config, std::size_t a, std::size_t b, int dx, int dy) {
  const CornerReader reader(map, config);
  return are_connected(reader.read(a), reader.read(b), static_cast<float>(dx), static_cast<float>(dy));
}

void connect_rows(const PositionMap& map, const ConnectConfig& config, int first, int last, ViewMesh& mesh) {
  const auto width = static_cast<std::size_t>(map.view.width);
  const CornerReader reader(map, config);
  std::vector<Corner> above, below;
  reader.read_row(first, above);
  for (int y = first; y < last; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * width;
    const bool last_row = y + 1 == map.view.height;
    last_row ? below.assign(width, Corner{}) : reader.read_row(y + 1, below);
    map.groups().for_pixels(row, row + width, [&](std::size_t i) {
      const std::size_t x = i - row;
      if (x + 1 == width) {
        mesh.cells[i] = 0;
        return;
      }
      const Corner &p = above[x], &q = above[x + 1], &r = below[x], &s = below[x + 1];
      const int seen =
          (p.kind != no_triangle) + (q.kind != no_triangle) + (r.kind != no_triangle) + (s.kind != no_triangle);
      CellLinks allowed;
      if (seen >= 3 && config.links != nullptr) {
        const PixelArray<std::uint8_t>& links = *config.links;
        const std::uint8_t here = links[i];
        allowed = {(here & link_right) != 0,        (links[i + width] & link_right) != 0, (here & link_down) != 0,
                   (links[i + 1] & link_down) != 0, (here & link_diagonal) != 0,          (here & link_across) != 0};
      }
      mesh.cells[i] = seen < 3 ? std::uint8_t{0} : cell_of(p, q, r, s, allowed);
    });
    std::swap(above, below);
  }
}

ViewMesh connect(const PositionMap& map, const ConnectConfig& config) {
  ViewMesh mesh;
  mesh.cells = map.triangle.like<std::uint8_t>();
  connect_rows(map, config, 0, map.view.height, mesh);
  return mesh;
}

void list_triangles(const ViewMesh& mesh, int width, int first, int last, std::vector<Triangle>& triangles) {
  const auto w = static_cast<std::size_t>(width);
  mesh.cells.groups().for_pixels(
      static_cast<std::size_t>(first) * w, static_cast<std::size_t>(last) * w, [&](std::size_t i) {
        if (const std::uint8_t cell = mesh.cells[i])
          for_triangles_of_cell(cell, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(w),
                                [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
                                  triangles.push_back({{a, b, c}});
                                });
      });
}

void estimate_normals(PositionMap& map) {
  const int width = map.view.width, height = map.view.height;
  map.normal = map.triangle.like<Vec3f>();
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  // Difference to the neighbour at (dx, dy) or from the one at the other side, whichever jumps less; zero without
  // either.
  const auto difference = [&](int x, int y, int dx, int dy) {
    Vec3d best;
    double least = std::numeric_limits<double>::infinity();
    for (const int side : {1, -1}) {
      const int nx = x + side * dx, ny = y + side * dy;
      if (nx < 0 || ny < 0 || nx >= width || ny >= height || !map.sees(index(nx, ny))) continue;
      const double jump = std::abs(double{map.depth[index(nx, ny)]} - map.depth[index(x, y)]);
      if (jump >= least) continue;
      least = jump;
      best = side * (to_double(map.position[index(nx, ny)]) - to_double(map.position[index(x, y)]));
    }
    return best;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = index(x, y);
      if (!map.sees(i)) continue;
      const Vec3d n = cross(difference(x, y, 0, 1), difference(x, y, 1, 0));
      const Vec3d eye = towards_eye(map.view, to_double(map.position[i]));
      const double norm = length(n);
      map.normal[i] = norm > 0 ? to_float((dot(n, eye) < 0 ? -1 / norm : 1 / norm) * n) : to_float(eye);
    }
}

std::vector<std::uint32_t> extend_to_silhouette(PositionMap& map, float max_slope) {
  const int width = map.view.width, height = map.view.height;
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  struct Fill {
    std::uint32_t pixel, from;
    Vec3f position;
    float depth;
  };
  std::vector<Fill> fills;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (map.sees(index(x, y))) continue;
      Fill nearest{0, no_triangle, {}, std::numeric_limits<float>::infinity()};
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const int nx = x + dx, ny = y + dy;
        if (nx < 0 || ny < 0 || nx >= width || ny >= height || !map.sees(index(nx, ny))) continue;
        const std::size_t from = index(nx, ny);
        const Vec3d n = to_double(map.normal[from]);
        const Ray ray = ray_through(map.view, (x + nx + 1) * 0.5, (y + ny + 1) * 0.5);
        const Vec3d p = to_double(map.position[from]);
        const double depth = map.view.depth(p), h = map.view.spacing(depth), facing = dot(n, ray.direction);
        double change = facing != 0 ? dot(n, p - ray.origin) / facing - depth : 0;
        change = std::clamp(change, -0.5 * h * max_slope, 0.5 * h * max_slope);
        const double t = depth + change;
        // The nearest of the neighbours' points: a farther surface is not extended before the silhouette of another.
        if (!(t < nearest.depth)) continue;
        nearest = {static_cast<std::uint32_t>(index(x, y)), static_cast<std::uint32_t>(from),
                   to_float(ray.origin + t * ray.direction), static_cast<float>(t)};
      }
      if (nearest.from != no_triangle) fills.push_back(nearest);
    }
  std::vector<std::uint32_t> filled;
  for (const Fill& f : fills) {
    filled.push_back(f.pixel);
    map.position[f.pixel] = f.position;
    map.depth[f.pixel] = f.depth;
    map.triangle[f.pixel] = map.triangle[f.from];
    map.normal[f.pixel] = map.normal[f.from];
    if (!map.uv.empty()) map.uv[f.pixel] = map.uv[f.from];
    if (!map.colour.empty()) map.colour[f.pixel] = map.colour[f.from];
  }
  return filled;
}

}  // namespace lodestone
