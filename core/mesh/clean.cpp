#include "core/mesh/clean.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "core/base/error.h"

namespace lodestone {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

using PositionBits = std::array<std::uint32_t, 3>;

PositionBits bits_of(Vec3f p) {
  return {std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y), std::bit_cast<std::uint32_t>(p.z)};
}

std::vector<Triangle> finite_triangles(const RawMesh& raw, Repairs& repairs) {
  std::vector<Triangle> kept;
  for (const Triangle& t : raw.triangles) {
    const bool finite = std::all_of(t.v.begin(), t.v.end(), [&](auto id) { return is_finite(raw.positions[id]); });
    if (finite) kept.push_back(t);
  }
  repairs.non_finite_triangles = raw.triangles.size() - kept.size();
  return kept;
}

Box3d box_of(const RawMesh& raw, const std::vector<Triangle>& triangles) {
  Box3d box;
  for (const Triangle& t : triangles)
    for (const std::uint32_t id : t.v) box.extend(raw.positions[id]);
  return box;
}

}  // namespace

Transform normalising_transform(const Box3d& box, const std::string& name) {
  const Vec3d extent = box.hi - box.lo;
  const double longest = std::max({extent.x, extent.y, extent.z});
  // + 0.0 turns -0 into +0.
  const Transform transform{{box.lo.x + 0.0, box.lo.y + 0.0, box.lo.z + 0.0}, longest > 0 ? longest : 1.0};
  if (!std::isfinite(longest) || !std::isfinite(1 / transform.scale))
    throw InputError(describe(name, "bounding box", "is too large or too small for double precision",
                              "scale the model to an extent between 1e-300 and 1e300"));
  return transform;
}

Lattice resolve_lattice(Lattice asked, std::span<const Vec3d> positions, std::span<const Triangle> triangles,
                        double scale) {
  if (asked.bits == Lattice::automatic) return choose_lattice(positions, triangles, scale);
  if (asked.bits < 0 || asked.bits > Lattice::most_bits)
    throw InputError(describe("", "", "a lattice cannot have " + std::to_string(asked.bits) + " bits",
                              "give 1 to " + std::to_string(Lattice::most_bits) + ", or 0 for none"));
  return asked;
}

void require_survivors(const IndexedMesh& mesh, const Repairs& repairs, const std::string& name) {
  if (!mesh.triangles.empty()) return;
  std::string what = "no triangle is left after cleaning: ";
  what += std::to_string(repairs.non_finite_triangles) + " with a corner that is not finite, ";
  what += std::to_string(repairs.degenerate_triangles) + " with two equal vertices, ";
  what += std::to_string(repairs.faces_dropped) + " faces of fewer than three corners";
  throw InputError(describe(name, "", what, "give a mesh with a surface"));
}

IndexedMesh clean_mesh(const RawMesh& raw, Repairs& repairs, const std::string& name, Lattice lattice) {
  repairs = {};
  repairs.polygons_triangulated = raw.polygons_triangulated;
  repairs.faces_dropped = raw.faces_dropped;
  repairs.void_posts = raw.void_posts;
  repairs.filled_posts = raw.filled_posts;
  IndexedMesh mesh;
  std::vector<Triangle> triangles = finite_triangles(raw, repairs);
  require_survivors({{}, triangles, {}}, repairs, name);
  mesh.transform = normalising_transform(box_of(raw, triangles), name);
  mesh.transform.lattice = resolve_lattice(lattice, raw.positions, raw.triangles, mesh.transform.scale);
  mesh.transform.up = raw.up;

  // Weld the vertices in use, each into the first at its position.
  std::vector<bool> used(raw.positions.size(), false);
  for (const Triangle& t : triangles)
    for (const std::uint32_t id : t.v) used[id] = true;
  std::map<PositionBits, std::uint32_t> first_at;
  std::vector<std::uint32_t> representative(raw.positions.size(), none);
  for (std::uint32_t id = 0; id < raw.positions.size(); ++id) {
    if (!used[id]) continue;
    const auto [entry, is_new] = first_at.emplace(bits_of(normalise(mesh.transform, raw.positions[id])), id);
    representative[id] = entry->second;
    if (!is_new) ++repairs.welded_vertices;
  }

  std::set<std::array<std::uint32_t, 3>> seen;
  for (Triangle t : triangles) {
    for (std::uint32_t& id : t.v) id = representative[id];
    if (is_degenerate(t)) {
      ++repairs.degenerate_triangles;
    } else if (!seen.insert(canonical(t).v).second) {
      ++repairs.duplicate_triangles;
    } else {
      mesh.triangles.push_back(t);
    }
  }
  require_survivors(mesh, repairs, name);

  // Number the remaining vertices, in their order.
  used.assign(raw.positions.size(), false);
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t id : t.v) used[id] = true;
  std::vector<std::uint32_t> number(raw.positions.size(), none);
  for (std::uint32_t id = 0; id < raw.positions.size(); ++id) {
    if (!used[id]) continue;
    number[id] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(normalise(mesh.transform, raw.positions[id]));
  }
  for (Triangle& t : mesh.triangles)
    for (std::uint32_t& id : t.v) id = number[id];
  repairs.unreferenced_vertices = raw.positions.size() - mesh.positions.size() - repairs.welded_vertices;
  return mesh;
}

}  // namespace lodestone
