#include "core/mesh/refine.h"

#include <algorithm>
#include <array>
#include <unordered_set>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "core/mesh/clean_kernels.h"

namespace lodestone {
namespace {

constexpr std::uint32_t max_vertices = 0x8000'0000u;  // the builder's own limit
constexpr double float_rounding = 6e-8;               // of a point of the unit cube: above sqrt(3) 2^-25
// Minimum limit over the rounding of a point: the middle of a shorter edge might coincide with its ends.
constexpr double min_limit = 16;

double rounding_on(Lattice lattice) { return lattice ? lattice.error() : float_rounding; }
double exact_limit(double longest, double rounding) { return longest * (1 - 1e-5) - 2 * rounding; }

constexpr std::array<std::size_t, 3> next_corner{1, 2, 0};

std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return std::uint64_t{low} << 32 | high;
}

Vec3f normalised_sum(Vec3f a, Vec3f b) {
  const Vec3f sum = a + b;
  const float size = length(sum);
  return size > 0 ? (1 / size) * sum : Vec3f{};
}

Rgba8 mean(Rgba8 a, Rgba8 b) {
  const auto half = [](int u, int v) { return static_cast<std::uint8_t>((u + v + 1) / 2); };
  return {half(a.r, b.r), half(a.g, b.g), half(a.b, b.b), half(a.a, b.a)};
}

// The three corners of a triangle: numbers of vertices, or their places.
template <class Corner>
using Corners = std::array<Corner, 3>;

// Splits a triangle by two edges. t[0] is the corner between them.
template <class Corner, class Mesh>
void split_two(const Corners<Corner>& t, Mesh& mesh, std::vector<Corners<Corner>>& parts) {
  const auto [a, b, c] = t;
  const Corner m = mesh.middle(a, b), n = mesh.middle(a, c);
  parts.push_back({a, m, n});
  if (mesh.distance2(b, n) <= mesh.distance2(c, m)) {
    parts.push_back({m, b, n});
    parts.push_back({b, c, n});
  } else {
    parts.push_back({m, b, c});
    parts.push_back({m, c, n});
  }
}

// The parts of a triangle by one round; false when no edge is too long. The mesh has is_long(a, b), middle(a, b) and
// distance2(a, b), squared, of two corners.
template <class Corner, class Mesh>
bool split_once(const Corners<Corner>& v, Mesh& mesh, std::vector<Corners<Corner>>& parts) {
  std::array<bool, 3> too_long;  // the edge from corner i to the next
  for (std::size_t i = 0; i < 3; ++i) too_long[i] = mesh.is_long(v[i], v[next_corner[i]]);
  const int count = too_long[0] + too_long[1] + too_long[2];
  if (count == 0) return false;
  if (count == 3) {
    const Corner ab = mesh.middle(v[0], v[1]), bc = mesh.middle(v[1], v[2]), ca = mesh.middle(v[2], v[0]);
    parts.insert(parts.end(), {{v[0], ab, ca}, {ab, v[1], bc}, {ca, bc, v[2]}, {ab, bc, ca}});
    return true;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = next_corner[i], k = next_corner[j];
    if (count == 2 && !too_long[j]) split_two({v[i], v[j], v[k]}, mesh, parts);
    if (count == 1 && too_long[i]) {
      const Corner m = mesh.middle(v[i], v[j]);
      parts.insert(parts.end(), {{v[i], m, v[k]}, {m, v[j], v[k]}});
    }
  }
  return true;
}

// Corners that are places, as exact as those of EdgeSplitter.
struct Places {
  double limit2;
  [[nodiscard]] static double distance2(Vec3d a, Vec3d b) { return dot(a - b, a - b); }
  [[nodiscard]] bool is_long(Vec3d a, Vec3d b) const { return distance2(a, b) > limit2; }
  [[nodiscard]] static Vec3d middle(Vec3d a, Vec3d b) { return 0.5 * (a + b); }
};

struct CanonicalHash {
  std::size_t operator()(const Triangle& t) const { return hash_of(t); }
};

// Removes the items that are not kept.
template <class T>
void keep_only(std::vector<T>& items, const std::vector<char>& kept_items) {
  if (items.empty()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < items.size(); ++i)
    if (kept_items[i]) items[kept++] = items[i];
  items.resize(kept);
}

}  // namespace

bool can_refine(double longest, Lattice lattice) {
  const double rounding = rounding_on(lattice);
  return exact_limit(longest, rounding) > min_limit * rounding;
}

double refine_limit(double longest, Lattice lattice) {
  if (!can_refine(longest, lattice))
    throw InputError("the lattice is too coarse to split edges so short; use a finer lattice or fewer levels");
  return exact_limit(longest, rounding_on(lattice));
}

std::uint64_t count_refined(const IndexedMesh& mesh, double longest, std::uint64_t most) {
  const double limit = refine_limit(longest, mesh.transform.lattice);
  Places places{limit * limit};
  std::uint64_t count = 0;
  std::vector<Corners<Vec3d>> waiting;
  for (std::size_t t = 0; t < mesh.triangles.size() && count <= most; ++t) {
    const auto at = [&](std::size_t k) { return to_double(mesh.positions[mesh.triangles[t].v[k]]); };
    waiting.assign(1, {at(0), at(1), at(2)});
    while (!waiting.empty() && count <= most) {
      const Corners<Vec3d> corners = waiting.back();
      waiting.pop_back();
      if (!split_once(corners, places, waiting)) ++count;
    }
  }
  return count;
}

EdgeSplitter::EdgeSplitter(IndexedMesh& mesh, double longest)
    : mesh_(mesh), first_fresh_(static_cast<std::uint32_t>(mesh.positions.size())) {
  const double limit = refine_limit(longest, mesh.transform.lattice);
  limit2_ = limit * limit;
  report_.triangles_before = mesh.triangles.size();
}

bool EdgeSplitter::is_long(std::uint32_t a, std::uint32_t b) const {
  return Places::distance2(place(a), place(b)) > limit2_;
}

std::vector<std::uint32_t> EdgeSplitter::long_triangles(std::size_t begin, std::size_t end) const {
  std::vector<std::uint32_t> found;
  for (std::size_t t = begin; t < end; ++t) {
    const auto& v = mesh_.triangles[t].v;
    if (is_long(v[0], v[1]) || is_long(v[1], v[2]) || is_long(v[2], v[0]))
      found.push_back(static_cast<std::uint32_t>(t));
  }
  return found;
}

std::uint32_t EdgeSplitter::middle(std::uint32_t a, std::uint32_t b) {
  const auto id = static_cast<std::uint32_t>(first_fresh_ + exact_.size());
  const auto [at, is_new] = middles_.try_emplace(key_of(a, b), id);
  if (is_new) {
    if (id >= max_vertices) throw ResourceError("splitting edges takes more than 2^31 vertices; ask for fewer levels");
    exact_.push_back(0.5 * (place(a) + place(b)));
    add_attributes(a, b);
  }
  return at->second;
}

// The corners of a triangle have one material.
void EdgeSplitter::add_attributes(std::uint32_t a, std::uint32_t b) {
  WedgeAttributes& w = mesh_.wedges;
  if (!w.uv.empty()) w.uv.push_back({0.5f * (w.uv[a].x + w.uv[b].x), 0.5f * (w.uv[a].y + w.uv[b].y)});
  if (!w.colour.empty()) w.colour.push_back(mean(w.colour[a], w.colour[b]));
  if (!w.normal.empty()) w.normal.push_back(normalised_sum(w.normal[a], w.normal[b]));
  if (!w.material.empty()) w.material.push_back(w.material[a]);
}

void EdgeSplitter::split(std::span<const std::uint32_t> triangles) {
  struct Numbers {
    EdgeSplitter& of;
    [[nodiscard]] double distance2(std::uint32_t a, std::uint32_t b) const {
      return Places::distance2(of.place(a), of.place(b));
    }
    [[nodiscard]] bool is_long(std::uint32_t a, std::uint32_t b) const { return of.is_long(a, b); }
    [[nodiscard]] std::uint32_t middle(std::uint32_t a, std::uint32_t b) const { return of.middle(a, b); }
  } numbers{*this};
  report_.split = triangles.size();
  std::vector<Corners<std::uint32_t>> waiting;
  for (const std::uint32_t whole : triangles) {
    waiting.assign(1, mesh_.triangles[whole].v);
    while (!waiting.empty()) {
      const Corners<std::uint32_t> corners = waiting.back();
      waiting.pop_back();
      if (!split_once(corners, numbers, waiting)) parts_.push_back({{corners}, whole});
    }
  }
  for (const Vec3d p : exact_) {
    const Lattice lattice = mesh_.transform.lattice;
    mesh_.positions.push_back(lattice ? lattice.nearest(p) : to_float(p));
    at_[hash_of(mesh_.positions.back())].push_back(static_cast<std::uint32_t>(mesh_.positions.size() - 1));
  }
}

std::vector<EdgeSplitter::Meeting> EdgeSplitter::meetings(std::size_t begin, std::size_t end) const {
  std::vector<Meeting> found;
  if (at_.empty()) return found;
  for (std::size_t v = begin; v < std::min<std::size_t>(end, first_fresh_); ++v) {
    const auto at = at_.find(hash_of(mesh_.positions[v]));
    if (at == at_.end()) continue;
    for (const std::uint32_t fresh : at->second)
      if (mesh_.positions[fresh] == mesh_.positions[v]) found.push_back({static_cast<std::uint32_t>(v), fresh});
  }
  return found;
}

// The vertex of a wedge, or the vertex itself.
std::uint32_t EdgeSplitter::vertex_of(std::uint32_t v) const {
  return mesh_.wedges.vertex.empty() ? v : mesh_.wedges.vertex[v];
}

// New vertices at the position of an earlier one become that one; new wedges only share its vertex.
void EdgeSplitter::join(std::span<const Meeting> meetings) {
  const bool has_wedges = !mesh_.wedges.vertex.empty();
  std::vector<std::uint32_t> same(mesh_.positions.size() - first_fresh_);
  for (std::uint32_t k = 0; k < same.size(); ++k) same[k] = first_fresh_ + k;
  for (const auto& [hash, fresh] : at_)
    for (std::size_t i = 1; i < fresh.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        if (mesh_.positions[fresh[i]] == mesh_.positions[fresh[k]]) {
          same[fresh[i] - first_fresh_] = fresh[k];
          break;
        }
  for (auto m = meetings.rbegin(); m != meetings.rend(); ++m) same[m->fresh - first_fresh_] = m->vertex;
  if (has_wedges) {
    std::vector<std::uint32_t>& vertex = mesh_.wedges.vertex;
    for (const std::uint32_t v : same) vertex.push_back(v < vertex.size() ? vertex[v] : v);
    return;
  }
  for (Part& part : parts_)
    for (std::uint32_t& v : part.triangle.v)
      if (v >= first_fresh_) v = same[v - first_fresh_];
}

void EdgeSplitter::drop_degenerate() {
  std::erase_if(parts_, [&](const Part& part) {
    const auto& v = part.triangle.v;
    return is_degenerate({{vertex_of(v[0]), vertex_of(v[1]), vertex_of(v[2])}});
  });
}

// Puts the first part of each triangle in its place, the others at the end; a triangle without a part is dropped.
void EdgeSplitter::put_back() {
  std::vector<char> stays(mesh_.triangles.size(), 1);
  for (const Part& part : parts_) stays[part.whole] = 2;
  std::vector<Triangle> others;
  for (const Part& part : parts_) {
    if (stays[part.whole] == 2) {
      mesh_.triangles[part.whole] = part.triangle;
      stays[part.whole] = 1;
    } else {
      others.push_back(part.triangle);
    }
  }
  mesh_.triangles.insert(mesh_.triangles.end(), others.begin(), others.end());
}

RefineReport EdgeSplitter::finish(std::span<const Meeting> meetings) {
  if (report_.split > 0) {
    join(meetings);
    // Triangles without area lose all of their parts: they are marked before the parts are put back.
    std::vector<std::uint32_t> wholes;
    for (const Part& part : parts_)
      if (wholes.empty() || wholes.back() != part.whole) wholes.push_back(part.whole);
    drop_degenerate();
    for (const std::uint32_t whole : wholes) mesh_.triangles[whole] = {};
    put_back();
    drop_repeats(!meetings.empty());
    compact();
  }
  report_.triangles_after = mesh_.triangles.size();
  return report_;
}

// Parts have at least one new vertex unless new vertices coincide with those of the mesh: only then a part may repeat a
// triangle of the mesh. The first of equal triangles is kept.
void EdgeSplitter::drop_repeats(bool whole_mesh) {
  std::unordered_set<Triangle, CanonicalHash> seen;
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    Triangle& triangle = mesh_.triangles[t];
    const auto& v = triangle.v;
    const bool is_part = v[0] >= first_fresh_ || v[1] >= first_fresh_ || v[2] >= first_fresh_;
    if ((!is_part && !whole_mesh) || is_degenerate(triangle)) continue;
    if (!seen.insert(canonical({{vertex_of(v[0]), vertex_of(v[1]), vertex_of(v[2])}})).second) triangle = {};
  }
}

// Removes dropped triangles and unused vertices.
void EdgeSplitter::compact() {
  std::erase_if(mesh_.triangles, [](const Triangle& t) { return is_degenerate(t); });
  if (mesh_.triangles.empty())
    throw InputError("no triangle is left after splitting edges, since none has an area; give a mesh with a surface");
  std::vector<char> used(mesh_.positions.size(), 0);
  for (const Triangle& t : mesh_.triangles)
    for (const std::uint32_t v : t.v) used[v] = 1;
  std::vector<std::uint32_t> number(used.size());
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < used.size(); ++v) number[v] = used[v] ? count++ : 0;
  if (count == used.size()) return;
  for (Triangle& t : mesh_.triangles)
    for (std::uint32_t& v : t.v) v = number[v];
  WedgeAttributes& w = mesh_.wedges;
  // The first remaining wedge of each vertex represents it.
  std::vector<std::uint32_t> first(used.size(), max_vertices);
  for (std::size_t v = 0; v < w.vertex.size(); ++v)
    if (used[v] && first[w.vertex[v]] == max_vertices) first[w.vertex[v]] = number[v];
  for (std::uint32_t& v : w.vertex) v = first[v];
  keep_only(mesh_.positions, used);
  keep_only(w.vertex, used);
  keep_only(w.uv, used);
  keep_only(w.colour, used);
  keep_only(w.normal, used);
  keep_only(w.material, used);
}

RefineReport refine_mesh(IndexedMesh& mesh, double longest) {
  EdgeSplitter splitter(mesh, longest);
  const std::size_t vertices = mesh.positions.size();
  splitter.split(splitter.long_triangles(0, mesh.triangles.size()));
  return splitter.finish(splitter.meetings(0, vertices));
}

}  // namespace lodestone
