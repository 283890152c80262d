// A point in four floats, so that one load takes it.
#pragma once

namespace lodestone {

struct alignas(16) AlignedPoint {
  float x, y, z, unused;
};

}  // namespace lodestone
