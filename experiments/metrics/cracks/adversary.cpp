#include "experiments/metrics/cracks/adversary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/hierarchy/model/distance_metric.h"
#include "core/hierarchy/model/signatures.h"

namespace lodestone {
namespace {

// The cells of one level that use each shared vertex.
class Users {
 public:
  Users(const Hierarchy& hierarchy, int level) {
    const CellId first = hierarchy.levels[static_cast<std::size_t>(level)].first_cell;
    CellId cell = first;
    for (const Cell& c : hierarchy.cells_of(level)) {
      for (const std::uint32_t id : c.shared_ids) users_.push_back(std::uint64_t{id} << 32 | cell);
      ++cell;
    }
    std::sort(users_.begin(), users_.end());
  }

  // A cell other than `cell` that uses the vertex: preferably one that satisfies the condition; no_cell without any.
  template <typename Condition>
  [[nodiscard]] CellId find(std::uint32_t id, CellId cell, const Condition& condition) const {
    CellId found = no_cell;
    for (auto user = std::lower_bound(users_.begin(), users_.end(), std::uint64_t{id} << 32);
         user != users_.end() && *user >> 32 == id; ++user) {
      const CellId other(*user);
      if (other == cell) continue;
      found = other;
      if (condition(other)) break;
    }
    return found;
  }

 private:
  std::vector<std::uint64_t> users_;  // shared id, index of the cell
};

Vec3d farthest_corner(Vec3f p, const Box3f& box) {
  const auto far = [](float lo, float hi, float v) { return std::abs(v - lo) > std::abs(hi - v) ? lo : hi; };
  return {far(box.lo.x, box.hi.x, p.x), far(box.lo.y, box.hi.y, p.y), far(box.lo.z, box.hi.z, p.z)};
}

// Beyond the corner by `radius`: z + radius (z - u) / d(u, z). In both metrics the box's nearest point is then z.
Vec3f viewpoint_beyond(DistanceMetric metric, Vec3f u, const Box3f& box, double radius) {
  const Vec3d z = farthest_corner(u, box), way = z - to_double(u);
  return to_float(z + (radius / norm(metric, way)) * way);
}

// The level whose views are sought.
struct ViewedLevel {
  const Hierarchy& hierarchy;
  const Radii& radii;
  int level;
  double slack;
  Users users{hierarchy, level};
};

AdversarialView view_of_vertex(const ViewedLevel& viewed, CellId id, VertexId u) {
  const auto& [hierarchy, radii, level, slack, users] = viewed;
  const Cell& cell = hierarchy.cells[id];
  const DistanceMetric metric = radii.metric;
  const float radius = radii.select[static_cast<std::size_t>(level)];
  const auto beyond = [&](double r) { return viewpoint_beyond(metric, cell.positions[u], cell.bounds, r); };
  const Vec3f inside = beyond(radius * (1 - slack)), outside = beyond(radius * (1 + slack));
  const auto unrefined = [&viewed, inside, radius](CellId c) {
    return distance(viewed.radii.metric, inside, viewed.hierarchy.cells[c].bounds) >= radius;
  };
  AdversarialView view;
  view.level = level;
  view.cell = id;
  view.vertex = u;
  view.other = users.find(cell.shared_ids[u - cell.first_shared()], id, unrefined);
  view.refined = view.other != no_cell && unrefined(view.other);
  view.viewpoint = view.refined ? inside : outside;
  view.across = view.refined ? outside : inside;
  view.reach = farthest_corner_distance(radii.metric, cell.positions[u], cell.bounds) / hierarchy.cell_size(level);
  return view;
}

// The view of the cell's shared vertex of largest reach that has somewhere to go.
std::optional<AdversarialView> best_view(const ViewedLevel& viewed, CellId id) {
  const Cell& cell = viewed.hierarchy.cells[id];
  const std::span<const Vec3f> parents = viewed.hierarchy.cells[cell.parent].positions;
  std::optional<VertexId> best;
  float best_reach = 0;
  for (VertexId u(cell.first_shared()); u < cell.positions.size(); ++u) {
    const float reach = farthest_corner_distance(viewed.radii.metric, cell.positions[u], cell.bounds);
    if (reach <= best_reach || parents[cell.parents[u]] == cell.positions[u]) continue;
    best = u;
    best_reach = reach;
  }
  if (!best) return std::nullopt;
  return view_of_vertex(viewed, id, *best);
}

// The vertex of a cell with this signature that has the longest way to its parent, if any moves; and that way.
std::optional<std::pair<VertexId, float>> mover_of(const ViewedLevel& viewed, CellId id, std::uint32_t signature) {
  const Signatures& signatures = *viewed.radii.signatures;
  const Cell& cell = viewed.hierarchy.cells[id];
  const std::span<const Vec3f> parents = viewed.hierarchy.cells[cell.parent].positions;
  const std::span<const std::uint8_t> places = signatures.places(id);
  std::optional<std::pair<VertexId, float>> found;
  for (std::uint32_t k = 0; k < places.size(); ++k) {
    if (signatures.of(id)[places[k]] != signature) continue;
    const VertexId v(cell.first_shared() + k);
    const float way = length(parents[cell.parents[v]] - cell.positions[v]);
    if (way > (found ? found->second : 0)) found = {v, way};
  }
  return found;
}

// The view on the ray from one cell's parent through the corner of the other cell that is farthest from it.
AdversarialView view_of_boxes(const ViewedLevel& viewed, CellId id, CellId parent, CellId other) {
  const Radii& radii = viewed.radii;
  const Box3f &box = viewed.hierarchy.cells[id].bounds, &outer = viewed.hierarchy.cells[parent].bounds;
  const Vec3d over = overhang(box, outer);
  const auto way = [](double length, float hi, float outer_hi) { return hi > outer_hi ? length : -length; };
  const Vec3d out{way(over.x, box.hi.x, outer.hi.x), way(over.y, box.hi.y, outer.hi.y),
                  way(over.z, box.hi.z, outer.hi.z)};
  const auto corner = [](double towards, float lo, float hi) { return double{towards < 0 ? lo : hi}; };
  const Vec3d z{corner(out.x, box.lo.x, box.hi.x), corner(out.y, box.lo.y, box.hi.y),
                corner(out.z, box.lo.z, box.hi.z)};
  const double radius = radii.by_cell[id], apart = norm(radii.metric, out);
  AdversarialView view;
  view.viewpoint = to_float(z + (radius * (1 - viewed.slack) / apart) * out);
  view.across = to_float(z + (radius * (1 + viewed.slack) / apart) * out);
  view.level = viewed.level;
  view.cell = id, view.other = other;
  view.refined = true;
  view.reach = static_cast<float>((radius + apart) / radii.by_cell[parent]);
  return view;
}

// One view per cell that shares a moving vertex with another cell's parent beyond which it reaches, the best first:
// those that crack by how far apart they do, then those that come nearest to it.
std::vector<AdversarialView> box_views(const ViewedLevel& viewed) {
  const Signatures& signatures = *viewed.radii.signatures;
  const auto& cells = viewed.hierarchy.cells;
  std::map<CellId, std::pair<float, AdversarialView>> best;  // by cell, with its rank
  for (std::uint32_t s = signatures.first(viewed.level); s < signatures.first(viewed.level + 1); ++s) {
    const std::span<const CellId> users = signatures.users(s).cells;
    for (const CellId id : users) {
      const auto mover = mover_of(viewed, id, s);
      if (!mover || !(viewed.radii.by_cell[id] > 0)) continue;
      for (const CellId other : users) {
        const CellId parent = cells[other].parent;
        if (overhang(cells[id].bounds, cells[parent].bounds) == Vec3d{}) continue;
        AdversarialView view = view_of_boxes(viewed, id, parent, other);
        view.vertex = mover->first;
        const float rank = view.reach > 1 ? 1 + mover->second : view.reach;
        const auto [found, is_new] = best.try_emplace(id, rank, view);
        if (!is_new && rank > found->second.first) found->second = {rank, view};
      }
    }
  }
  std::vector<std::pair<float, AdversarialView>> ranked;
  for (const auto& [id, found] : best) ranked.push_back(found);
  std::ranges::stable_sort(ranked, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<AdversarialView> views;
  for (const auto& [rank, view] : ranked) views.push_back(view);
  return views;
}

// One view per cell that has one, the best first: by reach, or as box_views has them.
std::vector<AdversarialView> best_views(const ViewedLevel& viewed, std::size_t most) {
  std::vector<AdversarialView> found;
  if (!viewed.radii.by_cell.empty()) {
    found = box_views(viewed);
  } else {
    const Level& level = viewed.hierarchy.levels[static_cast<std::size_t>(viewed.level)];
    for (CellId cell = level.first_cell; cell < level.end_cell(); ++cell)
      if (const auto view = best_view(viewed, cell)) found.push_back(*view);
    std::stable_sort(found.begin(), found.end(),
                     [](const AdversarialView& a, const AdversarialView& b) { return a.reach > b.reach; });
  }
  found.resize(std::min(found.size(), most));
  return found;
}

// Numbers of views: levels take turns until `count` are together.
std::vector<std::size_t> shares(const std::vector<std::vector<AdversarialView>>& levels, std::size_t count) {
  std::vector<std::size_t> share(levels.size(), 0);
  bool any = true;
  while (any && count > 0) {
    any = false;
    for (std::size_t i = 0; i < levels.size() && count > 0; ++i)
      if (share[i] < levels[i].size()) ++share[i], --count, any = true;
  }
  return share;
}

}  // namespace

std::vector<AdversarialView> adversarial_views(const Hierarchy& hierarchy, const Radii& radii,
                                               const AdversaryConfig& config) {
  std::vector<std::vector<AdversarialView>> levels;
  for (int level = 1; level < hierarchy.finest(); ++level)
    levels.push_back(best_views({hierarchy, radii, level, config.slack}, config.count));
  const std::vector<std::size_t> share = shares(levels, config.count);
  std::vector<AdversarialView> views;
  for (std::size_t i = 0; i < levels.size(); ++i)
    views.insert(views.end(), levels[i].begin(), levels[i].begin() + static_cast<std::ptrdiff_t>(share[i]));
  return views;
}

std::string why_no_adversary(const Hierarchy& hierarchy) {
  const std::string remedy =
      "look at it with --camera orbit, or build it with smaller cells (--cell-triangles, --levels)";
  if (hierarchy.levels.size() <= 2)
    return describe("", "",
                    "a hierarchy of one or two levels draws cells of one level only: it cannot crack, and no viewpoint "
                    "is adversarial",
                    remedy);
  return describe("", "", "no vertex that cells of this hierarchy share moves between its levels: it cannot crack",
                  remedy);
}

}  // namespace lodestone
