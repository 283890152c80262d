// Materials and textures of the models of a renderer, the same for every backend.
//
// A texture is decoded when a frame first shows it, once, whatever number of materials and models share it. How far
// textures are reduced for their memory follows from the models alone, not from their visible parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/scheduler/scheduler.h"
#include "render/frame/frame.h"
#include "render/textures/mip_chain.h"

namespace lodestone {

struct TextureLimits {
  std::uint32_t side = 8192;           // longest side of a texture, texels
  std::uint64_t bytes = 512ull << 20;  // of all textures together, mip levels included
};

struct SurfaceTexture {
  std::vector<MipLevel> levels;  // empty: not shown yet
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  bool object_space = false;  // of a normal map
};

// (u, v) -> (a u + b v + x, c u + d v + y): where a map lies on the coordinates of the mesh.
struct MapPlace {
  float a = 1, b = 0, c = 0, d = 1, x = 0, y = 0;
  friend bool operator==(const MapPlace&, const MapPlace&) = default;
};

struct SurfaceMaterial {
  Vec3f base_colour{1, 1, 1};                                   // as the picture has it: in the sRGB encoding
  std::uint32_t texture = no_texture, normal_map = no_texture;  // of SurfaceTextures
  float normal_scale = 1;                                       // of x and y of the normal map
  std::uint32_t occlusion_map = no_texture;
  float occlusion_strength = 1;
  Vec3f emission{};  // encoded as the base colour is
  std::uint32_t emission_map = no_texture;
  MapPlace normal_place{}, occlusion_place{}, emission_place{};
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha = 1, alpha_cutoff = 0;  // alpha: times that of the texture and of the vertices
  bool one_sided = false, unlit = false;
};

class SurfaceTextures {
 public:
  // Sets the models, which must outlive it. Nothing is decoded yet.
  void set_models(std::span<const Hierarchy* const> models, const TextureLimits& limits = {});

  // Decodes missing textures that the models of the frame call for. Returns their number.
  std::size_t prepare(const Frame& frame, Scheduler& scheduler);

  // Materials of an uploaded model: the first for triangles without a material, then those of its hierarchy.
  [[nodiscard]] std::span<const SurfaceMaterial> materials(std::uint32_t model) const { return materials_[model]; }
  [[nodiscard]] std::span<const SurfaceTexture> textures() const { return textures_; }
  // True if a map of any material has a place of its own.
  [[nodiscard]] bool moves_maps() const { return moves_maps_; }
  // Room for any texture, those included that are not shown yet.
  [[nodiscard]] PixelSize largest() const;
  // Frees the texels of a texture that lies elsewhere now.
  void release(std::uint32_t texture);

  // Parts that could not be shown as the models have them, since the last call.
  [[nodiscard]] std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }

 private:
  struct Source {
    const Hierarchy* hierarchy = nullptr;
    std::uint32_t texture = 0;
    PixelMeaning meaning = PixelMeaning::colours;
    PixelSize size;              // in its file; nothing: no image
    std::uint32_t halvings = 0;  // by which it is reduced
    TexelAlpha alpha = TexelAlpha::left_out;
    bool decoded = false;
    std::string refusal;  // why the placeholder is shown
  };
  void add_model(const Hierarchy& hierarchy);
  [[nodiscard]] SurfaceMaterial surface_of(const Hierarchy& hierarchy, const Material& material);
  [[nodiscard]] std::uint32_t source_of(const Hierarchy& hierarchy, std::uint32_t texture, PixelMeaning meaning);
  void reduce(const TextureLimits& limits);
  void decode(std::uint32_t texture);
  void warn(std::uint32_t texture);

  std::vector<const Hierarchy*> models_;
  std::vector<std::vector<SurfaceMaterial>> materials_;
  std::vector<Source> sources_;  // of textures_
  std::vector<SurfaceTexture> textures_;
  bool moves_maps_ = false;
  std::vector<std::string> warnings_;
};

// True if the frame's model shows textures, or normal maps, of its hierarchy.
[[nodiscard]] bool shows_textures(const ModelFrame& model);
[[nodiscard]] bool shows_normal_maps(const ModelFrame& model);
[[nodiscard]] bool shows_occlusion_maps(const ModelFrame& model);
[[nodiscard]] bool shows_emission(const ModelFrame& model);
[[nodiscard]] bool shows_unlit(const ModelFrame& model);
// True if materials of that mode, or of any but opaque, are shown as such.
[[nodiscard]] bool shows_alpha(const Frame& frame, const ModelFrame& model, AlphaMode mode);
[[nodiscard]] bool shows_alpha(const Frame& frame, const ModelFrame& model);

}  // namespace lodestone
