#include "core/hierarchy/model/hierarchy.h"

#include <algorithm>

namespace lodestone {

int Hierarchy::level_of(CellId cell) const {
  const auto after =
      std::upper_bound(levels.begin(), levels.end(), cell, [](CellId c, const Level& l) { return c < l.first_cell; });
  return static_cast<int>(after - levels.begin()) - 1;
}

}  // namespace lodestone
