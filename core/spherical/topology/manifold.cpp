#include "core/spherical/topology/manifold.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/sort_unique.h"
#include "core/mesh/edge_pairing.h"
#include "core/mesh/vertex_of.h"
#include "core/spherical/topology/sides.h"

namespace lodestone::spherical {
namespace {

using Entries = std::span<const EdgeSides::Entry>;

// The triangles of the mesh with vertices for wedges, without degenerate ones.
Surface weld(const IndexedMesh& mesh) {
  Surface welded;
  welded.triangles.reserve(mesh.triangles.size());
  welded.source_triangle.reserve(mesh.triangles.size());
  for (Id t = 0; t < mesh.triangles.size(); ++t) {
    Triangle triangle = mesh.triangles[t];
    for (Id& v : triangle.v) v = vertex_of(mesh, v);
    if (is_degenerate(triangle)) continue;
    welded.triangles.push_back(triangle);
    welded.source_triangle.push_back(t);
  }
  return welded;
}

bool runs_up(std::span<const Triangle> triangles, Id side) {
  return start_of(triangles, side) < end_of(triangles, side);
}

bool are_opposed(std::span<const Triangle> triangles, Entries entries) {
  return runs_up(triangles, entries[0].side) != runs_up(triangles, entries[1].side);
}

// Turns triangles until neighbours agree, as far as patches have two sides; the fewer triangles of a patch are turned.
std::uint64_t turn_triangles(std::vector<Triangle>& triangles, const EdgeSides& edges) {
  std::vector<Id> across(3 * triangles.size(), no_id);
  bool agree = true;
  edges.for_each_edge([&](Id, Id, Entries entries) {
    if (entries.size() != 2) return;
    across[entries[0].side] = entries[1].side;
    across[entries[1].side] = entries[0].side;
    agree = agree && are_opposed(triangles, entries);
  });
  if (agree) return 0;
  enum class State : std::uint8_t { unknown, kept, turned };
  std::vector<State> states(triangles.size(), State::unknown);
  std::vector<Id> patch;
  std::uint64_t turned = 0;
  for (Id first = 0; first < triangles.size(); ++first) {
    if (states[first] != State::unknown) continue;
    patch.assign(1, first);
    states[first] = State::kept;
    for (std::size_t at = 0; at < patch.size(); ++at)
      for (Id side = 3 * patch[at]; side < 3 * patch[at] + 3; ++side) {
        if (across[side] == no_id || states[across[side] / 3] != State::unknown) continue;
        const bool agrees = runs_up(triangles, side) != runs_up(triangles, across[side]);
        states[across[side] / 3] = (states[patch[at]] == State::kept) == agrees ? State::kept : State::turned;
        patch.push_back(across[side] / 3);
      }
    const auto count = std::count_if(patch.begin(), patch.end(), [&](Id t) { return states[t] == State::turned; });
    const State fewer = 2 * static_cast<std::size_t>(count) > patch.size() ? State::kept : State::turned;
    for (const Id t : patch)
      if (states[t] == fewer) std::swap(triangles[t].v[1], triangles[t].v[2]), ++turned;
  }
  return turned;
}

// Which sides belong together.
struct Seams {
  std::vector<Id> opposite;   // by side; no_id: none
  std::vector<Id> irregular;  // sides at edges other than plain ones
};

Seams find_seams(const IndexedMesh& mesh, std::span<const Triangle> triangles, const EdgeSides& edges,
                 ManifoldRepairs& repairs) {
  Seams seams{std::vector<Id>(3 * triangles.size(), no_id), {}};
  const auto join = [&](Id a, Id b) { seams.opposite[a] = b, seams.opposite[b] = a; };
  edges.for_each_edge([&](Id low, Id high, Entries entries) {
    if (entries.size() == 1) return;
    if (entries.size() == 2 && are_opposed(triangles, entries)) return join(entries[0].side, entries[1].side);
    for (const EdgeSides::Entry& entry : entries) seams.irregular.push_back(entry.side);
    ++(entries.size() == 2 ? repairs.clashing_edges : repairs.nonmanifold_edges);
    if (!is_lower(mesh.positions[low], mesh.positions[high])) std::swap(low, high);
    std::vector<EdgeTriangle> around;
    for (const auto& [other, side] : entries) {
      const Vec3f third = mesh.positions[start_of(triangles, previous_side(side))];
      around.push_back({side, start_of(triangles, side) == low, third});
    }
    for (const auto& [backward, forward] : pair_around_edge(mesh.positions[low], mesh.positions[high], around))
      join(backward, forward);
  });
  return seams;
}

// Numbers the fans, in the order of their first corners: each is a vertex. Renames the corners and returns the sources
// of the vertices.
std::vector<Id> number_fans(std::vector<Triangle>& triangles, std::span<const Id> opposite, std::size_t vertex_count,
                            ManifoldRepairs& repairs) {
  std::vector<Id> fan(opposite.size(), no_id), source;
  source.reserve(vertex_count);
  std::vector<std::uint8_t> seen(vertex_count);
  for (Id first = 0; first < fan.size(); ++first) {
    if (fan[first] != no_id) continue;
    const auto name = static_cast<Id>(source.size());
    const Id vertex = start_of(triangles, first);
    source.push_back(vertex);
    if (seen[vertex] > 0) ++repairs.vertex_copies;
    if (seen[vertex] == 1) ++repairs.pinched_vertices;
    seen[vertex] = static_cast<std::uint8_t>(std::min(2, seen[vertex] + 1));
    Id corner = first;
    do {
      fan[corner] = name;
      corner = opposite[previous_side(corner)];
    } while (corner != no_id && corner != first);
    if (corner == first) continue;
    for (corner = opposite[first]; corner != no_id; corner = opposite[corner]) {
      corner = next_side(corner);
      fan[corner] = name;
    }
  }
  for (Id side = 0; side < fan.size(); ++side) triangles[side / 3].v[side % 3] = fan[side];
  return source;
}

// One side of every edge that has to be halved: further edges between the same ends, and all of two triangles that
// share all their sides.
std::vector<Id> find_repeats(std::span<const Triangle> triangles, const Seams& seams) {
  std::vector<Id> repeats;
  std::vector<std::tuple<Id, Id, Id>> ends;
  for (const Id side : seams.irregular)
    if (seams.opposite[side] == no_id || side < seams.opposite[side]) {
      const std::pair<Id, Id> both = std::minmax(start_of(triangles, side), end_of(triangles, side));
      ends.emplace_back(both.first, both.second, side);
    }
  std::sort(ends.begin(), ends.end());
  for (std::size_t k = 1; k < ends.size(); ++k) {
    const auto& [low, high, side] = ends[k];
    if (low == std::get<0>(ends[k - 1]) && high == std::get<1>(ends[k - 1])) repeats.push_back(side);
  }
  for (Id side = 0; side < seams.opposite.size(); side += 3) {
    const Id a = seams.opposite[side], b = seams.opposite[side + 1], c = seams.opposite[side + 2];
    if (a == no_id || b == no_id || c == no_id || a / 3 != b / 3 || b / 3 != c / 3 || a < side) continue;
    for (const Id of_both : {side, side + 1, side + 2}) repeats.push_back(of_both);
  }
  sort_unique(repeats);
  return repeats;
}

// Halves edges: their triangles become fans around a vertex inside.
void halve(Surface& surface, std::span<const Id> opposite, std::span<const Id> repeats) {
  std::vector<Id> middle(opposite.size(), no_id);
  const auto add = [&](Vec3d position, SourceVertex source) {
    surface.positions.push_back(position);
    surface.source_vertex.push_back(source);
    return static_cast<Id>(surface.positions.size() - 1);
  };
  const auto position = [&](Id side) { return surface.positions[start_of(surface.triangles, side)]; };
  const auto source = [&](Id side) { return surface.source_vertex[start_of(surface.triangles, side)].a; };
  for (const Id side : repeats) {
    middle[side] = add(0.5 * (position(side) + position(next_side(side))), {source(side), source(next_side(side))});
    if (opposite[side] != no_id) middle[opposite[side]] = middle[side];
  }
  const auto count = static_cast<Id>(surface.triangles.size());
  for (Id t = 0; t < count; ++t) {
    std::vector<Id> ring;
    for (Id side = 3 * t; side < 3 * t + 3; ++side) {
      ring.push_back(start_of(surface.triangles, side));
      if (middle[side] != no_id) ring.push_back(middle[side]);
    }
    if (ring.size() == 3) continue;
    const Id centre = add((1.0 / 3) * (position(3 * t) + position(3 * t + 1) + position(3 * t + 2)), no_source);
    surface.triangles[t] = {{ring.back(), ring.front(), centre}};
    for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
      surface.triangles.push_back({{ring[k], ring[k + 1], centre}});
      surface.source_triangle.push_back(surface.source_triangle[t]);
    }
  }
}

}  // namespace

Manifold make_manifold(const IndexedMesh& mesh) {
  Manifold result{weld(mesh), {}};
  Surface& surface = result.surface;
  const std::size_t vertices = mesh.positions.size();
  EdgeSides edges(surface.triangles, vertices);
  result.repairs.turned_triangles = turn_triangles(surface.triangles, edges);
  if (result.repairs.turned_triangles > 0) edges = EdgeSides(surface.triangles, vertices);
  const Seams seams = find_seams(mesh, surface.triangles, edges, result.repairs);
  for (const Id v : number_fans(surface.triangles, seams.opposite, vertices, result.repairs)) {
    surface.source_vertex.emplace_back(v);
    surface.positions.push_back(to_double(mesh.positions[v]));
  }
  const std::vector<Id> repeats = find_repeats(surface.triangles, seams);
  result.repairs.split_edges = repeats.size();
  if (!repeats.empty()) halve(surface, seams.opposite, repeats);
  return result;
}

}  // namespace lodestone::spherical
