#include "core/progressive/collapse/uv_star.h"

namespace lodestone::progressive {

bool turns_texture(const RingMesh& rings, std::span<const Vec2f> uv, const Collapse& c) {
  const Ring& ring = rings.ring(c.vertex);
  const auto at = [&](Id wedge) { return uv[rings.source_of(wedge)]; };
  for (std::uint32_t k = 0; k < ring.sectors(); ++k) {
    const Id a = ring.ids[k], b = ring.ids[ring.next(k)];
    if (a == c.target || b == c.target) continue;
    const Id wedge = rings.has_wedges() ? ring.wedge(k) : c.vertex;
    const Vec2f to = at(c.wedge_target[wedge == c.wedge[0] ? 0 : 1]);
    const Vec2f uv_a = at(rings.wedge_of(a, b)), uv_b = at(rings.wedge_of(b, c.vertex));
    const double before = uv_area(at(wedge), uv_a, uv_b), after = uv_area(to, uv_a, uv_b);
    if ((before > 0 && !(after > 0)) || (before < 0 && !(after < 0))) return true;
  }
  return false;
}

}  // namespace lodestone::progressive
