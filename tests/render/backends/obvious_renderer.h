// The slow twin of the software backend: every triangle of the picture in turn, every sample of the picture in turn.
// No tiles, no lanes, no lists, arithmetic in double. Only for scenes that need no clipping.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "render/backends/soft/setup_stage.h"
#include "render/frame/renderer.h"
#include "render/frame/shading.h"

namespace lodestone::test {

class ObviousRenderer final : public Renderer {
 public:
  [[nodiscard]] std::string_view name() const override { return "obvious"; }
  using Renderer::upload;
  void upload(std::span<const Hierarchy* const> models) override { hierarchy_ = models.front(); }
  [[nodiscard]] Image read_back() override { return image_; }

  FrameStats draw(const Frame& frame) override {
    const auto pixels = static_cast<std::size_t>(frame.size.width * frame.size.height);
    const auto samples = static_cast<std::size_t>(frame.samples);
    seen_.assign(pixels * samples, {1.0f, -1});
    triangles_.clear();
    for (const SelectedCell& selected : frame.only().selection->cells)
      for (const Triangle& t : hierarchy_->cells[selected.cell].triangles) draw_triangle(frame, selected, t);
    image_ = {frame.size, {}, {}};
    for (std::size_t p = 0; p < pixels; ++p) {
      const Vec3d colour = 255 * pixel_colour(frame, p) + Vec3d{0.5, 0.5, 0.5};
      for (const double channel : {colour.x, colour.y, colour.z, 255.0})
        image_.rgba.push_back(static_cast<std::uint8_t>(channel));
      image_.depth.push_back(seen_[p * samples].depth);
    }
    return {};
  }

 private:
  struct Corner {
    soft::WindowVertex at;
    Vec3f normal;
  };
  struct WindowTriangle {
    std::array<Corner, 3> v;  // clockwise
    int level = 0;
    [[nodiscard]] soft::SnappedPoint point(std::size_t k) const { return {v[k % 3].at.x, v[k % 3].at.y}; }
    [[nodiscard]] std::int64_t area() const { return soft::doubled_area(point(0), point(1), point(2)); }
    // Share of corner k times the area: the edge function of the opposite edge.
    [[nodiscard]] std::int64_t share(std::size_t k, soft::SnappedPoint p) const {
      return soft::doubled_area(point(k + 1), point(k + 2), p);
    }
    [[nodiscard]] bool covers(soft::SnappedPoint p) const {
      for (std::size_t k = 0; k < 3; ++k) {
        const soft::SnappedPoint from = point(k + 1), to = point(k + 2);
        const bool top = to.y == from.y && to.x > from.x, left = to.y < from.y;
        if (share(k, p) < 0 || (share(k, p) == 0 && !top && !left)) return false;
      }
      return area() > 0;
    }
  };
  struct Seen {
    float depth = 1;
    int triangle = -1;
  };

  [[nodiscard]] static soft::SnappedPoint sample(const Frame& frame, std::size_t pixel, std::size_t s) {
    const auto x = static_cast<int>(pixel) % frame.size.width, y = static_cast<int>(pixel) / frame.size.width;
    const soft::SnappedPoint offset = frame.samples == 1 ? soft::SnappedPoint{} : soft::sample_offsets<4>[s];
    return {x * 256 + 128 + offset.x, y * 256 + 128 + offset.y};
  }

  void draw_triangle(const Frame& frame, const SelectedCell& selected, const Triangle& t) {
    const soft::Viewport viewport(frame.size);
    WindowTriangle w;
    w.level = selected.level;
    for (std::size_t k = 0; k < 3; ++k) {
      const MorphedVertex m = morph_vertex(frame.only().morph, selected.cell, VertexId(t.v[k]));
      const soft::ClipVertex clip = soft::to_clip(frame.only().view_projection, m.position);
      ASSERT_FALSE(viewport.needs_clipping(clip));
      w.v[k] = {viewport.snap(clip), m.normal};
    }
    if (w.area() < 0) std::swap(w.v[1], w.v[2]);
    triangles_.push_back(w);
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const auto samples = static_cast<std::size_t>(frame.samples);
      const soft::SnappedPoint p = sample(frame, i / samples, i % samples);
      if (!w.covers(p)) continue;
      double z = 0;
      for (std::size_t k = 0; k < 3; ++k)
        z += static_cast<double>(w.share(k, p)) / static_cast<double>(w.area()) * w.v[k].at.z;
      if (static_cast<float>(z) < seen_[i].depth)
        seen_[i] = {static_cast<float>(z), static_cast<int>(triangles_.size()) - 1};
    }
  }

  // The mean of the samples. A triangle has one colour in a pixel: that of the centre where all samples see it, that of
  // the first sample that does elsewhere.
  [[nodiscard]] Vec3d pixel_colour(const Frame& frame, std::size_t pixel) const {
    const auto samples = static_cast<std::size_t>(frame.samples);
    std::map<int, std::vector<std::size_t>> seen_at;
    for (std::size_t s = 0; s < samples; ++s) seen_at[seen_[pixel * samples + s].triangle].push_back(s);
    Vec3d sum;
    for (const auto& [triangle, at] : seen_at) {
      Vec3d colour = to_double(frame.settings.background);
      soft::SnappedPoint p = sample(frame, pixel, at.front());
      if (at.size() == samples) {
        p.x = p.x / 256 * 256 + 128;
        p.y = p.y / 256 * 256 + 128;
      }
      if (triangle >= 0) colour = shade(frame, triangles_[static_cast<std::size_t>(triangle)], p);
      sum = sum + (static_cast<double>(at.size()) / static_cast<double>(samples)) * colour;
    }
    return sum;
  }

  // Share of the albedo that reaches the eye; `normal` of any length.
  [[nodiscard]] static float brightness(Vec3f normal, Vec3f light) {
    const float norm2 = dot(normal, normal), ambient = Lighting{}.ambient;
    const float cosine = std::abs(dot(normal, light)) / std::sqrt(std::max(norm2, shading::least_norm2));
    return ambient + (1 - ambient) * std::min(cosine, 1.0f);
  }

  [[nodiscard]] static Vec3d shade(const Frame& frame, const WindowTriangle& t, soft::SnappedPoint p) {
    Vec3d normal;
    double w = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = static_cast<double>(t.share(k, p)) * t.v[k].at.inverse_w;
      normal = normal + share * to_double(t.v[k].normal);
      w += share;
    }
    const float light = brightness(to_float((1 / w) * normal), frame.only().towards_eye);
    const Vec3f albedo =
        frame.settings.level_tint > 0 ? shading::tint_of(t.level) : frame.only().appearance.base_colour;
    return to_double(light * albedo);
  }

  const Hierarchy* hierarchy_ = nullptr;
  std::vector<WindowTriangle> triangles_;
  std::vector<Seen> seen_;  // by pixel, then sample
  Image image_;
};

}  // namespace lodestone::test
