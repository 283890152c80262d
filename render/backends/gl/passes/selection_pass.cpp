#include "render/backends/gl/passes/selection_pass.h"

#include <algorithm>
#include <array>
#include <string>

#include "render/backends/gl/device/device.h"
#include "render/backends/gl/device/program.h"
#include "render/backends/gl/shaders/exact_root.h"
#include "render/lod/limits.h"

namespace lodestone {
namespace {

constexpr GLuint nodes_block = 0, decisions_block = 1, detail_limits_block = 2, cell_radii_block = 3, view_block = 0;
constexpr unsigned group_size = 64;
constexpr std::uint32_t level_shift = 28;
constexpr std::uint32_t drawn_bit = 1, morphing_bit = 2;

// std140. By level: r_l, a_l, margin of culling, delta h_l. finest: there all cells are drawn; by_cell: 1 if cells have
// radii of their own.
struct ViewUniforms {
  std::array<std::array<float, 4>, 6> frustum{};
  std::array<std::array<float, 4>, max_level + 1> levels{};
  std::array<float, 3> viewpoint{};
  std::uint32_t finest = 0;
  std::uint32_t node_count = 0, limit_count = 0, by_cell = 0, unused = 0;
};

// std430: a box, and the radius beside its lower corner.
struct LimitUniforms {
  std::array<float, 4> lo{}, hi{};
};

// selection.cpp, limits.cpp and distance_metric.h, operation by operation.
constexpr const char* selection_source = R"(
layout(local_size_x = 64) in;
struct Node { float lo_x, lo_y, lo_z, hi_x, hi_y, hi_z; uint parent, cell_and_level; };
struct Limit { vec4 lo, hi; };
layout(std430, binding = 0) readonly restrict buffer Nodes { Node nodes[]; };
layout(std430, binding = 1) writeonly restrict buffer Decisions { uint decisions[]; };
layout(std430, binding = 2) readonly restrict buffer Limits { Limit limits[]; };
layout(std430, binding = 3) readonly restrict buffer Radii { float radii[]; };  // by cell
layout(std140, binding = 0) uniform View {
  vec4 frustum[6];
  vec4 levels[LEVELS];
  vec3 viewpoint;
  uint finest;
  uint node_count, limit_count, by_cell;
} view;

struct Box { vec3 lo, hi; };
Box box_of(uint i) {
  Node n = nodes[i];
  return Box(vec3(n.lo_x, n.lo_y, n.lo_z), vec3(n.hi_x, n.hi_y, n.hi_z));
}

float norm(vec3 a) {
#ifdef CHEBYSHEV
  return max(max(a.x, a.y), a.z);
#else
  precise float sum = (a.x * a.x + a.y * a.y) + a.z * a.z;
  return exact_root(sum);
#endif
}

// Along each axis: distances of the box from the viewpoint, and of two boxes.
float nearest(Box box) {
  precise vec3 outside = max(max(box.lo - view.viewpoint, view.viewpoint - box.hi), vec3(0.0));
  return norm(outside);
}
float farthest(Box box) {
  precise vec3 far = max(abs(view.viewpoint - box.lo), abs(box.hi - view.viewpoint));
  return norm(far);
}
float farthest_from(Box box, Limit limit) {
  precise vec3 far = max(max(limit.lo.xyz - box.lo, box.hi - limit.hi.xyz), vec3(0.0));
  return norm(far);
}
float nearest_to(Box box, Limit limit) {
  precise vec3 apart = max(max(limit.lo.xyz - box.hi, box.lo - limit.hi.xyz), vec3(0.0));
  return norm(apart);
}

// A limit whose radius is at most d leaves less than d: it needs no root.
float limited_distance(Box box) {
  float d = nearest(box);
  for (uint i = 0u; i < view.limit_count; ++i) {
    if (limits[i].lo.w <= d) continue;
    precise float left = limits[i].lo.w - farthest_from(box, limits[i]);
    d = max(d, left);
  }
  return d;
}
float limited_farthest_distance(Box box) {
  float d = farthest(box);
  for (uint i = 0u; i < view.limit_count; ++i) {
    if (limits[i].lo.w <= d) continue;
    precise float left = limits[i].lo.w - nearest_to(box, limits[i]);
    d = max(d, left);
  }
  return d;
}

float own_radius(uint i) { return radii[nodes[i].cell_and_level & 0xfffffffu]; }

bool coarse_enough(uint i, Box box, uint level) {
  return limited_distance(box) >= (view.by_cell != 0u ? own_radius(i) : view.levels[level].x);
}

bool moves(uint i, Box box, uint level) {
  if (view.by_cell == 0u || level == 0u) return limited_farthest_distance(box) >= view.levels[level].y;
  precise float still = own_radius(i) + view.levels[level].w;
  return limited_distance(box) > still;
}

bool outside(Box box, float margin) {
  precise vec3 lo = box.lo - margin;
  precise vec3 hi = box.hi + margin;
  for (int k = 0; k < 6; ++k) {
    vec4 plane = view.frustum[k];
    vec3 corner = mix(lo, hi, greaterThanEqual(plane.xyz, vec3(0.0)));
    precise float side = ((plane.x * corner.x + plane.y * corner.y) + plane.z * corner.z) + plane.w;
    if (side < 0.0) return true;
  }
  return false;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= view.node_count) return;
  Box box = box_of(i);
  uint level = nodes[i].cell_and_level >> 28;
  bool seen = !outside(box, view.levels[level].z);
  bool drawn = seen && (level == view.finest || coarse_enough(i, box, level));
  uint above = i, level_above = level;
  while (drawn && seen && level_above > 0u) {
    above = nodes[above].parent;
    level_above -= 1u;
    Box around = box_of(above);
    seen = !outside(around, view.levels[level_above].z);
    drawn = seen && !coarse_enough(above, around, level_above);
  }
  decisions[i] = drawn && seen ? (moves(i, box, level) ? 3u : 1u) : 0u;
}
)";

ViewUniforms view_uniforms(const ModelFrame& model, std::size_t nodes) {
  const Hierarchy& hierarchy = *model.morph.hierarchy;
  const Radii& radii = *model.morph.radii;
  ViewUniforms u;
  const Frustum frustum = frustum_of(model.view_projection);
  for (std::size_t k = 0; k < 6; ++k) u.frustum[k] = {frustum[k].n.x, frustum[k].n.y, frustum[k].n.z, frustum[k].d};
  for (std::size_t l = 0; l < radii.select.size(); ++l) {
    const int level = static_cast<int>(l);
    u.levels[l] = {radii.select[l], radii.band_begin[l], hierarchy.displacement_bound(level),
                   radii.delta * hierarchy.cell_size(level)};
  }
  u.viewpoint = {model.morph.viewpoint.x, model.morph.viewpoint.y, model.morph.viewpoint.z};
  u.finest = static_cast<std::uint32_t>(hierarchy.finest());
  u.node_count = static_cast<std::uint32_t>(nodes);
  u.limit_count = static_cast<std::uint32_t>(model.morph.limits.size());
  u.by_cell = radii.by_cell.empty() ? 0 : 1;
  return u;
}

std::vector<LimitUniforms> limit_uniforms(DetailLimits limits) {
  std::vector<LimitUniforms> all;
  for (const auto& [box, radius] : limits)
    all.push_back({{box.lo.x, box.lo.y, box.lo.z, radius}, {box.hi.x, box.hi.y, box.hi.z, 0}});
  return all;
}

}  // namespace

GlSelector::GlSelector(std::span<const Hierarchy* const> models) {
  for (const Hierarchy* hierarchy : models) {
    Model model;
    std::vector<Node> nodes;
    struct Open {
      CellId cell;
      std::uint32_t parent;  // node
      std::uint8_t level;
    };
    std::vector<Open> open;
    if (!hierarchy->cells.empty()) open.push_back({CellId(0), 0, 0});
    while (!open.empty()) {
      const auto [id, parent, level] = open.back();
      open.pop_back();
      const Cell& cell = hierarchy->cells[id];
      const auto own = static_cast<std::uint32_t>(nodes.size());
      nodes.push_back({cell.bounds, parent, id | std::uint32_t{level} << level_shift});
      model.cells.push_back(id);
      model.levels.push_back(level);
      for (std::uint32_t k = cell.child_count; k-- > 0;)
        open.push_back({CellId(cell.first_child + k), own, static_cast<std::uint8_t>(level + 1)});
    }
    const auto bytes = [](std::size_t size) { return static_cast<GLsizeiptr>(std::max<std::size_t>(size, 4)); };
    glNamedBufferStorage(model.nodes.name(), bytes(nodes.size() * sizeof(Node)), nodes.empty() ? nullptr : nodes.data(),
                         0);
    glNamedBufferStorage(model.decisions.name(), bytes(nodes.size() * 4), nullptr, 0);
    glNamedBufferStorage(model.radii.name(), bytes(hierarchy->cells.size() * sizeof(float)), nullptr,
                         GL_DYNAMIC_STORAGE_BIT);
    check_memory("uploading the table of cells");
    models_.push_back(std::move(model));
  }
}

const GlProgram& GlSelector::program(DistanceMetric metric) {
  std::optional<GlProgram>& program = programs_[static_cast<std::size_t>(metric)];
  if (!program) {
    std::string text = "#define LEVELS " + std::to_string(max_level + 1) + "\n";
    if (metric == DistanceMetric::chebyshev) text += "#define CHEBYSHEV\n";
    const GlStage stage{GL_COMPUTE_SHADER, text + exact_root_source + selection_source};
    program = link_program(std::span(&stage, 1));
  }
  return *program;
}

void GlSelector::send_radii(Model& model, const std::vector<float>& by_cell) {
  if (by_cell == model.sent_radii) return;
  model.sent_radii = by_cell;
  glNamedBufferSubData(model.radii.name(), 0, static_cast<GLsizeiptr>(by_cell.size() * sizeof(float)), by_cell.data());
}

void GlSelector::select(const ModelFrame& model, GlStream& stream, Selection& out) {
  Model& own = models_[model.model];
  out.cells.clear();
  out.visited = 0;
  if (own.cells.empty()) return;
  const ViewUniforms view = view_uniforms(model, own.cells.size());
  const std::vector<LimitUniforms> limits = limit_uniforms(model.morph.limits);
  if (view.by_cell) send_radii(own, model.morph.radii->by_cell);
  glUseProgram(program(model.morph.radii->metric).name());
  stream.write(std::span(&view, 1)).bind(GL_UNIFORM_BUFFER, view_block);
  stream.write(std::span<const LimitUniforms>(limits)).bind(GL_SHADER_STORAGE_BUFFER, detail_limits_block);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, nodes_block, own.nodes.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, decisions_block, own.decisions.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, cell_radii_block, own.radii.name());
  glDispatchCompute(static_cast<GLuint>((own.cells.size() + group_size - 1) / group_size), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  decisions_.resize(own.cells.size());
  glGetNamedBufferSubData(own.decisions.name(), 0, static_cast<GLsizeiptr>(decisions_.size() * 4), decisions_.data());
  for (std::size_t n = 0; n < decisions_.size(); ++n)
    if (decisions_[n] & drawn_bit)
      out.cells.push_back({own.cells[n], own.levels[n], true, (decisions_[n] & morphing_bit) != 0});
}

}  // namespace lodestone
