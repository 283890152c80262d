#include "core/progressive/mesh/split_mesh.h"

#include <algorithm>

namespace lodestone::progressive {

bool SplitMesh::fits(const Split& s) const {
  if (s.parent >= stars.size()) return false;
  const Star& u = stars[s.parent];
  const std::size_t size = u.spokes.size();
  if (s.side == Side::inside)
    return size >= 2 && s.at < size && (u.open ? s.at + s.between + 1 < size : s.between + 2 <= size);
  return u.open && s.between + 1 <= size && (s.side == Side::front ? s.at == s.between : s.at + s.between + 1 == size);
}

// From the parent on: (parent, a, ... , b) inside, (parent, a, ...) at the back, (..., b, parent) at the front.
SplitMesh::Star SplitMesh::star_of(const Split& s) const {
  const Star& u = stars[s.parent];
  Star v{.spokes = {}, .open = s.side != Side::inside, .first_wedge = wedge_count};
  if (s.side == Side::front) {
    for (std::uint32_t k = 0; k <= s.between; ++k) v.spokes.push_back({u.spokes[k].vertex});
    v.spokes.push_back({s.parent});
    return v;
  }
  v.spokes.push_back({s.parent});
  std::size_t k = s.at;
  for (std::uint32_t n = 0; n < s.between + (s.side == Side::inside ? 2 : 1); ++n, k = u.next(k))
    v.spokes.push_back({u.spokes[k].vertex});
  return v;
}

void SplitMesh::apply(const Split& s, Star&& v) {
  const auto id = static_cast<std::uint32_t>(stars.size());
  const auto parent_wedge = [&](std::size_t sector) { return s.parents[v.spokes[sector].wedge - v.first_wedge]; };
  Star& u = stars[s.parent];
  const bool with_a = s.side != Side::front, with_b = s.side != Side::back;
  // Neighbours between a and b see the new vertex instead of its parent.
  const std::size_t first = with_a ? 2 : 0, last = first + s.between;
  for (std::size_t k = first; k < last; ++k) {
    Star& x = stars[v.spokes[k].vertex];
    x.spokes[x.find(s.parent)].vertex = id;
  }
  if (with_a) {  // (p, u, q) -> (p, v, u, q)
    Star& a = stars[v.spokes[1].vertex];
    const std::size_t at = a.find(s.parent);
    a.spokes.insert(a.spokes.begin() + static_cast<std::ptrdiff_t>(at), {id, s.wedge_a});
  }
  if (with_b) {  // (u, q) -> (u, v, q)
    Star& b = stars[v.spokes[s.side == Side::front ? s.between : v.spokes.size() - 1].vertex];
    const std::size_t at = b.find(s.parent);
    b.spokes.insert(b.spokes.begin() + static_cast<std::ptrdiff_t>(at) + 1, {id, b.spokes[at].wedge});
    b.spokes[at].wedge = s.wedge_b;
  }
  // The parent: a, v, b, with the triangles (u, a, v) and (u, v, b).
  std::vector<Spoke> ring;
  if (s.side == Side::front) {
    ring.push_back({id, parent_wedge(v.sectors() - 1)});
    ring.insert(ring.end(), u.spokes.begin() + s.at, u.spokes.end());
  } else if (s.side == Side::back) {
    ring.assign(u.spokes.begin(), u.spokes.begin() + s.at + 1);
    ring.back().wedge = parent_wedge(0);
    ring.push_back({id, ring.back().wedge});
  } else {
    const bool wraps = s.at + s.between + 1 >= u.spokes.size();
    const std::size_t b = (s.at + s.between + 1) % u.spokes.size();
    ring.assign(u.spokes.begin() + static_cast<std::ptrdiff_t>(wraps ? b : 0), u.spokes.begin() + s.at + 1);
    ring.back().wedge = parent_wedge(0);
    ring.push_back({id, parent_wedge(v.sectors() - 1)});
    if (!wraps) ring.insert(ring.end(), u.spokes.begin() + static_cast<std::ptrdiff_t>(b), u.spokes.end());
  }
  u.spokes = std::move(ring);
  v.wedges = static_cast<std::uint32_t>(s.parents.size());
  wedge_count += v.wedges;
  parents.insert(parents.end(), s.parents.begin(), s.parents.end());
  stars.push_back(std::move(v));
}

std::vector<Triangle> SplitMesh::triangles() const {
  std::vector<Triangle> out;
  // Two vertices may share several edges: the sector has both neighbours.
  const auto wedge_at = [&](std::uint32_t vertex, std::uint32_t spoke, std::uint32_t behind) {
    const Star& star = stars[vertex];
    for (std::size_t k = 0; k < star.sectors(); ++k)
      if (star.spokes[k].vertex == spoke && star.spokes[star.next(k)].vertex == behind) return star.spokes[k].wedge;
    throw InputError("inconsistent vertex splits");
  };
  for (std::uint32_t v = 0; v < stars.size(); ++v)
    for (std::size_t k = 0; k < stars[v].sectors(); ++k) {
      const Spoke& spoke = stars[v].spokes[k];
      const std::uint32_t a = spoke.vertex, b = stars[v].spokes[stars[v].next(k)].vertex;
      if (v < a && v < b) out.push_back({spoke.wedge, wedge_at(a, b, v), wedge_at(b, v, a)});
    }
  return out;
}

}  // namespace lodestone::progressive
