#include "tests/core/hierarchy/tiny_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "core/hierarchy/model/fingerprint.h"

namespace lodestone::test {
namespace {

float round_up(double v) {
  const auto f = static_cast<float>(v);
  return f < v ? std::nextafter(f, 1e30f) : f;
}

double distance_double(Vec3f a, Vec3f b) { return length(to_double(a) - to_double(b)); }

// One level as the design defines it: triangles of global ids by cell, vertices of each cell, P to the next level.
struct PlainLevel {
  std::map<CellCode, std::vector<Triangle>> triangles;  // every cell, also when its triangles have degenerated
  std::map<CellCode, std::set<std::uint32_t>> vertices;
  std::map<std::uint32_t, std::uint32_t> parent;
};

PlainLevel finest_level(const IndexedMesh& mesh, int level) {
  PlainLevel result;
  for (const Triangle& t : mesh.triangles) {
    const auto& p = mesh.positions;
    const CellCode code = CellCode::from(cell_of(barycentre(p[t.v[0]], p[t.v[1]], p[t.v[2]]), level));
    result.triangles[code].push_back(t);
    result.vertices[code].insert(t.v.begin(), t.v.end());
  }
  return result;
}

void choose_parents(PlainLevel& level, const IndexedMesh& mesh, float bound) {
  const double pitch = 0.99 * bound / std::sqrt(3.0);
  std::map<std::tuple<long, long, long>, std::uint32_t> lowest;
  const auto cluster = [&](std::uint32_t v) {
    const Vec3f p = mesh.positions[v];
    return std::tuple(std::lround(p.x / pitch), std::lround(p.y / pitch), std::lround(p.z / pitch));
  };
  std::set<std::uint32_t> all;
  for (const auto& [code, ids] : level.vertices) all.insert(ids.begin(), ids.end());
  for (const std::uint32_t v : all) lowest.emplace(cluster(v), v);
  for (const std::uint32_t v : all) level.parent[v] = lowest.at(cluster(v));
}

PlainLevel coarser_level(const PlainLevel& fine) {
  PlainLevel result;
  for (const auto& [code, triangles] : fine.triangles) {
    auto& out = result.triangles[code.parent()];
    for (const Triangle& t : triangles) {
      const Triangle image{{fine.parent.at(t.v[0]), fine.parent.at(t.v[1]), fine.parent.at(t.v[2])}};
      if (!is_degenerate(image)) out.push_back(image);
    }
    for (const std::uint32_t v : fine.vertices.at(code)) result.vertices[code.parent()].insert(fine.parent.at(v));
  }
  return result;
}

// Local order of a cell's vertices: those of this cell alone first, then the shared ones, both by id.
std::vector<std::uint32_t> local_order(const std::set<std::uint32_t>& ids, const std::map<std::uint32_t, int>& uses) {
  std::vector<std::uint32_t> order(ids.begin(), ids.end());
  std::stable_partition(order.begin(), order.end(), [&](std::uint32_t v) { return uses.at(v) == 1; });
  return order;
}

std::map<std::uint32_t, int> count_uses(const PlainLevel& level) {
  std::map<std::uint32_t, int> uses;
  for (const auto& [code, ids] : level.vertices)
    for (const std::uint32_t v : ids) ++uses[v];
  return uses;
}

std::uint32_t index_in(const std::vector<std::uint32_t>& order, std::uint32_t id) {
  return static_cast<std::uint32_t>(std::find(order.begin(), order.end(), id) - order.begin());
}

void fill_bounds_and_errors(TinyHierarchy& tiny) {
  Hierarchy& h = tiny.tables;
  for (std::size_t i = h.cells.size(); i-- > 0;) {  // children come after their parents
    Cell& cell = h.cells[i];
    for (const Vec3f p : tiny.payloads[i].positions) cell.bounds.extend(p);
    if (cell.child_count == 0) cell.error = h.transform.lattice.error();
    for (std::uint32_t k = cell.first_child; k < cell.first_child + cell.child_count; ++k) {
      cell.bounds.extend(h.cells[k].bounds);
      cell.error = std::max(cell.error, round_up(double{h.cells[k].error} + h.cells[k].max_displacement));
    }
    if (cell.parent == no_cell) continue;
    for (std::size_t v = 0; v < tiny.payloads[i].positions.size(); ++v) {
      const Vec3f to = tiny.payloads[cell.parent].positions[tiny.payloads[i].parents[v]];
      cell.max_displacement =
          std::max(cell.max_displacement, round_up(distance_double(tiny.payloads[i].positions[v], to)));
    }
  }
}

void fill_statistics(TinyHierarchy& tiny) {
  Hierarchy& h = tiny.tables;
  for (int l = 0; l <= h.finest(); ++l) {
    Level& level = h.levels[static_cast<std::size_t>(l)];
    const double size = cell_size(l);
    for (std::uint32_t c = level.first_cell; c < level.first_cell + level.cell_count; ++c) {
      const Cell& cell = h.cells[c];
      const TinyCell& payload = tiny.payloads[c];
      level.triangles += payload.triangles.size();
      level.vertices += payload.positions.size();
      level.error = std::max(level.error, round_up(cell.error / size));
      level.diameter = std::max(level.diameter, round_up(distance_double(cell.bounds.lo, cell.bounds.hi) / size));
      for (const Vec3f p : payload.positions) {
        const Vec3d far{std::max(double{p.x} - cell.bounds.lo.x, double{cell.bounds.hi.x} - p.x),
                        std::max(double{p.y} - cell.bounds.lo.y, double{cell.bounds.hi.y} - p.y),
                        std::max(double{p.z} - cell.bounds.lo.z, double{cell.bounds.hi.z} - p.z)};
        level.reach[0] = std::max(level.reach[0], round_up(length(far) / size));
        level.reach[1] = std::max(level.reach[1], round_up(std::max({far.x, far.y, far.z}) / size));
      }
      for (const Triangle& t : payload.triangles) {
        for (int e = 0; e < 3; ++e) {
          const double edge = distance_double(payload.positions[t.v[static_cast<std::size_t>(e)]],
                                              payload.positions[t.v[static_cast<std::size_t>((e + 1) % 3)]]);
          level.max_edge = std::max(level.max_edge, round_up(edge / size));
          level.long_edges += edge > double{h.sigma0} * size;
        }
      }
    }
  }
}

}  // namespace

IndexedMesh bumpy_sphere(int times, bool open) {
  std::vector<Vec3d> points{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  std::vector<Triangle> triangles{{{0, 1, 2}}, {{1, 3, 2}}, {{3, 4, 2}}, {{4, 0, 2}},
                                  {{1, 0, 5}}, {{3, 1, 5}}, {{4, 3, 5}}, {{0, 4, 5}}};
  if (open) triangles.pop_back();
  for (int i = 0; i < times; ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] = middles.emplace(std::minmax(a, b), static_cast<std::uint32_t>(points.size()));
      if (fresh) {
        const Vec3d sum = points[a] + points[b];
        points.push_back((1 / length(sum)) * sum);
      }
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : triangles) {
      const std::uint32_t ab = middle(t.v[0], t.v[1]), bc = middle(t.v[1], t.v[2]), ca = middle(t.v[2], t.v[0]);
      finer.insert(finer.end(), {{{t.v[0], ab, ca}}, {{ab, t.v[1], bc}}, {{ca, bc, t.v[2]}}, {{ab, bc, ca}}});
    }
    triangles = std::move(finer);
  }
  IndexedMesh mesh;
  mesh.transform = {{10, 20, 30}, 4};
  mesh.triangles = triangles;
  for (const Vec3d p : points) {
    const double radius = 0.4 + 0.05 * std::sin(5 * p.x) * std::cos(4 * p.y) + 0.02 * std::sin(9 * p.z + 1);
    mesh.positions.push_back(to_float(Vec3d{0.5, 0.5, 0.5} + radius * p));
  }
  return mesh;
}

TinyHierarchy tiny_hierarchy(const IndexedMesh& mesh, int finest, float sigma0) {
  std::vector<PlainLevel> plain(static_cast<std::size_t>(finest) + 1);
  plain.back() = finest_level(mesh, finest);
  for (std::size_t l = plain.size() - 1; l > 0; --l) {
    choose_parents(plain[l], mesh, displacement_bound(sigma0, static_cast<int>(l)));
    plain[l - 1] = coarser_level(plain[l]);
  }

  TinyHierarchy tiny;
  Hierarchy& h = tiny.tables;
  h.transform = mesh.transform;
  h.sigma0 = sigma0;
  h.provenance.input_vertices = mesh.positions.size();
  h.provenance.input_triangles = mesh.triangles.size();
  for (const Triangle& t : mesh.triangles)
    h.provenance.fingerprint +=
        triangle_fingerprint(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]);

  std::map<CellCode, std::uint32_t> above;                     // cells of the coarser level by code
  std::map<CellCode, std::vector<std::uint32_t>> order_above;  // and the global ids of their vertices
  for (std::size_t l = 0; l < plain.size(); ++l) {
    const auto uses = count_uses(plain[l]);
    h.levels.push_back({});
    h.levels.back().first_cell = static_cast<std::uint32_t>(h.cells.size());
    h.levels.back().cell_count = static_cast<std::uint32_t>(plain[l].vertices.size());
    std::map<CellCode, std::uint32_t> here;
    std::map<CellCode, std::vector<std::uint32_t>> order_here;
    for (const auto& [code, ids] : plain[l].vertices) {
      const auto order = local_order(ids, uses);
      Cell cell;
      TinyCell payload;
      cell.code = code;
      const auto index = static_cast<std::uint32_t>(h.cells.size());
      if (l > 0) {
        cell.parent = above.at(code.parent());
        Cell& parent = h.cells[cell.parent];
        if (parent.child_count++ == 0) parent.first_child = index;
      }
      for (const std::uint32_t v : order) {
        payload.positions.push_back(mesh.positions[v]);
        payload.normals.push_back(pack_normal(mesh.positions[v] - Vec3f{0.5f, 0.5f, 0.5f}));
        if (uses.at(v) > 1) payload.shared_ids.push_back(v);
        if (l > 0) payload.parents.push_back(index_in(order_above.at(code.parent()), plain[l].parent.at(v)));
      }
      for (const Triangle& t : plain[l].triangles.at(code))
        payload.triangles.push_back({{index_in(order, t.v[0]), index_in(order, t.v[1]), index_in(order, t.v[2])}});
      here[code] = index;
      order_here[code] = order;
      h.cells.push_back(cell);
      tiny.payloads.push_back(std::move(payload));
    }
    above = std::move(here);
    order_above = std::move(order_here);
  }
  fill_bounds_and_errors(tiny);
  fill_statistics(tiny);
  return tiny;
}

Hierarchy TinyHierarchy::hierarchy() const {
  const auto kept = std::make_shared<const std::vector<TinyCell>>(payloads);
  Hierarchy result = tables;
  result.storage = kept;
  for (std::size_t i = 0; i < result.cells.size(); ++i) {
    const TinyCell& payload = (*kept)[i];
    result.cells[i].positions = payload.positions;
    result.cells[i].normals = payload.normals;
    result.cells[i].parents = payload.parents;
    result.cells[i].shared_ids = payload.shared_ids;
    result.cells[i].triangles = payload.triangles;
  }
  return result;
}

}  // namespace lodestone::test
