// The slow, obvious twin of passes: rays through the centres of pixels, and the drawn triangles that they hit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/hierarchy/model/material_of.h"
#include "tests/render/effect_scenes.h"

namespace lodestone::test {

// The drawn triangles of a scene in the world.
struct WorldTriangle {
  std::array<Vec3d, 3> v;
  std::size_t model = 0;
  const Material* material = nullptr;  // or null
};
inline std::vector<WorldTriangle> drawn_triangles(const EffectScene& scene) {
  const EffectFrame made(scene);
  std::vector<WorldTriangle> all;
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    const ModelFrame& model = made.frame.models[m];
    for (const SelectedCell& selected : model.selection->cells) {
      const Cell& cell = model.morph.hierarchy->cells[selected.cell];
      std::vector<Vec3f> places(cell.positions.size());
      morph_cell(model.morph, selected.cell, places);
      const auto world = [&](std::uint32_t v) {
        return scene.models[m].offset + scene.models[m].scale * to_double(places[v]);
      };
      const auto& materials = model.morph.hierarchy->materials;
      for (const Triangle& t : cell.triangles) {
        const std::uint32_t number = material_of(*model.morph.hierarchy, cell, t.v[0]);
        all.push_back({{world(t.v[0]), world(t.v[1]), world(t.v[2])},
                       m,
                       number < materials.size() ? &materials[number] : nullptr});
      }
    }
  }
  return all;
}

// Distance along the ray, in units of its direction; empty where it misses.
inline std::optional<double> hit(const WorldTriangle& t, Vec3d from, Vec3d along) {
  const Vec3d ab = t.v[1] - t.v[0], ac = t.v[2] - t.v[0], p = cross(along, ac), s = from - t.v[0];
  const double det = dot(ab, p);
  if (det == 0) return {};
  const Vec3d q = cross(s, ab);
  const double b = dot(s, p) / det, c = dot(along, q) / det;
  if (b < 0 || c < 0 || b + c > 1) return {};
  return dot(ac, q) / det;
}

// Through the centre of a pixel, from the eye; one unit along is one unit of depth along the view.
inline Vec3d ray(const EffectScene& scene, int x, int y) {
  const Vec3d forward = detail::unit(scene.target - scene.eye), right = detail::unit(cross(forward, Vec3d{0, 0, 1})),
              up = cross(right, forward);
  const double tan_half = std::tan(0.785398163397448 / 2), width = scene.size.width, height = scene.size.height;
  return forward + (((x + 0.5) * 2 / width - 1) * tan_half * width / height) * right +
         ((1 - (y + 0.5) * 2 / height) * tan_half) * up;
}

// The pixels, in order, whose rays hit anything, from the front.
using Hits = std::vector<std::pair<double, const WorldTriangle*>>;
inline Hits hits_of(const EffectScene& scene, const std::vector<WorldTriangle>& triangles, int x, int y) {
  Hits hits;
  for (const WorldTriangle& t : triangles)
    if (const auto at = hit(t, scene.eye, ray(scene, x, y)); at && *at > scene.near) hits.emplace_back(*at, &t);
  std::ranges::sort(hits);
  return hits;
}

}  // namespace lodestone::test
