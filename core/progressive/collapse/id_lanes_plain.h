// Eight ids in plain C++: the twin of id_lanes_avx2.h.
#pragma once

#include "core/progressive/collapse/ring.h"
#include "core/simplify/quadric/lanes_plain.h"

namespace lodestone::progressive::plain {

struct Id8 {
  Id lane[8];

  static Id8 load(const Id* ids) {
    Id8 r;
    for (int k = 0; k < 8; ++k) r.lane[k] = ids[k];
    return r;
  }
  void store(Id* ids) const {
    for (int k = 0; k < 8; ++k) ids[k] = lane[k];
  }
  // The first n lanes, and another id behind them.
  [[nodiscard]] Id8 first(int n, Id other) const {
    Id8 r;
    for (int k = 0; k < 8; ++k) r.lane[k] = k < n ? lane[k] : other;
    return r;
  }
  // How often each lane is among the others.
  [[nodiscard]] Matches among(const Id* others, std::uint32_t count) const {
    Id times[8]{};
    for (std::uint32_t i = 0; i < count; ++i)
      for (int k = 0; k < 8; ++k) times[k] += lane[k] == others[i] ? 1 : 0;
    Matches r;
    for (int k = 0; k < 8; ++k) {
      r.once |= static_cast<unsigned>(times[k] > 0) << k;
      r.again |= static_cast<unsigned>(times[k] > 1) << k;
    }
    return r;
  }
  // Bit k: lane k is the id.
  [[nodiscard]] unsigned equal(Id id) const {
    unsigned bits = 0;
    for (int k = 0; k < 8; ++k) bits |= static_cast<unsigned>(lane[k] == id) << k;
    return bits;
  }
};

struct Lanes {
  using Float = quadric::plain::Float8;
  using Points = quadric::plain::Point8;
  using Ids = Id8;
};

}  // namespace lodestone::progressive::plain
