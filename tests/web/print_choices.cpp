// Prints views of random hierarchies, with the families that belong in memory and the limits of a camera at rest, as
// JSON: the page has to come to the same (test_choice.mjs).
// usage: print_choices SEED COUNT
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "render/lod/residency.h"
#include "tests/render/lod/random_tables.h"

namespace {

using namespace lodestone;
using nlohmann::json;

constexpr std::uint64_t root_bytes = 100;

json json_of(const Box3f& b) { return {b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z}; }

// Families arrive at once, for more frames than it takes until no frame differs from the one before.
json limits_at_rest(const testing::Case& c) {
  Residency residency(c.tables.hierarchy, c.tables.bytes, root_bytes, root_bytes + c.room, 0.3f);
  const std::size_t frames = 100 + 20 * c.tables.hierarchy.cells.size();
  for (std::size_t frame = 0; frame < frames; ++frame) {
    (void)residency.make_room();
    for (const CellId parent : std::vector(residency.wanted().begin(), residency.wanted().end()))
      if (c.tables.bytes[parent] <= residency.room()) (void)residency.take_in(parent);
    residency.update(c.tables.radii, c.viewpoint);
  }
  json limits = json::array();
  for (const DetailLimit& limit : residency.limits())
    limits.push_back({{"box", json_of(limit.box)}, {"radius", limit.radius}});
  return limits;
}

// Each is a part of its level's, and no larger than that of the parent.
void give_radii_by_cell(testing::Tables& tables, std::mt19937& random) {
  Radii& radii = tables.radii;
  for (const float begin : radii.band_begin) radii.band_end.push_back(begin + 0.01f);
  for (CellId id{0}; id < tables.hierarchy.cells.size(); ++id) {
    const CellId parent = tables.hierarchy.cells[id].parent;
    const float own = testing::uniform(random, 0.5f, 1) * tables.radius_of(id);
    radii.by_cell.push_back(parent == no_cell ? own : std::min(own, radii.by_cell[parent]));
  }
}

json json_of(const testing::Case& c) {
  const Radii& radii = c.tables.radii;
  json cells;
  for (CellId id{0}; id < c.tables.hierarchy.cells.size(); ++id) {
    const Cell& cell = c.tables.hierarchy.cells[id];
    cells.push_back({{"level", c.tables.hierarchy.level_of(id)},
                     {"bounds", json_of(cell.bounds)},
                     {"parent", cell.parent == no_cell ? json() : json(std::uint32_t{cell.parent})},
                     {"familyBytes", c.tables.bytes[id]}});
  }
  json radii_json{{"select", radii.select}, {"begin", radii.band_begin}, {"end", radii.band_end}};
  if (!radii.by_cell.empty()) radii_json["byCell"] = radii.by_cell;
  json chosen = json::array();
  for (const CellId id : c.choose()) chosen.push_back(std::uint32_t{id});
  return {{"viewpoint", {c.viewpoint.x, c.viewpoint.y, c.viewpoint.z}},
          {"radii", radii_json},
          {"cells", cells},
          {"rootBytes", root_bytes},
          {"budget", root_bytes + c.room},
          {"chosen", chosen},
          {"limits", limits_at_rest(c)}};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  std::mt19937 random(static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10)));
  json cases = json::array();
  for (unsigned long k = std::strtoul(argv[2], nullptr, 10); k > 0; --k) {
    testing::Case next(random, DistanceMetric::chebyshev);  // the page's metric
    if (k % 2 == 0) give_radii_by_cell(next.tables, random);
    cases.push_back(json_of(next));
  }
  std::cout << cases;
  return 0;
}
