// The columns in which two pictures differ, row by row. A metric that looks at the surroundings of a pixel has the
// value of equal pictures wherever they agree; most of a picture of a model does so, its background at least.
#pragma once

#include <cstddef>
#include <vector>

#include "render/frame/image.h"

namespace lodestone {

// [begin, end) of a row; empty where begin == end.
struct Columns {
  std::size_t begin = 0, end = 0;
  [[nodiscard]] std::size_t size() const { return end - begin; }
};

class DifferingColumns {
 public:
  // Colours count, alpha does not. Both pictures have the same size.
  DifferingColumns(const Image& a, const Image& b);

  // The columns of row y: pixels outside see no difference within `across` columns and `down` rows.
  [[nodiscard]] Columns near(std::size_t y, std::size_t down, std::size_t across) const;

 private:
  std::size_t width_;
  std::vector<Columns> rows_;
};

}  // namespace lodestone
