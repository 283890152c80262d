#include "parallel/spherical/plain_parts.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

namespace lodestone {
namespace {

using namespace spherical;

constexpr std::size_t most_triangles = 8;  // of the input, in a plain part
constexpr std::int64_t least_parts = 16;   // fewer are mapped like all others

// Those of one source are together, so that changes from one to the next are at least as many as sources.
bool is_plain(const Surface& surface) {
  std::size_t sources = 0;
  for (std::uint32_t last = no_source; const std::uint32_t source : surface.source_triangle) {
    if (source == no_source || source == last) continue;
    last = source;
    if (++sources > most_triangles) return false;
  }
  return true;
}

void add(const Surface& part, Surface& to) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  to.positions.insert(to.positions.end(), part.positions.begin(), part.positions.end());
  to.source_vertex.insert(to.source_vertex.end(), part.source_vertex.begin(), part.source_vertex.end());
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    if (part.source_triangle[t] == no_source) continue;
    const auto [a, b, c] = part.triangles[t].v;
    to.triangles.push_back({{first + a, first + b, first + c}});
    to.source_triangle.push_back(part.source_triangle[t]);
  }
}

}  // namespace

Surface take_plain_parts(const IndexedMesh& mesh, const SphericalMaps& maps, std::vector<Surface>& surfaces) {
  const WedgeAttributes& wedges = mesh.wedges;
  Surface plain;
  if (maps.geometry || !wedges.textures.empty() || !wedges.colour.empty() || wedges.materials.size() > 1) return plain;
  if (std::ranges::count_if(surfaces, is_plain) < least_parts) return plain;
  for (const Surface& surface : surfaces)
    if (is_plain(surface)) add(surface, plain);
  std::erase_if(surfaces, is_plain);
  return plain;
}

Unfolding plain_unfolding(const Surface& surface) {
  Unfolding out;
  out.directions.resize(surface.positions.size());
  out.triangles = out.corners = surface.triangles;
  out.source.resize(surface.triangles.size());
  std::iota(out.source.begin(), out.source.end(), 0u);
  out.vertex.resize(surface.positions.size());
  std::iota(out.vertex.begin(), out.vertex.end(), 0u);
  out.place.assign(surface.positions.size(), {0.5, 0.5});
  return out;
}

}  // namespace lodestone
