#include "render/backends/gl/scene/textures.h"

#include <algorithm>

#include "render/backends/gl/device/device.h"
#include "render/backends/gl/shaders/draw_program.h"

namespace lodestone {
namespace {

void set_filter(GLuint pages) {
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTextureParameteri(pages, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTextureParameteri(pages, wrap, GL_CLAMP_TO_EDGE);
}

}  // namespace

void GlTextures::set_models(std::span<const Hierarchy* const> models) {
  static_assert(page_for({TextureLimits{}.side, TextureLimits{}.side}).height <= 16384, "what OpenGL 4.5 promises");
  textures_.set_models(models);
  packer_ = PagePacker(page_for(textures_.largest()));
  models_ = static_cast<std::uint32_t>(models.size());
  first_materials_.clear();
  for (std::uint32_t m = 0, first = 0; m < models_; ++m) {
    first_materials_.push_back(first);
    first += static_cast<std::uint32_t>(textures_.materials(m).size());
  }
  first_levels_.assign(textures_.textures().size(), no_texture);
  places_.clear();
  levels_.clear();
  pages_ = {};
  allocated_pages_ = 0;
  send_tables();
}

std::size_t GlTextures::prepare(const Frame& frame, Scheduler& scheduler) {
  const std::size_t decoded = textures_.prepare(frame, scheduler);
  if (decoded == 0) return 0;
  std::vector<std::uint32_t> fresh;
  for (std::uint32_t t = 0; t < first_levels_.size(); ++t)
    if (first_levels_[t] == no_texture && !textures_.textures()[t].levels.empty()) fresh.push_back(t);
  // Large ones first: the gaps hold small ones.
  std::ranges::stable_sort(fresh, std::greater{},
                           [&](std::uint32_t t) { return textures_.textures()[t].levels.front().size.height; });
  for (const std::uint32_t texture : fresh) place(texture);
  grow(packer_.pages());
  for (const std::uint32_t texture : fresh) send(texture);
  send_tables();
  return decoded;
}

void GlTextures::place(std::uint32_t texture) {
  first_levels_[texture] = static_cast<std::uint32_t>(levels_.size());
  const PixelSize page = packer_.page_size();
  for (const MipLevel& level : textures_.textures()[texture].levels) {
    const PagePlace at = packer_.add({level.stride(), level.rows()});
    places_.push_back(at);
    levels_.push_back(
        {{static_cast<float>(at.x + 1), static_cast<float>(at.y + 1), static_cast<float>(level.size.width),
          static_cast<float>(level.size.height)},
         {static_cast<float>(at.page), 1 / static_cast<float>(page.width), 1 / static_cast<float>(page.height), 0}});
  }
}

// Storage of a texture cannot grow: its contents are copied to a larger one.
void GlTextures::grow(std::uint32_t pages) {
  if (pages <= allocated_pages_) return;
  const auto [width, height] = packer_.page_size();
  const auto size = [](std::uint32_t v) { return static_cast<GLsizei>(v); };
  GlTextureArray larger;
  glTextureStorage3D(larger.name(), 1, GL_RGBA8, size(width), size(height), size(pages));
  check_memory("uploading textures");
  set_filter(larger.name());
  if (allocated_pages_ > 0)
    glCopyImageSubData(pages_.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, larger.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0,
                       size(width), size(height), size(allocated_pages_));
  pages_ = std::move(larger);
  allocated_pages_ = pages;
}

void GlTextures::send(std::uint32_t texture) {
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (const GLenum skipped : {GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS,
                               GL_UNPACK_SKIP_IMAGES, GL_UNPACK_SWAP_BYTES})
    glPixelStorei(skipped, 0);
  std::size_t number = first_levels_[texture];
  for (const MipLevel& level : textures_.textures()[texture].levels) {
    const PagePlace& at = places_[number++];
    const auto size = [](std::uint32_t v) { return static_cast<GLsizei>(v); };
    glTextureSubImage3D(pages_.name(), 0, size(at.x), size(at.y), size(at.page), size(level.stride()),
                        size(level.rows()), 1, GL_RGBA, GL_UNSIGNED_INT_8_8_8_8_REV, level.texels.data());
  }
  check_memory("uploading textures");
  textures_.release(texture);
}

GlTextures::Map GlTextures::map_of(std::uint32_t texture) const {
  if (texture == no_texture || first_levels_[texture] == no_texture) return {};
  const SurfaceTexture& t = textures_.textures()[texture];
  return {first_levels_[texture], static_cast<std::uint32_t>(t.levels.size() - 1),
          static_cast<std::uint32_t>(t.wrap_u) | static_cast<std::uint32_t>(t.wrap_v) << 2, t.object_space ? 1u : 0u};
}

GlTextures::Placed GlTextures::placed(std::uint32_t texture, const MapPlace& at) const {
  return {map_of(texture), {at.a, at.b, at.c, at.d}, {at.x, at.y}};
}

void GlTextures::send_tables() {
  std::vector<Entry> entries;
  for (std::uint32_t m = 0; m < models_; ++m)
    for (const SurfaceMaterial& material : textures_.materials(m)) {
      const Vec3f c = material.base_colour, e = material.emission;
      entries.push_back({{c.x, c.y, c.z, material.alpha},
                         map_of(material.texture),
                         placed(material.normal_map, material.normal_place),
                         placed(material.occlusion_map, material.occlusion_place),
                         placed(material.emission_map, material.emission_place),
                         {e.x, e.y, e.z, material.normal_scale},
                         {material.occlusion_strength, material.alpha_cutoff},
                         {static_cast<std::uint32_t>(material.alpha_mode), material.one_sided, material.unlit}});
    }
  const auto replace = [](const GlBuffer& buffer, const void* data, std::size_t bytes) {
    glNamedBufferData(buffer.name(), static_cast<GLsizeiptr>(std::max<std::size_t>(bytes, 4)), bytes ? data : nullptr,
                      GL_STATIC_DRAW);
  };
  replace(materials_buffer_, entries.data(), entries.size() * sizeof(Entry));
  replace(levels_buffer_, levels_.data(), levels_.size() * sizeof(Level));
}

void GlTextures::bind() const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, materials_block, materials_buffer_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, texture_levels_block, levels_buffer_.name());
  if (allocated_pages_ == 0) return;
  glBindTextureUnit(texture_pages_unit, pages_.name());
  glBindSampler(texture_pages_unit, 0);
}

}  // namespace lodestone
