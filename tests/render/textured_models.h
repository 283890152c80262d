// Models with colours, textures and normal maps, and frames of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/texture/image_codec.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/scheduler.h"
#include "render/camera/camera.h"
#include "render/effects/plan.h"
#include "render/frame/appearance.h"
#include "render/frame/renderer.h"
#include "render/lod/radii.h"

namespace lodestone::test {

// colour(u, v) of [0, 1], at the centres of pixels.
inline PixelImage painted(PixelSize size, const std::function<Vec3f(float, float)>& colour) {
  PixelImage image{.size = size, .channels = 3, .pixels = {}};
  for (std::uint32_t y = 0; y < size.height; ++y)
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const Vec3f c = colour((static_cast<float>(x) + 0.5f) / static_cast<float>(size.width),
                             (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height));
      for (const float channel : {c.x, c.y, c.z})
        image.pixels.push_back(static_cast<std::uint8_t>(std::lround(255 * std::fmin(std::fmax(channel, 0.0f), 1.0f))));
    }
  return image;
}

inline Texture as_texture(const std::string& name, const PixelImage& image, TextureWrap u = TextureWrap::repeat,
                          TextureWrap v = TextureWrap::repeat) {
  return {name, "image/png", u, v, encode_image(image, "image/png")};
}

// Waves, and fields with hard edges.
inline Vec3f motley(float u, float v) {
  const bool field = (static_cast<int>(8 * u) + static_cast<int>(8 * v)) % 2 == 0;
  return {0.5f + 0.4f * std::sin(17 * u), field ? 0.8f : 0.3f, 0.5f + 0.4f * std::cos(11 * v + 3 * u)};
}
inline Vec3f stripes(float u, float v) {
  return std::sin(200 * u + 60 * v) > 0 ? Vec3f{1, 0.9f, 0.2f} : Vec3f{0, 0.2f, 0.5f};
}
inline Vec3f as_colour(Vec3f n) { return 0.5f * (1 / length(n) * n) + Vec3f{0.5f, 0.5f, 0.5f}; }
inline Vec3f bumps(float u, float v) { return as_colour({0.6f * std::sin(40 * u), 0.6f * std::sin(30 * v), 1}); }
inline Vec3f every_direction(float u, float v) {
  return as_colour({std::cos(6.2832f * u), std::sin(6.2832f * u), 1.5f - 3 * v});
}

// Discs of full alpha in a clear ground, with a soft border.
inline PixelImage lace(PixelSize size) {
  PixelImage image{.size = size, .channels = 4, .pixels = {}};
  for (std::uint32_t y = 0; y < size.height; ++y)
    for (std::uint32_t x = 0; x < size.width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size.width),
                  v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height);
      const Vec3f c = motley(u, v);
      const float alpha = 0.5f - 4 * (std::hypot(std::fmod(4 * u, 1.0f) - 0.5f, std::fmod(4 * v, 1.0f) - 0.5f) - 0.3f);
      for (const float channel : {c.x, c.y, c.z, alpha})
        image.pixels.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(channel, 0.0f, 1.0f))));
    }
  return image;
}

// A torus whose bands have different materials: texture repeated four times, with a normal map; mirrored and clamped,
// with an object-space normal map; a plain colour; many stripes; none at all.
inline std::shared_ptr<const Hierarchy> textured_torus(bool coloured = false) {
  constexpr std::uint32_t n = 96, m = 50;
  constexpr double turn = 6.283185307179586;
  RawMesh raw;
  const auto place = [&](double i, double j) {
    const double a = turn * i / n, b = turn * j / m, r = 1 + 0.4 * std::cos(b);
    return Vec3d{r * std::cos(a), r * std::sin(a), 0.4 * std::sin(b)};
  };
  for (std::uint32_t j = 0; j < m; ++j)
    for (std::uint32_t i = 0; i < n; ++i) raw.positions.push_back(place(i, j));
  const auto add = [&](std::array<std::array<std::uint32_t, 2>, 3> corners, std::uint32_t material) {
    Triangle t, wedges;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [i, j] = corners[k];
      t.v[k] = j % m * n + i % n;
      wedges.v[k] = static_cast<std::uint32_t>(raw.wedges.uv.size());
      raw.wedges.uv.push_back({4 * static_cast<float>(i) / n - 1, 10 * static_cast<float>(j) / m - 4});
      const Vec3d p = raw.positions[t.v[k]];
      const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(90 * (v + 1.4))); };
      if (coloured) raw.wedges.colour.push_back({byte(p.x), byte(p.y), byte(p.z), 255});
    }
    raw.triangles.push_back(t);
    raw.wedges.corners.push_back(wedges);
    raw.wedges.material.push_back(material);
  };
  for (std::uint32_t j = 0; j < m; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t band = j / 10, material = band == 4 ? no_material : band;
      add({{{i, j}, {i + 1, j}, {i + 1, j + 1}}}, material);
      add({{{i, j}, {i + 1, j + 1}, {i, j + 1}}}, material);
    }
  using enum TextureWrap;
  raw.textures = {
      as_texture("motley", painted({48, 40}, motley)), as_texture("clamped", painted({33, 65}, motley), mirror, clamp),
      as_texture("stripes", painted({256, 128}, stripes), repeat, mirror),
      as_texture("bumps", painted({64, 64}, bumps)), as_texture("directions", painted({64, 32}, every_direction))};
  raw.materials = {{"motley", {1, 1, 1, 1}, 0, 3},
                   {"clamped", {1, 0.5f, 1, 1}, 1, 4},
                   {"plain", {0.6f, 0.1f, 0.05f, 1}, no_texture, no_texture},
                   {"stripes", {1, 1, 1, 1}, 2, 3}};
  const auto scheduler = make_serial_scheduler();
  Repairs repairs;
  BuildConfig config;
  config.cell_triangles = 400;
  config.strategy = Strategy::serial;
  return std::make_shared<Hierarchy>(
      build_hierarchy(prepare_mesh(std::move(raw), repairs, *scheduler), config, *scheduler));
}

struct TexturedModel {
  std::shared_ptr<const Hierarchy> hierarchy;
  Vec3f offset;  // in normalised space
  Appearance appearance;
};

struct TexturedScene {
  std::string name;
  std::vector<TexturedModel> models;
  Vec3d eye{0.3, -0.75, 0.8}, target{0.5, 0.5, 0.1};  // in the normalised space of the first
  float kappa0 = 2.5f;
  FrameSettings settings{};
  int samples = 1;
  ImageSize size{320, 240};
};

// A frame and all that it refers to. Everything visible is selected.
class TexturedFrame {
 public:
  explicit TexturedFrame(const TexturedScene& scene, const EffectRequest& request = {}) {
    frame.size = scene.size;
    frame.samples = scene.samples;
    frame.settings = scene.settings;
    frame.models.resize(scene.models.size());
    radii_.reserve(scene.models.size());
    selections_.resize(scene.models.size());
    const Hierarchy& first = *scene.models.front().hierarchy;
    const auto to_model = [&](Vec3d p) { return first.transform.origin + first.transform.scale * p; };
    const Camera camera{to_model(scene.eye), to_model(scene.target)};
    const ViewProjection vp = view_projection(camera, first, scene.size);
    const Vec3d back = scene.eye - scene.target;
    for (std::size_t k = 0; k < scene.models.size(); ++k) {
      const TexturedModel& model = scene.models[k];
      const Hierarchy& h = *model.hierarchy;
      hierarchies.push_back(&h);
      RadiiConfig config;
      config.kappa0 = scene.kappa0;
      radii_.push_back(make_radii(h, config));
      ModelFrame& m = frame.models[k];
      m.model = static_cast<std::uint32_t>(k);
      m.morph = {&h, &radii_[k], Blend::smoothstep, to_float(scene.eye) - model.offset};
      m.view_projection = vp;
      for (std::size_t r = 0; r < 4; ++r)
        m.view_projection.m[4 * r + 3] +=
            vp.m[4 * r] * model.offset.x + vp.m[4 * r + 1] * model.offset.y + vp.m[4 * r + 2] * model.offset.z;
      m.towards_eye = to_float((1 / length(back)) * back);
      m.appearance = model.appearance;
      const Frustum frustum = frustum_of(m.view_projection);
      select_cells(h, radii_[k], m.morph.viewpoint, {&frustum, false}, selections_[k]);
      m.selection = &selections_[k];
    }
    plan_effects(frame, request);
  }
  TexturedFrame(const TexturedFrame&) = delete;
  TexturedFrame& operator=(const TexturedFrame&) = delete;

  Image draw(Renderer& renderer) {
    renderer.upload(hierarchies);
    stats = renderer.draw(frame);
    return renderer.read_back();
  }

  Frame frame;
  FrameStats stats;
  std::vector<const Hierarchy*> hierarchies;

 private:
  std::vector<Radii> radii_;
  std::vector<Selection> selections_;
};

}  // namespace lodestone::test
