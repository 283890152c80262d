#include "tests/naive_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "core/hierarchy/model/fingerprint.h"

namespace lodestone::test {
namespace {

// The smallest float that is not below.
float rounded_up(double v) {
  const auto f = static_cast<float>(v);
  return f < v ? std::nextafter(f, 1e30f) : f;
}

double exact_distance(Vec3f a, Vec3f b) { return length(to_double(a) - to_double(b)); }

struct NaiveCell {
  std::set<std::uint32_t> vertices;  // V_l(C), by the ids of the mesh
  std::vector<Triangle> triangles;   // likewise; none when all have degenerated
};

struct NaiveLevel {
  std::map<std::uint32_t, Vec3f> positions;        // by id
  std::map<std::uint32_t, std::uint32_t> parents;  // P: ids of this level to ids of the next coarser one
  std::map<CellCode, NaiveCell> cells;
};

NaiveLevel finest_level(const IndexedMesh& mesh, int finest) {
  NaiveLevel level;
  for (const Triangle& t : mesh.triangles) {
    const auto& p = mesh.positions;
    NaiveCell& cell = level.cells[CellCode::from(cell_of(barycentre(p[t.v[0]], p[t.v[1]], p[t.v[2]]), finest))];
    cell.triangles.push_back(t);
    cell.vertices.insert(t.v.begin(), t.v.end());
    for (const std::uint32_t v : t.v) level.positions[v] = p[v];
  }
  return level;
}

// Sets P of the level and returns the positions of the next coarser one.
std::map<std::uint32_t, Vec3f> cluster(NaiveLevel& level, double max_displacement, Representative representative) {
  const double diagonal = (representative == Representative::centre ? 2 : 1) * max_displacement;
  const double side = 0.999 * diagonal / std::sqrt(3.0);
  std::map<std::uint32_t, Vec3f> coarser;
  std::map<std::tuple<long, long, long>, std::uint32_t> clusters;
  for (const auto& [id, p] : level.positions) {
    const auto slot = [&](float x) { return std::lround(std::floor(x / side)); };
    const auto centre = [&](float x) { return (static_cast<double>(slot(x)) + 0.5) * side; };
    const auto [found, is_new] = clusters.try_emplace({slot(p.x), slot(p.y), slot(p.z)}, id);
    level.parents[id] = found->second;
    if (!is_new) continue;
    coarser[id] = representative == Representative::vertex ? p : to_float(Vec3d{centre(p.x), centre(p.y), centre(p.z)});
  }
  return coarser;
}

NaiveLevel coarser_level(NaiveLevel& fine, double max_displacement, Representative representative) {
  NaiveLevel coarse;
  coarse.positions = cluster(fine, max_displacement, representative);
  for (const auto& [code, cell] : fine.cells) {
    NaiveCell& parent = coarse.cells[code.parent()];
    for (const std::uint32_t id : cell.vertices) parent.vertices.insert(fine.parents.at(id));
    for (const Triangle& t : cell.triangles) {
      const Triangle image{{fine.parents.at(t.v[0]), fine.parents.at(t.v[1]), fine.parents.at(t.v[2])}};
      if (!is_degenerate(image)) parent.triangles.push_back(image);
    }
  }
  return coarse;
}

std::map<std::uint32_t, int> users_of(const NaiveLevel& level) {
  std::map<std::uint32_t, int> users;
  for (const auto& [code, cell] : level.cells)
    for (const std::uint32_t id : cell.vertices) ++users[id];
  return users;
}

// Local index of every vertex of the cell: those of one cell alone first, then the shared ones, by id.
std::map<std::uint32_t, std::uint32_t> local_ids(const NaiveCell& cell, const std::map<std::uint32_t, int>& users) {
  std::map<std::uint32_t, std::uint32_t> local;
  for (const bool shared : {false, true})
    for (const std::uint32_t id : cell.vertices)
      if ((users.at(id) > 1) == shared) local.try_emplace(id, static_cast<std::uint32_t>(local.size()));
  return local;
}

std::map<std::uint32_t, PackedNormal> normals_of(const NaiveLevel& level) {
  std::map<std::uint32_t, Vec3f> sums;
  for (const auto& [id, p] : level.positions) sums[id] = {};
  for (const auto& [code, cell] : level.cells)
    for (const Triangle& t : cell.triangles) {
      const Vec3f a = level.positions.at(t.v[0]);
      const Vec3f n = cross(level.positions.at(t.v[1]) - a, level.positions.at(t.v[2]) - a);
      for (const std::uint32_t id : t.v) sums[id] = sums[id] + n;
    }
  std::map<std::uint32_t, PackedNormal> packed;
  for (const auto& [id, n] : sums) packed[id] = pack_normal(1e6f * n);
  return packed;
}

// The levels of the mesh, coarsest first, as cells of a hierarchy.
class Assembly {
 public:
  Assembly(const std::vector<NaiveLevel>& levels, NaiveHierarchy& out) : levels_(levels), out_(out) {
    for (std::size_t l = 0; l < levels.size(); ++l) add_level(l);
    out_.attach();
    link_cells();
    measure_cells();
    for (int l = 0; l <= h_.finest(); ++l) measure_level(l);
  }

 private:
  void add_level(std::size_t l) {
    const NaiveLevel& level = levels_[l];
    const auto users = users_of(level), coarser_users = l > 0 ? users_of(levels_[l - 1]) : users;
    const auto normals = normals_of(level);
    Level& out = h_.levels.emplace_back();
    out.first_cell = CellId(h_.cells.size());
    out.cell_count = static_cast<std::uint32_t>(level.cells.size());
    for (const auto& [code, cell] : level.cells) {
      const auto local = local_ids(cell, users);
      NaivePayload& payload = out_.payloads->emplace_back();
      payload.positions.resize(local.size());
      payload.normals.resize(local.size());
      for (const auto& [id, i] : local) {
        payload.positions[i] = level.positions.at(id);
        payload.normals[i] = normals.at(id);
        if (users.at(id) > 1) payload.shared_ids.push_back(id);  // maps iterate by id: the same order as the indices
      }
      if (l > 0) {
        const auto coarser = local_ids(levels_[l - 1].cells.at(code.parent()), coarser_users);
        payload.parents.resize(local.size());
        for (const auto& [id, i] : local) payload.parents[i] = coarser.at(level.parents.at(id));
      }
      for (const Triangle& t : cell.triangles)
        payload.triangles.push_back({{local.at(t.v[0]), local.at(t.v[1]), local.at(t.v[2])}});
      h_.cells.emplace_back().code = code;
      out.triangles += payload.triangles.size();
      out.vertices += payload.positions.size();
    }
  }

  void link_cells() {
    std::map<std::pair<std::size_t, CellCode>, CellId> index;
    for (std::size_t l = 0; l < h_.levels.size(); ++l)
      for (CellId i = h_.levels[l].first_cell; i < h_.levels[l].end_cell(); ++i) {
        index[{l, h_.cells[i].code}] = i;
        if (l == 0) continue;
        h_.cells[i].parent = index.at({l - 1, h_.cells[i].code.parent()});
        Cell& parent = h_.cells[h_.cells[i].parent];
        if (parent.child_count++ == 0) parent.first_child = i;
      }
  }

  // Bounds, displacements and errors: the sum of the displacements bounds the distance.
  void measure_cells() {
    for (std::size_t i = h_.cells.size(); i-- > 0;) {  // children come after their parents
      Cell& cell = h_.cells[i];
      for (const Vec3f p : cell.positions) cell.bounds.extend(p);
      if (cell.child_count == 0) cell.error = h_.transform.lattice.error();
      for (CellId k = cell.first_child; k < cell.end_child(); ++k) {
        cell.bounds.extend(h_.cells[k].bounds);
        cell.error = std::max(cell.error, rounded_up(double{h_.cells[k].error} + h_.cells[k].max_displacement));
      }
      for (std::size_t v = 0; v < cell.parents.size(); ++v)
        cell.max_displacement =
            std::max(cell.max_displacement,
                     rounded_up(exact_distance(cell.positions[v], h_.cells[cell.parent].positions[cell.parents[v]])));
    }
  }

  // Reach, diameter, error and edges of a level, over h_l.
  void measure_level(int l) {
    Level& level = h_.levels[static_cast<std::size_t>(l)];
    const auto raise = [size = double{cell_size(l)}](float& value, double measured) {
      value = std::max(value, rounded_up(measured / size));
    };
    for (const Cell& cell : h_.cells_of(l)) {
      raise(level.error, cell.error);
      raise(level.diameter, exact_distance(cell.bounds.lo, cell.bounds.hi));
      const Vec3d lo = to_double(cell.bounds.lo), hi = to_double(cell.bounds.hi);
      for (const Vec3f& at : cell.positions) {
        const Vec3d p = to_double(at);
        const Vec3d far{std::max(p.x - lo.x, hi.x - p.x), std::max(p.y - lo.y, hi.y - p.y),
                        std::max(p.z - lo.z, hi.z - p.z)};
        raise(level.reach[static_cast<std::size_t>(DistanceMetric::euclidean)], length(far));
        raise(level.reach[static_cast<std::size_t>(DistanceMetric::chebyshev)], std::max({far.x, far.y, far.z}));
      }
      for (const Triangle& t : cell.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
          const double edge = exact_distance(cell.positions[t.v[k]], cell.positions[t.v[(k + 1) % 3]]);
          raise(level.max_edge, edge);
          level.long_edges += edge > double{h_.sigma0} * double{cell_size(l)};
        }
    }
  }

  const std::vector<NaiveLevel>& levels_;
  NaiveHierarchy& out_;
  Hierarchy& h_ = out_.hierarchy;
};

}  // namespace

NaiveHierarchy::NaiveHierarchy(const NaiveHierarchy& other)
    : mesh(other.mesh),
      ancestors(other.ancestors),
      hierarchy(other.hierarchy),
      payloads(std::make_shared<std::vector<NaivePayload>>(*other.payloads)) {
  attach();
}

const Hierarchy& NaiveHierarchy::attach() {
  for (std::size_t i = 0; i < payloads->size(); ++i) {
    const NaivePayload& payload = (*payloads)[i];
    Cell& cell = hierarchy.cells[i];
    cell.positions = payload.positions;
    cell.normals = payload.normals;
    cell.parents = payload.parents;
    cell.shared_ids = payload.shared_ids;
    cell.triangles = payload.triangles;
  }
  hierarchy.storage = payloads;
  return hierarchy;
}

NaiveHierarchy naive_hierarchy(IndexedMesh mesh, int finest, float sigma0, Representative representative) {
  std::vector<NaiveLevel> levels(static_cast<std::size_t>(finest) + 1);
  levels.back() = finest_level(mesh, finest);
  for (std::size_t l = levels.size() - 1; l > 0; --l)
    levels[l - 1] = coarser_level(levels[l], displacement_bound(sigma0, static_cast<int>(l)), representative);

  NaiveHierarchy made;
  made.payloads = std::make_shared<std::vector<NaivePayload>>();
  made.ancestors.resize(levels.size(), std::vector<std::uint32_t>(mesh.positions.size()));
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    made.ancestors.back()[v] = v;
    for (std::size_t l = levels.size() - 1; l > 0 && levels.back().positions.contains(v); --l)
      made.ancestors[l - 1][v] = levels[l].parents.at(made.ancestors[l][v]);
  }
  Hierarchy& h = made.hierarchy;
  h.transform = mesh.transform;
  h.sigma0 = sigma0;
  h.provenance.input_vertices = mesh.positions.size();
  h.provenance.input_triangles = mesh.triangles.size();
  for (const Triangle& t : mesh.triangles)
    h.provenance.fingerprint +=
        triangle_fingerprint(mesh.positions[t.v[0]], mesh.positions[t.v[1]], mesh.positions[t.v[2]]);
  const Assembly assembled(levels, made);
  made.mesh = std::move(mesh);
  return made;
}

}  // namespace lodestone::test
