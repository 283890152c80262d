#include "core/hierarchy/construct/moved_attributes.h"

#include <cstdint>
#include <vector>

namespace lodestone {
namespace {

// The mean of a value of the three corners.
template <class Value>
auto mean_at(const MovedAttributes& a, const BlockWedges::Moved& m, const Value& value) {
  const auto& corner = a.triangles[m.triangle].v;
  return m.weight[0] * value(corner[0]) + m.weight[1] * value(corner[1]) + m.weight[2] * value(corner[2]);
}

Vec2f uv_at(const MovedAttributes& a, const BlockWedges::Moved& m) {
  return {mean_at(a, m, [&](std::uint32_t w) { return a.uv[w].x; }),
          mean_at(a, m, [&](std::uint32_t w) { return a.uv[w].y; })};
}

Rgba8 colour_at(const MovedAttributes& a, const BlockWedges::Moved& m) {
  const auto channel = [&](std::uint8_t Rgba8::*c) {
    return static_cast<std::uint8_t>(
        mean_at(a, m, [&](std::uint32_t w) { return static_cast<float>(a.colours[w].*c); }) + 0.5f);
  };
  return {channel(&Rgba8::r), channel(&Rgba8::g), channel(&Rgba8::b), channel(&Rgba8::a)};
}

// All values are taken before the first is changed.
template <class T, class At>
void replace(const MovedAttributes& a, std::span<T> values, const At& at) {
  if (values.empty()) return;
  std::vector<T> moved;
  moved.reserve(a.moved.size());
  for (const BlockWedges::Moved& m : a.moved) moved.push_back(at(a, m));
  for (std::size_t i = 0; i < moved.size(); ++i) values[a.moved[i].wedge] = moved[i];
}

}  // namespace

void interpolate_attributes(const MovedAttributes& attributes) {
  replace(attributes, attributes.uv, uv_at);
  replace(attributes, attributes.colours, colour_at);
}

}  // namespace lodestone
