#include "experiments/metrics/cracks/leaks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "experiments/metrics/drawn/drawn_mesh.h"
#include "experiments/metrics/drawn/screen.h"
#include "render/camera/projection.h"
#include "render/position_map/rasterize_map.h"

namespace lodestone {
namespace {

constexpr std::size_t leak_vertices_per_chunk = 1 << 14;
constexpr int band_rows = 32;
constexpr std::int32_t subpixels = 256, half_pixel = subpixels / 2;
// Pixels from the centre of the picture, within what exact edge functions can hold.
constexpr double guard_pixels = 1 << 19;
constexpr double least_w = 1e-9;

using Clip = std::array<double, 4>;

// Half-spaces of clip space that everything is cut to: before the eye, and not too far outside of the picture.
class ClipPlanes {
 public:
  static constexpr std::size_t count = 5;
  explicit ClipPlanes(ImageSize size) : x_(2 * guard_pixels / size.width), y_(2 * guard_pixels / size.height) {}
  // Signed; 0 or more inside.
  [[nodiscard]] double at(std::size_t plane, const Clip& c) const {
    switch (plane) {
      case 0:
        return c[3] - least_w;
      case 1:
        return x_ * c[3] - c[0];
      case 2:
        return x_ * c[3] + c[0];
      case 3:
        return y_ * c[3] - c[1];
      default:
        return y_ * c[3] + c[1];
    }
  }
  [[nodiscard]] bool inside(const Clip& c) const {
    for (std::size_t plane = 0; plane < count; ++plane)
      if (!(at(plane, c) >= 0)) return false;
    return true;
  }

 private:
  double x_, y_;
};

// The same point for an edge and its reverse: two triangles that share the edge go on sharing it.
Clip cut_edge(const Clip& a, const Clip& b, std::size_t plane, const ClipPlanes& planes) {
  const Clip &from = a < b ? a : b, &to = a < b ? b : a;
  const double u = planes.at(plane, from), v = planes.at(plane, to), t = u / (u - v);
  Clip cut{};
  for (std::size_t k = 0; k < 4; ++k) cut[k] = from[k] + t * (to[k] - from[k]);
  return cut;
}

std::vector<Clip> clipped(std::vector<Clip> polygon, const ClipPlanes& planes) {
  for (std::size_t plane = 0; plane < ClipPlanes::count; ++plane) {
    std::vector<Clip> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Clip &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const bool a_in = planes.at(plane, a) >= 0, b_in = planes.at(plane, b) >= 0;
      if (a_in) kept.push_back(a);
      if (a_in != b_in) kept.push_back(cut_edge(a, b, plane, planes));
    }
    polygon = std::move(kept);
  }
  return polygon;
}

SnappedVertex snap(const Clip& c, ImageSize size) {
  const auto pixels = [](double v) { return static_cast<std::int32_t>(std::nearbyint(v * subpixels)); };
  return {pixels((1 + c[0] / c[3]) * 0.5 * size.width), pixels((1 - c[1] / c[3]) * 0.5 * size.height), c[2] / c[3]};
}

using WindowTriangle = std::array<SnappedVertex, 3>;

// Winding number of the surface around a point, signed: the sum of the solid angles of its triangles (vanoosterom1983).
double winding(std::span<const Vec3d> positions, std::span<const Triangle> triangles, Vec3d eye) {
  double sum = 0;
  for (const Triangle& t : triangles) {
    const Vec3d a = positions[t.v[0]] - eye, b = positions[t.v[1]] - eye, c = positions[t.v[2]] - eye;
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

double volume(std::span<const Vec3d> positions, std::span<const Triangle> triangles) {
  double sum = 0;
  for (const Triangle& t : triangles) sum += dot(positions[t.v[0]], cross(positions[t.v[1]], positions[t.v[2]]));
  return sum / 6;
}

// All triangles in the window, those that cross the guard cut up.
class WindowTriangles {
 public:
  WindowTriangles(std::span<const Vec3d> positions, std::span<const Triangle> triangles, const Screen& screen,
                  Scheduler& scheduler)
      : triangles_(triangles), window_(positions.size()), inside_(positions.size()) {
    const ClipPlanes planes(screen.size());
    scheduler.for_chunks(positions.size(), leak_vertices_per_chunk, [&](ChunkRange chunk) {
      for (std::size_t v = chunk.begin; v < chunk.end; ++v) {
        const Clip c = screen.to_clip(positions[v]);
        inside_[v] = planes.inside(c) ? 1 : 0;
        if (inside_[v]) window_[v] = snap(c, screen.size());
      }
    });
    for (const Triangle& t : triangles) {
      if (whole(t)) continue;
      std::vector<Clip> corners;
      for (const std::uint32_t v : t.v) corners.push_back(screen.to_clip(positions[v]));
      const std::vector<Clip> polygon = clipped(std::move(corners), planes);
      for (std::size_t k = 2; k < polygon.size(); ++k)
        cut_.push_back(
            {snap(polygon[0], screen.size()), snap(polygon[k - 1], screen.size()), snap(polygon[k], screen.size())});
    }
  }

  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Triangle& t : triangles_)
      if (whole(t)) visit(window_[t.v[0]], window_[t.v[1]], window_[t.v[2]]);
    for (const WindowTriangle& t : cut_) visit(t[0], t[1], t[2]);
  }

 private:
  [[nodiscard]] bool whole(const Triangle& t) const {
    return inside_[t.v[0]] != 0 && inside_[t.v[1]] != 0 && inside_[t.v[2]] != 0;
  }
  std::span<const Triangle> triangles_;
  std::vector<SnappedVertex> window_;
  std::vector<std::uint8_t> inside_;
  std::vector<WindowTriangle> cut_;
};

// Hits of the rays through the pixels of some rows.
struct Band {
  int first_row = 0, rows = 0, width = 0;
  std::vector<std::int32_t> sum;      // triangles that show their face minus those that show their back
  std::vector<double> depth;          // of the nearest one
  std::vector<std::uint8_t> nearest;  // nothing, its back, its face

  enum Side : std::uint8_t { nothing, back, face };

  Band(int first, int count, int columns) : first_row(first), rows(count), width(columns) {
    const std::size_t n = static_cast<std::size_t>(rows) * static_cast<std::size_t>(width);
    sum.assign(n, 0);
    depth.assign(n, std::numeric_limits<double>::infinity());
    nearest.assign(n, nothing);
  }

  // `turned`: the mesh calls the inside its outside.
  void draw(const SnappedVertex& a, const SnappedVertex& b, const SnappedVertex& c, bool turned) {
    const auto [y_lo, y_hi] = std::minmax({a.y, b.y, c.y});
    const int y0 = std::max((y_lo + half_pixel - 1) >> 8, first_row),
              y1 = std::min((y_hi - half_pixel) >> 8, first_row + rows - 1);
    if (y0 > y1) return;
    const auto [x_lo, x_hi] = std::minmax({a.x, b.x, c.x});
    const int x0 = std::max((x_lo + half_pixel - 1) >> 8, 0), x1 = std::min((x_hi - half_pixel) >> 8, width - 1);
    if (x0 > x1) return;
    // Counterclockwise as seen is clockwise where y points down.
    const std::int64_t clockwise = std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{b.y - a.y} * (c.x - a.x);
    if (clockwise == 0) return;
    const bool shows_face = (clockwise < 0) != turned;
    const TriangleCoverage coverage(a, b, c);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        double z = 0;
        if (!coverage.at(x * subpixels + half_pixel, y * subpixels + half_pixel, z)) continue;
        const std::size_t i =
            static_cast<std::size_t>(y - first_row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        sum[i] += shows_face ? 1 : -1;
        // The face wins when both are equally near: they meet at a silhouette.
        if (z < depth[i] || (z == depth[i] && shows_face)) {
          depth[i] = z;
          nearest[i] = shows_face ? face : back;
        }
      }
  }
};

// 1 where all pixels within `by` along x and y are set, those outside of the picture counted as set.
std::vector<std::uint8_t> eroded(const std::vector<std::uint8_t>& set, ImageSize size, int by) {
  std::vector<std::uint8_t> rows(set.size()), both(set.size());
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x);
  };
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      rows[at(x, y)] = 1;
      for (int k = std::max(x - by, 0); k <= std::min(x + by, size.width - 1); ++k) rows[at(x, y)] &= set[at(k, y)];
    }
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      both[at(x, y)] = 1;
      for (int k = std::max(y - by, 0); k <= std::min(y + by, size.height - 1); ++k) both[at(x, y)] &= rows[at(x, k)];
    }
  return both;
}

std::vector<std::uint8_t> silhouette(const LeakConfig& config, ImageSize size) {
  const std::size_t pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  if (config.full_depth.empty()) return std::vector<std::uint8_t>(pixels, 0);
  if (config.full_depth.size() != pixels || config.silhouette_tolerance < 0)
    throw InputError("leaks: the depth of the full model must have the pixels of the picture, the tolerance be >= 0");
  std::vector<std::uint8_t> covered(pixels);
  for (std::size_t i = 0; i < pixels; ++i) covered[i] = config.full_depth[i] < 1 ? 1 : 0;
  return eroded(covered, size, config.silhouette_tolerance);
}

// The class of a pixel.
enum PixelFlag : std::uint8_t { is_covered = 1, is_torn = 2, shows_back = 4 };

// `expected`: the sum along a ray that meets no crack.
std::uint8_t flags_of(const Band& band, std::size_t i, std::int32_t expected) {
  const bool torn = band.sum[i] != expected, back = band.nearest[i] == Band::back && expected == 0;
  return static_cast<std::uint8_t>((band.nearest[i] != Band::nothing ? is_covered : 0) | (torn ? is_torn : 0) |
                                   (back ? shows_back : 0));
}

// Marks the holes, uncovered pixels inside the silhouette, that hang together with a torn pixel.
std::vector<std::uint8_t> torn_holes(const std::vector<std::uint8_t>& flags, const std::vector<std::uint8_t>& inside,
                                     ImageSize size) {
  std::vector<std::uint8_t> marked(flags.size(), 0);
  std::vector<std::size_t> open;
  const auto mark_around = [&](std::size_t i) {
    const int x = static_cast<int>(i % static_cast<std::size_t>(size.width)),
              y = static_cast<int>(i / static_cast<std::size_t>(size.width));
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, size.height - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, size.width - 1); ++u) {
        const std::size_t k =
            static_cast<std::size_t>(v) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(u);
        if (marked[k] || !inside[k] || (flags[k] & is_covered)) continue;
        marked[k] = 1;
        open.push_back(k);
      }
  };
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i] & is_torn) mark_around(i);
  while (!open.empty()) {
    const std::size_t i = open.back();
    open.pop_back();
    mark_around(i);
  }
  return marked;
}

LeakReport classify(const std::vector<std::uint8_t>& flags, const std::vector<std::uint8_t>& inside, ImageSize size) {
  LeakReport report;
  report.leaks = torn_holes(flags, inside, size);
  for (std::size_t i = 0; i < flags.size(); ++i) {
    const bool covered = flags[i] & is_covered, torn = flags[i] & is_torn, back = flags[i] & shows_back;
    report.covered += covered ? 1 : 0;
    report.inside += inside[i];
    report.torn += torn ? 1 : 0;
    report.back_faces += torn && back ? 1 : 0;
    report.folded += !torn && back ? 1 : 0;
    report.background += report.leaks[i];
    report.outline += !covered && inside[i] && !report.leaks[i] ? 1 : 0;
    if (torn && back) report.leaks[i] = 1;
  }
  return report;
}

}  // namespace

LeakReport find_leaks(std::span<const Vec3d> positions, std::span<const Triangle> triangles, const Screen& screen,
                      Scheduler& scheduler, const LeakConfig& config) {
  const ImageSize size = screen.size();
  const std::vector<std::uint8_t> inside = silhouette(config, size);
  const WindowTriangles window(positions, triangles, screen, scheduler);
  const bool turned = volume(positions, triangles) < 0;
  const Eye eye = eye_of(screen.view_projection());
  // From within the surface a ray leaves it once more than it enters.
  std::int32_t expected = 0;
  if (eye.w != 0) {
    const double around = winding(positions, triangles, to_double((1 / eye.w) * eye.at));
    expected = -static_cast<std::int32_t>(std::lround(turned ? -around : around));
  }

  std::vector<std::uint8_t> flags(inside.size());
  scheduler.for_chunks(static_cast<std::size_t>(size.height), band_rows, [&](ChunkRange chunk) {
    Band band(static_cast<int>(chunk.begin), static_cast<int>(chunk.end - chunk.begin), size.width);
    window.for_each(
        [&](const SnappedVertex& a, const SnappedVertex& b, const SnappedVertex& c) { band.draw(a, b, c, turned); });
    const std::size_t first = chunk.begin * static_cast<std::size_t>(size.width);
    for (std::size_t i = 0; i < band.sum.size(); ++i) flags[first + i] = flags_of(band, i, expected);
  });
  return classify(flags, inside, size);
}

LeakReport find_leaks(const MorphContext& context, const Selection& selection, const Screen& screen,
                      Scheduler& scheduler, const LeakConfig& config) {
  const DrawnMesh mesh = drawn_mesh(context, selection);
  return find_leaks(mesh.positions, mesh.triangles, screen, scheduler, config);
}

}  // namespace lodestone
