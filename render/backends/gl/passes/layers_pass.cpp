#include "render/backends/gl/passes/layers_pass.h"

#include <algorithm>

#include "core/base/error.h"
#include "render/backends/gl/device/device.h"
#include "render/backends/gl/device/program.h"
#include "render/effects/transparency.h"

namespace lodestone {
namespace {

// Layers are taken from the front to the back, each time the next one after the last: lists are short, and nothing
// limits their length. Equal layers, of one depth and colour, count as often as they occur.
constexpr const char* over_source = R"(
layout(std430, binding = 8) readonly restrict buffer Heads { uint count, width, heads[]; };
layout(std430, binding = 9) readonly restrict buffer Nodes { uint nodes[]; };
layout(location = 0) out vec4 result;  // light, and the share of the layers behind that is let through

bool before(uvec3 a, uvec3 b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }

#ifdef MULTISAMPLED
layout(binding = 9) uniform sampler2DMS opaque_depth;
float limit;  // of the opaque surfaces
bool is_here(uint node, out uvec3 key) {
  vec2 from_centre = gl_SamplePosition - 0.5;
  float depth = uintBitsToFloat(nodes[node + 1u]) + uintBitsToFloat(nodes[node + 4u]) * from_centre.x +
                uintBitsToFloat(nodes[node + 5u]) * from_centre.y;
  key = uvec3(floatBitsToUint(max(depth, 0.0)), nodes[node + 2u], nodes[node + 3u]);
  return (nodes[node + 6u] >> gl_SampleID & 1u) != 0u && depth < limit;
}
#else
bool is_here(uint node, out uvec3 key) {
  key = uvec3(nodes[node + 1u], nodes[node + 2u], nodes[node + 3u]);
  return true;
}
#endif

void main() {
  uint head = heads[uint(gl_FragCoord.y) * width + uint(gl_FragCoord.x)];
  if (head == 0u) discard;
#ifdef MULTISAMPLED
  limit = texelFetch(opaque_depth, ivec2(gl_FragCoord.xy), gl_SampleID).r;
#endif
  vec3 light = vec3(0.0);
  float through = 1.0;
  uvec3 last = uvec3(0u);
  for (bool first = true;; first = false) {
    uvec3 next = uvec3(0xffffffffu), key;
    int times = 0;
    for (uint n = head; n != 0u; n = nodes[(n - 1u) * NODE]) {
      if (!is_here((n - 1u) * NODE, key) || !(first || before(last, key))) continue;
      if (times == 0 || before(key, next)) {
        next = key;
        times = 1;
      } else if (key == next) {
        ++times;
      }
    }
    if (times == 0) break;
    vec4 layer = vec4(unpackUnorm2x16(next.y), unpackUnorm2x16(next.z));
    for (int k = 0; k < times; ++k) {
      light += through * layer.a * layer.rgb;
      through *= 1.0 - layer.a;
    }
    last = next;
  }
  result = vec4(light, through);
}
)";

constexpr std::uint64_t words(int samples) { return samples == 1 ? 4 : 7; }

std::string layers_source(int samples) {
  return "#define NODE " + std::to_string(words(samples)) + "u\n" + (samples > 1 ? "#define MULTISAMPLED\n" : "") +
         over_source;
}

}  // namespace

GlLayers::GlLayers(ImageSize size, int samples, std::size_t max_bytes)
    : size_(size),
      samples_(samples),
      node_bytes_(words(samples) * sizeof(std::uint32_t)),
      max_bytes_(max_bytes),
      over_(make_screen_program(layers_source(samples))) {
  GLint blocks = 0;
  glGetIntegerv(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, &blocks);
  if (blocks <= static_cast<GLint>(layer_nodes_block))
    throw UnsupportedError(describe("", "OpenGL",
                                    "transparent models take " + std::to_string(layer_nodes_block + 1) +
                                        " storage blocks; the driver binds " + std::to_string(blocks),
                                    "use --backend soft"));
  const auto pixels = static_cast<GLsizeiptr>(size.width) * size.height;
  glNamedBufferStorage(heads_.name(), (2 + pixels) * 4, nullptr, GL_DYNAMIC_STORAGE_BIT);
  check_memory("making the lists of layers");
  reserve(static_cast<std::uint64_t>(pixels));
}

void GlLayers::reserve(std::uint64_t nodes) {
  const std::uint64_t most = max_bytes_ / node_bytes_;
  if (nodes > most)
    throw ResourceError(describe(
        "", "OpenGL",
        std::to_string(nodes) + " transparent fragments do not fit into " + std::to_string(max_bytes_ >> 20) + " MiB",
        "draw a smaller picture, or use --backend soft"));
  room_ = std::min(most, nodes + nodes / 4);
  glNamedBufferData(nodes_.name(), static_cast<GLsizeiptr>(room_ * node_bytes_), nullptr, GL_DYNAMIC_DRAW);
  check_memory("making the lists of layers");
}

void GlLayers::collect(const GlScene& scene, const std::function<void(const GlPipeline&)>& use) {
  const std::uint32_t none = 0, width = static_cast<std::uint32_t>(size_.width);
  glClearNamedBufferData(heads_.name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
  glNamedBufferSubData(heads_.name(), 4, 4, &width);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, layer_heads_block, heads_.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, layer_nodes_block, nodes_.name());
  commands_.draw(scene, use);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  std::uint32_t count = 0;
  glGetNamedBufferSubData(heads_.name(), 0, 4, &count);
  fragments_ = count;
}

void GlLayers::draw(const Frame& frame, const GlScene& scene, GlStream& stream,
                    const std::function<void(const GlPipeline&)>& use, const GlTarget& target, bool keeps_through) {
  GlGeometry geometry{samples_ == 1 ? GlPass::layers : GlPass::layers_4x, &ModelFrame::selection, {}};
  for (const ModelFrame& model : frame.models)
    if (effects::has_layers(frame, model)) geometry.models.push_back(&model);
  commands_.set(frame, scene, geometry, stream);
  glDepthMask(GL_FALSE);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  collect(scene, use);
  if (fragments_ > room_) {  // nothing of the target has changed: once more, with room for all
    reserve(fragments_);
    collect(scene, use);
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, keeps_through ? GL_SRC_ALPHA : GL_ONE);
  if (samples_ > 1) glBindTextureUnit(9, target.drawn_depth());
  glUseProgram(over_.name());
  draw_screen(nothing_);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
}

}  // namespace lodestone
