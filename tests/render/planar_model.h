// Surfaces whose attributes are functions of the position, at every level: drawn in any way, morphing or not, each
// point must show the value of the function.
#pragma once

#include <deque>
#include <memory>

#include "core/texture/texel_wrap.h"
#include "render/textures/mip_chain.h"
#include "tests/naive_hierarchy.h"
#include "tests/render/textured_models.h"
#include "tests/test_meshes.h"

namespace lodestone::test {

struct Plan {
  Vec2f u{2, 0}, v{0, 2};  // texture coordinates: (u . p, v . p), p the position's x and y
  [[nodiscard]] Vec2f at(Vec2f p) const { return {u.x * p.x + u.y * p.y, v.x * p.x + v.y * p.y}; }
};

// Colours are positions.
inline std::shared_ptr<const Hierarchy> planar_model(double height, const Plan& plan, std::vector<Texture> textures,
                                                     std::vector<Material> materials) {
  struct Storage {
    NaiveHierarchy small;
    std::deque<std::vector<Vec2f>> uv;
    std::deque<std::vector<Rgba8>> colours;
  };
  const auto storage = std::make_shared<Storage>();
  storage->small = naive_hierarchy(terrain_mesh(48, height), 3);
  const auto h = std::make_shared<Hierarchy>(storage->small.hierarchy);
  for (Cell& cell : h->cells) {
    std::vector<Vec2f>& uv = storage->uv.emplace_back();
    std::vector<Rgba8>& colours = storage->colours.emplace_back();
    for (const Vec3f p : cell.positions) {
      uv.push_back(plan.at({p.x, p.y}));
      const auto byte = [](float v) { return static_cast<std::uint8_t>(std::lround(255 * v)); };
      colours.push_back({byte(p.x), byte(p.y), byte(p.z), 255});
    }
    cell.attributes.uv = uv;
    cell.attributes.colours = colours;
  }
  h->attributes.uv = h->attributes.colours = true;
  h->textures = std::move(textures);
  h->materials = std::move(materials);
  h->storage = storage;
  return h;
}

// The slow twin of sampling: in double, from levels whose borders it does not look at.
struct ObviousTexture {
  std::vector<MipLevel> levels;
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;

  [[nodiscard]] Vec3d texel(std::size_t level, std::int64_t x, std::int64_t y) const {
    const MipLevel& l = levels[level];
    const std::size_t row = wrapped(y, l.size.height, wrap_v) + 1, column = wrapped(x, l.size.width, wrap_u) + 1;
    const std::uint32_t t = l.texels[row * l.stride() + column];
    return {static_cast<double>(t & 255), static_cast<double>(t >> 8 & 255), static_cast<double>(t >> 16 & 255)};
  }
  [[nodiscard]] Vec3d bilinear(std::size_t level, double u, double v) const {
    const double x = u * levels[level].size.width - 0.5, y = v * levels[level].size.height - 0.5;
    const auto i = static_cast<std::int64_t>(std::floor(x)), j = static_cast<std::int64_t>(std::floor(y));
    const double a = x - std::floor(x), b = y - std::floor(y);
    return (1 - b) * ((1 - a) * texel(level, i, j) + a * texel(level, i + 1, j)) +
           b * ((1 - a) * texel(level, i, j + 1) + a * texel(level, i + 1, j + 1));
  }
  // With the true logarithm.
  [[nodiscard]] Vec3d sample(double u, double v, double footprint) const {
    const double lod = std::fmin(std::fmax(std::log2(footprint), 0), static_cast<double>(levels.size() - 1));
    const auto finer = static_cast<std::size_t>(lod);
    if (finer + 1 == levels.size()) return bilinear(finer, u, v);
    const double share = lod - std::floor(lod);
    return (1 - share) * bilinear(finer, u, v) + share * bilinear(finer + 1, u, v);
  }
};

// The points where the lines of sight of a frame's only model meet the plane z = 0.
class PlaneView {
 public:
  explicit PlaneView(const Frame& frame) : frame_(frame) {}

  // Through a point of the window, in pixels from the upper left corner. False where it misses.
  [[nodiscard]] bool meet(double x, double y, Vec3d& p) const {
    const auto& m = frame_.only().view_projection.m;
    const double at_x = 2 * x / frame_.size.width - 1, at_y = 1 - 2 * y / frame_.size.height;
    const auto row = [&](std::size_t r, double at, std::size_t c) { return m[4 * r + c] - at * double{m[12 + c]}; };
    const double a = row(0, at_x, 0), b = row(0, at_x, 1), c = row(1, at_y, 0), d = row(1, at_y, 1),
                 e = -row(0, at_x, 3), f = -row(1, at_y, 3), det = a * d - b * c;
    p = {(e * d - b * f) / det, (a * f - e * c) / det, 0};
    return p.x > 0.01 && p.x < 0.99 && p.y > 0.01 && p.y < 0.99;
  }

 private:
  const Frame& frame_;
};

}  // namespace lodestone::test
