#include "experiments/metrics/cracks/t_junctions.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/error.h"
#include "core/spatial/box_tree.h"
#include "core/spatial/point_triangle.h"
#include "experiments/metrics/drawn/border.h"
#include "experiments/metrics/drawn/drawn_mesh.h"

namespace lodestone {
namespace {

constexpr std::size_t edges_per_chunk = 1024;

struct BorderVertex {
  Vec3d position;
  std::uint32_t id = 0;
};

std::vector<BorderVertex> border_vertices(const std::vector<BorderEdge>& border, std::span<const Vec3d> positions) {
  std::vector<BorderVertex> points;
  for (const BorderEdge& edge : border)
    for (std::size_t k = 0; k < 2; ++k) points.push_back({positions[edge.vertex[k]], edge.end[k]});
  const auto by_id = [](const BorderVertex& a, const BorderVertex& b) { return a.id < b.id; };
  std::sort(points.begin(), points.end(), by_id);
  points.erase(std::unique(points.begin(), points.end(), [](auto& a, auto& b) { return a.id == b.id; }), points.end());
  return points;
}

// Its distance, or nothing (negative) where the vertex does not lie inside the edge.
double distance_inside(Vec3d p, Vec3d a, Vec3d b, double tolerance) {
  const NearestPoint foot = nearest_on_segment(p, a, b);
  const double limit = tolerance * tolerance;
  const bool inside = foot.squared_distance <= limit && squared_length(foot.point - a) > limit &&
                      squared_length(foot.point - b) > limit;
  return inside ? std::sqrt(foot.squared_distance) : -1;
}

BoxTree tree_of(const std::vector<BorderVertex>& points) {
  std::vector<BoxTree::Item> items(points.size());
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    extend(items[i].box, points[i].position);
    items[i].number = i;
  }
  return items.empty() ? BoxTree() : BoxTree(std::move(items), 4);
}

// More than the tolerance by what the tests of boxes may round off.
double search_distance(std::span<const BorderVertex> points, double tolerance) {
  double largest = 1;
  for (const auto& [p, id] : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return tolerance * (1 + 1e-9) + 1e-14 * largest;
}

struct Part {
  TJunctionReport report;
  std::vector<std::uint32_t> vertices;  // numbers of border vertices
};

void add_junction(double distance, Vec3d where, TJunctionReport& report) {
  if (report.junctions++ == 0 || distance > report.worst) {
    report.worst = distance;
    report.where = where;
  }
}

}  // namespace

TJunctionReport t_junctions(std::span<const Vec3d> positions, std::span<const Triangle> triangles, double tolerance,
                            Scheduler& scheduler) {
  if (!(tolerance >= 0 && std::isfinite(tolerance)))
    throw InputError("the tolerance of T-junctions must be at least 0 and finite");
  if (!std::all_of(positions.begin(), positions.end(), [](Vec3d p) { return is_finite(p); }))
    throw InputError("T-junctions: a position is not finite; clean the mesh first");
  const std::vector<BorderEdge> border = border_edges(positions, triangles);
  const std::vector<BorderVertex> points = border_vertices(border, positions);
  const BoxTree tree = tree_of(points);
  const double searched = search_distance(points, tolerance);

  std::vector<Part> parts(chunk_count(border.size(), edges_per_chunk));
  scheduler.for_chunks(border.size(), edges_per_chunk, [&](ChunkRange chunk) {
    Part& part = parts[chunk.index];
    for (std::size_t e = chunk.begin; e < chunk.end; ++e) {
      const BorderEdge& edge = border[e];
      const Vec3d a = positions[edge.vertex[0]], b = positions[edge.vertex[1]];
      const BoxLine line(a, b - a);
      const auto accepts = [&](const Box3f& box) {
        const auto [enter, leave] = line.clip(box, searched, 0, 1);
        return enter <= leave;
      };
      tree.walk(accepts, [&](BoxTree::Slots slots) {
        for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) {
          const std::uint32_t number = tree.items()[slot];
          const BorderVertex& vertex = points[number];
          if (vertex.id == edge.end[0] || vertex.id == edge.end[1]) continue;
          const double distance = distance_inside(vertex.position, a, b, tolerance);
          if (distance < 0) continue;
          add_junction(distance, vertex.position, part.report);
          part.vertices.push_back(number);
        }
        return false;
      });
    }
  });

  TJunctionReport report;
  report.border_edges = border.size();
  std::vector<std::uint8_t> lies(points.size(), 0);
  for (const Part& part : parts) {
    for (const std::uint32_t v : part.vertices) lies[v] = 1;
    if (part.report.junctions > 0 && (report.junctions == 0 || part.report.worst > report.worst)) {
      report.worst = part.report.worst;
      report.where = part.report.where;
    }
    report.junctions += part.report.junctions;
  }
  report.vertices = static_cast<std::uint64_t>(std::count(lies.begin(), lies.end(), std::uint8_t{1}));
  return report;
}

TJunctionReport t_junctions(const MorphContext& context, const Selection& selection, double tolerance,
                            Scheduler& scheduler) {
  const DrawnMesh mesh = drawn_mesh(context, selection);
  return t_junctions(mesh.positions, mesh.triangles, tolerance, scheduler);
}

}  // namespace lodestone
