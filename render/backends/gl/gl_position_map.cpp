#include "render/backends/gl/gl_position_map.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "core/base/error.h"
#include "render/backends/gl/device/context.h"
#include "render/backends/gl/device/device.h"
#include "render/backends/gl/device/program.h"
#include "render/backends/gl/shaders/map_programs.h"
#include "render/position_map/resolve_pixel.h"

namespace lodestone {
namespace {

// Two pictures: triangles with depth, and the float targets.
struct MapTargets {
  MapTargets(int width, int height) {
    const auto storage = [&](const GlTexture& texture, GLenum format) {
      glTextureStorage2D(texture.name(), 1, format, width, height);
      glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
      glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    };
    storage(triangle, GL_R32UI), storage(depth, GL_DEPTH_COMPONENT32F), storage(position, GL_RGBA32F);
    storage(normal, GL_RGBA32F), storage(uv, GL_RG32F), storage(colour, GL_R32UI);
    check_memory("making the targets of a position map");
    glNamedFramebufferTexture(sight.name(), GL_COLOR_ATTACHMENT0, triangle.name(), 0);
    glNamedFramebufferTexture(sight.name(), GL_DEPTH_ATTACHMENT, depth.name(), 0);
    const GLuint attached[]{position.name(), normal.name(), uv.name(), colour.name()};
    std::array<GLenum, 4> buffers{};
    for (unsigned k = 0; k < 4; ++k) {
      buffers[k] = GL_COLOR_ATTACHMENT0 + k;
      glNamedFramebufferTexture(resolved.name(), buffers[k], attached[k], 0);
    }
    glNamedFramebufferDrawBuffers(resolved.name(), 4, buffers.data());
    if (glCheckNamedFramebufferStatus(sight.name(), GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE ||
        glCheckNamedFramebufferStatus(resolved.name(), GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw UnsupportedError("OpenGL: float targets of position maps are missing; use --backend soft");
  }

  GlTexture triangle, depth, position, normal, uv, colour;
  GlFramebuffer sight, resolved;
};

class GlMapRenderer final : public MapRenderer {
 public:
  explicit GlMapRenderer(const IndexedMesh& mesh)
      : mesh_(mesh), context_(make_headless_context()), current_(*context_) {
    watch_errors();
    device_ = query_device();
    sight_ = make_map_sight_program();
    resolve_ = make_map_resolve_program();
    upload(positions_, std::as_bytes(std::span(mesh.positions)));
    upload(triangles_, std::as_bytes(std::span(mesh.triangles)));
    upload(uv_, std::as_bytes(std::span(mesh.wedges.uv)));
    upload(colour_, std::as_bytes(std::span(mesh.wedges.colour)));
    check_memory("uploading the mesh");
    glVertexArrayElementBuffer(array_.name(), triangles_.name());
  }

  PositionMap draw(const MapView& view, MapChannels channels) override {
    check_view(view);
    if (std::max(view.width, view.height) > device_.max_target_size)
      throw UnsupportedError(describe("", "OpenGL",
                                      "a map of " + std::to_string(view.width) + "x" + std::to_string(view.height) +
                                          " pixels is larger than its pictures",
                                      "use --backend soft or a lower resolution"));
    const Range range = depth_range(view);
    PositionMap map = empty_map(mesh_, view, channels, PixelGroups::all(view.pixels()));
    MapTargets targets(view.width, view.height);
    bind_state(view);
    draw_sight(view, range, targets);
    resolve(view, map, targets);
    read_back(map, targets);
    return without_gaps(map);
  }

 private:
  struct Range {
    double first = 0, inverse_extent = 1;
  };

  void upload(const GlBuffer& buffer, std::span<const std::byte> bytes) {
    if (bytes.size() > device_.max_storage_block_bytes)
      throw ResourceError(describe("", "OpenGL", "the mesh does not fit into a storage block", "use --backend soft"));
    glNamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(std::max<std::size_t>(bytes.size(), 4)),
                         bytes.empty() ? nullptr : bytes.data(), 0);
  }

  // Range of the value that decides which triangle is nearest: depth, or -1/depth, which is linear in the window.
  [[nodiscard]] Range depth_range(const MapView& view) const {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const Vec3f& p : mesh_.positions) {
      const double depth = view.depth(to_double(p));
      if (view.projection == Projection::perspective && !(depth > 0))
        throw InputError(
            describe("view", "", "a vertex is not in front of the eye", "move the eye away from the model"));
      const double z = view.projection == Projection::perspective ? -1 / depth : depth;
      lo = std::min(lo, z), hi = std::max(hi, z);
    }
    // A little room, so that nothing is clipped by rounding.
    const double room = 0.01 * (hi - lo) + 1e-6;
    // Points nearer than the view allows are in front of the near plane of OpenGL.
    const double first = view.nearest > 0 ? std::min(nearest_z(view), hi) : lo - room;
    return {first, 1 / (hi + room - first)};
  }

  void bind_state(const MapView& view) const {
    const GLuint buffers[]{positions_.name(), triangles_.name(), uv_.name(), colour_.name()};
    for (GLuint k = 0; k < 4; ++k) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, k, buffers[k]);
    glBindVertexArray(array_.name());
    glViewport(0, 0, view.width, view.height);
    for (const GLenum off : {GL_CULL_FACE, GL_BLEND, GL_SCISSOR_TEST, GL_MULTISAMPLE, GL_PRIMITIVE_RESTART})
      glDisable(off);
  }

  void set_view(GLuint program, const MapView& view) const {
    const auto set = [&](GLint at, Vec3d v) { glProgramUniform3d(program, at, v.x, v.y, v.z); };
    set(map_eye, view.eye), set(map_right, view.right), set(map_up, view.up), set(map_forward, view.forward);
    glProgramUniform1d(program, map_pixel, view.pixel);
    glProgramUniform2i(program, map_size, view.width, view.height);
    glProgramUniform1i(program, map_central, view.projection == Projection::perspective);
  }

  void draw_sight(const MapView& view, const Range& range, const MapTargets& targets) const {
    set_view(sight_.name(), view);
    glProgramUniform2d(sight_.name(), map_depth_range, range.first, range.inverse_extent);
    const GLuint nothing = no_triangle;
    const float farthest = 1;
    glClearNamedFramebufferuiv(targets.sight.name(), GL_COLOR, 0, &nothing);
    glClearNamedFramebufferfv(targets.sight.name(), GL_DEPTH, 0, &farthest);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, targets.sight.name());
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);  // of equally near triangles the one that is drawn first
    glDepthMask(GL_TRUE);
    glUseProgram(sight_.name());
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh_.triangles.size()), GL_UNSIGNED_INT, nullptr);
  }

  void resolve(const MapView& view, const PositionMap& map, const MapTargets& targets) const {
    set_view(resolve_.name(), view);
    glProgramUniform1i(resolve_.name(), map_channels, (map.uv.empty() ? 0 : 1) | (map.colour.empty() ? 0 : 2));
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, targets.resolved.name());
    glDisable(GL_DEPTH_TEST);
    glBindTextureUnit(0, targets.triangle.name());
    glUseProgram(resolve_.name());
    draw_screen(nothing_);
  }

  static void read_back(PositionMap& map, const MapTargets& targets) {
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    for (const GLenum skipped : {GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS, GL_PACK_SWAP_BYTES})
      glPixelStorei(skipped, 0);
    const auto read = [&](const GlTexture& texture, GLenum format, GLenum type, std::size_t bytes, void* to) {
      glGetTextureImage(texture.name(), 0, format, type, static_cast<GLsizei>(bytes), to);
    };
    const std::size_t n = map.view.pixels();
    std::vector<std::uint32_t> one(n);
    read(targets.triangle, GL_RED_INTEGER, GL_UNSIGNED_INT, 4 * n, one.data());
    map.triangle = PixelArray(one);
    std::vector<std::array<float, 4>> four(n);
    read(targets.position, GL_RGBA, GL_FLOAT, 16 * n, four.data());
    for (std::size_t i = 0; i < n; ++i) {
      map.position[i] = {four[i][0], four[i][1], four[i][2]};
      map.depth[i] = four[i][3];
    }
    read(targets.normal, GL_RGBA, GL_FLOAT, 16 * n, four.data());
    for (std::size_t i = 0; i < n; ++i) map.normal[i] = {four[i][0], four[i][1], four[i][2]};
    if (!map.uv.empty()) {
      std::vector<Vec2f> two(n);
      read(targets.uv, GL_RG, GL_FLOAT, 8 * n, two.data());
      map.uv = PixelArray(two);
    }
    if (!map.colour.empty()) {
      std::vector<Rgba8> colours(n);
      read(targets.colour, GL_RED_INTEGER, GL_UNSIGNED_INT, 4 * n, colours.data());
      map.colour = PixelArray(colours);
    }
  }

  const IndexedMesh& mesh_;
  std::unique_ptr<GlContext> context_;
  CurrentContext current_;
  GlDevice device_;
  GlProgram sight_{0}, resolve_{0};
  GlBuffer positions_, triangles_, uv_, colour_;
  GlVertexArray array_, nothing_;
};

}  // namespace

std::unique_ptr<MapRenderer> make_gl_map_renderer(const IndexedMesh& mesh, Scheduler& /*scheduler*/) {
  return std::make_unique<GlMapRenderer>(mesh);
}

}  // namespace lodestone
