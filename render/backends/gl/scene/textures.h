// Materials and textures on the device.
//
// All levels of all textures lie as rectangles on the pages of one texture array, each with its border, so that the
// hardware's interpolation finds neighbours there and wrapping is a matter of coordinates: one binding for models with
// any number of textures of any sizes and wrap modes, and one multi-draw for all of them (docs/decisions/0033).
#pragma once

#include <vector>

#include "core/texture/page_packer.h"
#include "render/backends/gl/device/object.h"
#include "render/textures/surface_textures.h"

namespace lodestone {

class GlTextures {
 public:
  // The models must outlive it.
  void set_models(std::span<const Hierarchy* const> models);

  // Decodes the textures that the frame's models show and the device lacks, sends them, and releases them in main
  // memory. Returns the number of textures decoded. Throws ResourceError when the memory of the device does not
  // suffice.
  std::size_t prepare(const Frame& frame, Scheduler& scheduler);
  void bind() const;

  // Number of the model's entry for triangles without a material; those of its materials follow.
  [[nodiscard]] std::uint32_t first_material(std::uint32_t model) const { return first_materials_[model]; }
  [[nodiscard]] std::vector<std::string> take_warnings() { return textures_.take_warnings(); }

 private:
  void place(std::uint32_t texture);
  void grow(std::uint32_t pages);
  void send(std::uint32_t texture);
  void send_tables();

  // As the shaders read it, std430.
  struct Level {
    float place[4] = {}, page[4] = {};
  };
  struct Map {
    std::uint32_t first_level = no_texture, more_levels = 0, wraps = 0, object_space = 0;
  };
  struct Placed {
    Map map;
    float turn[4] = {}, move[4] = {};
  };
  struct Entry {
    float base_colour[4] = {};  // and alpha
    Map colours;
    Placed normals, occlusion, emission_map;
    float emission[4] = {};       // and the scale of the normal map
    float factors[4] = {};        // strength of the occlusion, cutoff of alpha
    std::uint32_t flags[4] = {};  // alpha mode, seen from one side, unlit
  };
  [[nodiscard]] Map map_of(std::uint32_t texture) const;
  [[nodiscard]] Placed placed(std::uint32_t texture, const MapPlace& at) const;

  SurfaceTextures textures_;
  std::uint32_t models_ = 0;
  std::vector<std::uint32_t> first_materials_, first_levels_;  // by model; by texture, no_texture: not there
  PagePacker packer_{PixelSize{}};
  std::vector<PagePlace> places_;  // of levels_
  std::vector<Level> levels_;
  std::uint32_t allocated_pages_ = 0;
  GlTextureArray pages_;
  GlBuffer materials_buffer_, levels_buffer_;
};

}  // namespace lodestone
