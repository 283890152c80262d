// The cells of a level are the images of the finer ones under P.
#include <algorithm>
#include <string>

#include "core/hierarchy/verify/verify_wedges.h"

namespace lodestone::verify {
namespace {

// The same triangle, rotated so that its smallest vertex comes first; its orientation is kept.
Triangle rotated(Triangle t) {
  std::rotate(t.v.begin(), std::min_element(t.v.begin(), t.v.end()), t.v.end());
  return t;
}

bool before(const Triangle& a, const Triangle& b) { return a.v < b.v; }

std::string name_of(const Triangle& t) {
  return std::to_string(t.v[0]) + " " + std::to_string(t.v[1]) + " " + std::to_string(t.v[2]);
}

}  // namespace

// Ids local to a cell name its vertices one to one (check_copies), so sets and multisets are compared on local ids.
void check_images(const Part& part, int coarse_level, const LevelWedges* wedges, Finding& vertices,
                  Finding& triangles) {
  std::vector<char> reached;
  std::vector<Triangle> images, stored;
  part.for_parents(coarse_level, [&](CellId c) {
    const Cell& cell = part.hierarchy.cells[c];
    const auto vertex = [&](std::uint32_t v) { return wedges ? wedges->vertex(c, v) : v; };
    reached.assign(cell.positions.size(), 0);
    images.clear();
    for (CellId k = cell.first_child; k < cell.end_child(); ++k) {
      const Cell& child = part.hierarchy.cells[k];
      for (const std::uint32_t parent : child.parents) reached[parent] = 1;
      for (const Triangle& t : child.triangles) {
        const Triangle image{{child.parents[t.v[0]], child.parents[t.v[1]], child.parents[t.v[2]]}};
        if (!is_degenerate({{vertex(image.v[0]), vertex(image.v[1]), vertex(image.v[2])}}))
          images.push_back(rotated(image));
      }
    }
    const auto missed = std::find(reached.begin(), reached.end(), 0);
    vertices.require(missed == reached.end(), [&] {
      return place(coarse_level, c, VertexId(missed - reached.begin())) + ": not the parent of any vertex";
    });

    stored.resize(cell.triangles.size());
    std::transform(cell.triangles.begin(), cell.triangles.end(), stored.begin(), rotated);
    std::sort(images.begin(), images.end(), before);
    std::sort(stored.begin(), stored.end(), before);
    triangles.require(images == stored, [&] {
      const auto length = std::min(images.size(), stored.size());
      const auto at = static_cast<std::size_t>(
          std::mismatch(images.begin(), images.begin() + static_cast<std::ptrdiff_t>(length), stored.begin()).first -
          images.begin());
      const bool extra = at == images.size() || (at < stored.size() && before(stored[at], images[at]));
      return place(coarse_level, c) + ", triangle " + name_of(extra ? stored[at] : images[at]) +
             (extra ? ": not the image of a triangle below" : ": image of a triangle below, but missing");
    });
  });
}

}  // namespace lodestone::verify
