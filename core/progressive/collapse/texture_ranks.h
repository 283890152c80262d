// The cheapest collapse of a vertex by the deviation on the texture, with as few exact deviations as that takes.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/progressive/collapse/collapse_metric.h"
#include "core/progressive/collapse/ring_tests.h"
#include "core/progressive/collapse/texture_fan.h"

namespace lodestone::progressive {
inline namespace LODESTONE_LANES {

// Most of the work is to look for crossings, so that they are looked for last: the deviation of the vertex itself is a
// lower bound, and only neighbours that nothing else rules out go further.
class TextureRanks {
 public:
  TextureRanks(const RingMesh& rings, const TexturePoint* points) : rings_(&rings), points_(points) {}

  // As CollapseMetric::cheapest; `allowed` need not ask about the texture.
  template <class Allowed>
  [[nodiscard]] CollapseMetric::Cheapest cheapest(Id v, std::uint64_t places, const Allowed& allowed) {
    places = rank_by_bounds(v, places);
    for (std::uint64_t exact = 0; places != 0;) {
      const std::uint32_t k = lowest_place({ranks_, CollapseMetric::max_neighbours}, places);
      const std::uint64_t bit = std::uint64_t{1} << k;
      if ((exact & bit) != 0) return {k, ranks_[k]};
      if (turns(k) || !allowed(k)) {
        places &= ~bit;
      } else {
        exact |= bit;
        ranks_[k] = rank_of(v, k, largest(k, [](const TextureFan& fan, std::uint32_t spoke) {
                              return std::max(fan.own[spoke], crossing_deviation(fan, spoke));
                            }));
      }
    }
    return {};
  }

 private:
  // A neighbour as the end of a spoke in the fans on both sides of the edge to it.
  struct Place {
    std::uint8_t fan[2], spoke[2];
  };

  // Returns the places that the wedges of v can follow to.
  std::uint64_t rank_by_bounds(Id v, std::uint64_t places) {
    const Ring& ring = rings_->ring(v);
    if (fill_whole_fan(fans_[0], points_, *rings_, v)) {
      for (std::uint32_t at = 0; at < ring.size; at += 8) {
        const Float8 own = load<Float8>(fans_[0].own + at), length = load<Float8>(fans_[0].length + at);
        store(ranks_ + at, all8(points_[v].deviation) + own + all8(stiffness) * length);
        for (auto k = static_cast<std::uint8_t>(at); k < at + 8; ++k) places_[k] = {{0, 0}, {k, k}};
      }
      return places;
    }
    last_ = 0, fans_[0].wedge = fans_[1].wedge = no_id;
    if (ring.open == 0) places = along_seams(ring, places);
    for (std::uint64_t left = places; left != 0; left &= left - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
      if (find_place(v, ring.ids[k], places_[k]))
        ranks_[k] =
            rank_of(v, k, largest(k, [](const TextureFan& fan, std::uint32_t spoke) { return fan.own[spoke]; }));
      else
        places &= ~(std::uint64_t{1} << k);
    }
    return places;
  }

  // A vertex that is on a seam moves along it; the ends of seams are left to others.
  [[nodiscard]] static std::uint64_t along_seams(const Ring& ring, std::uint64_t places) {
    std::uint64_t seams = 0;
    for (std::uint32_t k = 0; k < ring.size; ++k)
      seams |= std::uint64_t{ring.wedge(k) != ring.wedge(ring.previous(k))} << k;
    return seams != 0 ? places & seams : places;
  }

  bool find_place(Id v, Id target, Place& place) {
    Collapse c{.vertex = v, .target = target};
    if (!rings_->follows_wedges(c)) return false;
    for (const int side : {0, 1}) {
      std::uint32_t fan = 0;
      while (fan < 2 && fans_[fan].wedge != c.wedge[side]) ++fan;
      if (fan == 2) {
        fan = last_++ % 2;
        if (!fill_fan(fans_[fan], points_, *rings_, v, c.wedge[side])) return false;
      }
      const std::uint32_t spoke = fans_[fan].find(c.wedge_target[side]);
      if (spoke == fans_[fan].spokes) return false;
      place.fan[side] = static_cast<std::uint8_t>(fan), place.spoke[side] = static_cast<std::uint8_t>(spoke);
    }
    return true;
  }

  template <class Deviation>
  [[gnu::always_inline]] float largest(std::uint32_t k, const Deviation& deviation) const {
    const Place& place = places_[k];
    const float one = deviation(fans_[place.fan[0]], place.spoke[0]);
    return place.fan[1] == place.fan[0] ? one : std::max(one, deviation(fans_[place.fan[1]], place.spoke[1]));
  }
  [[nodiscard]] bool turns(std::uint32_t k) const {
    const Place& place = places_[k];
    return turns_texture(fans_[place.fan[0]], points_, place.spoke[0]) ||
           (place.fan[1] != place.fan[0] && turns_texture(fans_[place.fan[1]], points_, place.spoke[1]));
  }
  // The deviation so far and that of the step; a millionth of its length prefers short ones where nothing deviates.
  [[nodiscard]] float rank_of(Id v, std::uint32_t k, float deviation) const {
    const Place& place = places_[k];
    return points_[v].deviation + deviation + stiffness * fans_[place.fan[0]].length[place.spoke[0]];
  }

  const RingMesh* rings_;
  const TexturePoint* points_;
  TextureFan fans_[2];
  std::uint32_t last_ = 0;
  Place places_[CollapseMetric::max_neighbours];
  alignas(32) float ranks_[CollapseMetric::max_neighbours];
};

}  // namespace LODESTONE_LANES
}  // namespace lodestone::progressive
