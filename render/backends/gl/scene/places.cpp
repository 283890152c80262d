#include "render/backends/gl/scene/places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_payload.h"

namespace lodestone {
namespace {

// Draw commands count indices in 32 bits; the shader computes 3 * vertex in 32 bits, and base vertices are signed.
constexpr std::uint64_t max_indices = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t addressable_vertices = 0x7fff'ffffu / 3;

// Size of groups that are made before their families are known: 2.5 MB.
constexpr GroupSize least_group{1 << 16, 6 << 16};

std::uint64_t vertices_of_parent(const Hierarchy& hierarchy, CellId parent) {
  return parent == no_cell ? 0 : hierarchy.cells[parent].positions.size();
}

// Returns at most the largest number of vertices, with their share of the indices.
GroupSize cut(GroupSize wanted, GroupSize largest) {
  const double share = std::min(1.0, static_cast<double>(largest.vertices) / static_cast<double>(wanted.vertices));
  const auto indices = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(wanted.indices)));
  return {std::min(wanted.vertices, largest.vertices), std::min(indices, largest.indices)};
}
GroupSize sum(GroupSize a, GroupSize b) { return {a.vertices + b.vertices, a.indices + b.indices}; }
GroupSize larger(GroupSize a, GroupSize b) {
  return {std::max(a.vertices, b.vertices), std::max(a.indices, b.indices)};
}

}  // namespace

GlPlaces::GlPlaces(std::vector<const Hierarchy*> models, std::uint64_t max_vertices,
                   const std::vector<GroupSize>& expected)
    : models_(std::move(models)), largest_{std::min(max_vertices, addressable_vertices), max_indices} {
  for (std::size_t m = 0; m < models_.size(); ++m) {
    places_.emplace_back(models_[m]->cells.size());
    AttributeSet attributes = models_[m]->attributes;
    attributes.wedges = false;  // nothing of their own
    auto kind = std::ranges::find(kinds_, attributes, &Kind::attributes);
    if (kind == kinds_.end()) kind = kinds_.insert(kind, {attributes, {}});
    kind_of_model_.push_back(static_cast<std::size_t>(kind - kinds_.begin()));
    if (m < expected.size()) kind->expected = sum(kind->expected, expected[m]);
  }
}

GroupSize GlPlaces::family_size(const Hierarchy& hierarchy, CellId parent) {
  GroupSize size{vertices_of_parent(hierarchy, parent), 0};
  const FamilyCells range = family_cells(hierarchy, parent);
  for (CellId c = range.begin; c < range.end; ++c) {
    size.vertices += hierarchy.cells[c].positions.size();
    size.indices += 3 * hierarchy.cells[c].triangles.size();
  }
  return size;
}

const FamilyPlace& GlPlaces::add(FamilyId id) {
  const Hierarchy& hierarchy = *models_[id.model];
  const FamilyPlace family = find_room(family_size(hierarchy, id.parent), kind_of_model_[id.model]);
  std::uint64_t vertex = family.first_vertex + vertices_of_parent(hierarchy, id.parent), index = family.first_index;
  const FamilyCells range = family_cells(hierarchy, id.parent);
  for (CellId c = range.begin; c < range.end; ++c) {
    places_[id.model][c] = {family.group, static_cast<std::uint32_t>(vertex),
                            static_cast<std::uint32_t>(family.first_vertex), static_cast<std::uint32_t>(index)};
    vertex += hierarchy.cells[c].positions.size();
    index += 3 * hierarchy.cells[c].triangles.size();
  }
  return families_[id] = family;
}

std::vector<FamilyId> GlPlaces::families() const {
  std::vector<FamilyId> all;
  for (const auto& [id, family] : families_) all.push_back(id);
  return all;
}

void GlPlaces::remove(FamilyId id) {
  const FamilyPlace& family = families_.at(id);
  rooms_[family.group].vertices.release(family.first_vertex, family.size.vertices);
  rooms_[family.group].indices.release(family.first_index, family.size.indices);
  families_.erase(id);
}

// The next group is as large as all families are expected to be, or doubles the room there is.
GroupSize GlPlaces::next_group(std::size_t kind) const {
  if (kinds_[kind].expected.vertices > 0) return kinds_[kind].expected;
  GroupSize wanted = least_group;
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (rooms_[g].kind == kind) wanted = sum(wanted, groups_[g]);
  return wanted;
}

FamilyPlace GlPlaces::find_room(GroupSize size, std::size_t kind) {
  if (size.vertices > largest_.vertices || size.indices > largest_.indices)
    throw ResourceError(describe("", "OpenGL",
                                 "a cell's children and their parent exceed a storage block of " +
                                     std::to_string(largest_.vertices) + " vertices",
                                 "build with smaller cells or use --backend soft"));
  for (std::uint32_t g = 0; g < groups_.size(); ++g) {
    Room& room = rooms_[g];
    if (room.kind != kind) continue;
    const std::optional<std::uint64_t> vertex = room.vertices.allocate(size.vertices);
    if (!vertex) continue;
    if (const std::optional<std::uint64_t> index = room.indices.allocate(size.indices))
      return {g, *vertex, *index, size};
    room.vertices.release(*vertex, size.vertices);
  }
  groups_.push_back(larger(size, cut(next_group(kind), largest_)));
  GroupSize& expected = kinds_[kind].expected;
  expected = {expected.vertices - std::min(expected.vertices, groups_.back().vertices),
              expected.indices - std::min(expected.indices, groups_.back().indices)};
  rooms_.push_back({RangeAllocator(groups_.back().vertices), RangeAllocator(groups_.back().indices), kind});
  return {static_cast<std::uint32_t>(groups_.size() - 1), *rooms_.back().vertices.allocate(size.vertices),
          *rooms_.back().indices.allocate(size.indices), size};
}

}  // namespace lodestone
