#include "experiments/systems/surface/patch_hierarchy.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace lodestone {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t short_range = 1u << 16;

}  // namespace

PatchHierarchy::PatchHierarchy(const Hierarchy& model) {
  hierarchy_.transform = model.transform;
  hierarchy_.materials = model.materials;
  hierarchy_.provenance = model.provenance;
  hierarchy_.levels.resize(1);
  hierarchy_.levels.front().cell_count = 1;
  hierarchy_.cells.resize(1);
  hierarchy_.cells.front().bounds = model.cells.front().bounds;
}

// Arrays of cells that were removed are used again.
PatchHierarchy::Payload& PatchHierarchy::next_payload() {
  if (used_ == payloads_.size()) payloads_.emplace_back();
  Payload& payload = payloads_[used_++];
  payload.positions.clear(), payload.normals.clear(), payload.indices.clear(), payload.triangles.clear();
  return payload;
}

// Vectors keep their arrays in place where the list of payloads grows.
CellId PatchHierarchy::add_cell(const Payload& payload) {
  Cell cell;
  for (const Vec3f p : payload.positions) cell.bounds.extend(p);
  cell.positions = payload.positions, cell.normals = payload.normals;
  cell.triangles = payload.triangles.empty() ? Triangles(std::span<const std::uint16_t>(payload.indices))
                                             : Triangles(payload.triangles);
  Level& level = hierarchy_.levels.front();
  ++level.cell_count, level.triangles += cell.triangles.size(), level.vertices += cell.positions.size();
  hierarchy_.cells.push_back(std::move(cell));
  return CellId(static_cast<std::uint32_t>(hierarchy_.cells.size() - 1));
}

CellId PatchHierarchy::add(const PatchMesh& mesh) {
  Payload& payload = next_payload();
  payload.positions.assign(mesh.positions.begin(), mesh.positions.end());
  payload.normals.assign(mesh.normals.begin(), mesh.normals.end());
  if (mesh.positions.size() > short_range) {
    payload.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
  } else {
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t.v) payload.indices.push_back(static_cast<std::uint16_t>(v));
  }
  return add_cell(payload);
}

void PatchHierarchy::clear() {
  hierarchy_.cells.resize(1);
  hierarchy_.levels.front() = {};
  hierarchy_.levels.front().cell_count = 1;
  used_ = 0;
}

std::vector<CellId> PatchHierarchy::remake(const PatchMesh& mesh, std::size_t run) {
  clear();
  number_.assign(mesh.positions.size(), none);
  std::vector<CellId> cells;
  std::vector<std::uint32_t> seen;
  for (std::size_t begin = 0; begin < mesh.triangles.size(); begin += run) {
    Payload& payload = next_payload();
    seen.clear();
    for (const Triangle& t : mesh.triangles.subspan(begin, std::min(run, mesh.triangles.size() - begin)))
      for (const std::uint32_t v : t.v) {
        if (number_[v] == none) {
          number_[v] = static_cast<std::uint32_t>(seen.size());
          seen.push_back(v);
          payload.positions.push_back(mesh.positions[v]);
          payload.normals.push_back(mesh.normals[v]);
        }
        payload.indices.push_back(static_cast<std::uint16_t>(number_[v]));
      }
    for (const std::uint32_t v : seen) number_[v] = none;
    cells.push_back(add_cell(payload));
  }
  return cells;
}

}  // namespace lodestone
