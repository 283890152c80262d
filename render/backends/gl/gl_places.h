// Where cells lie in the buffers of the device. Knows no OpenGL.
//
// A storage block holds at most what the driver says (128 MiB on llvmpipe, some 11 million positions), so that a larger
// hierarchy takes several *groups* of buffers. What comes and goes is a *family*, the children of one cell. A vertex
// shader reads the parent's vertices too: a family brings a copy of them along, first, and can lie anywhere.
//
// Rejected: the parent's position stored with every vertex (12 more bytes per vertex instead of 4 on average), and
// families placed in the group of their parent (nothing could be moved, and holes could not be filled).
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "render/backends/gl/range_allocator.h"

namespace lodestone {

// Where a cell is found, in the vertices and indices of its group.
struct CellPlace {
  std::uint32_t group = 0;
  std::uint32_t first_vertex = 0, parent_first_vertex = 0;
  std::uint32_t first_index = 0;
};

// Slots of a group: vertices, and indices, three a triangle.
struct GroupSize {
  std::uint64_t vertices = 0, indices = 0;
};

struct FamilyPlace {
  std::uint32_t group = 0;
  std::uint64_t first_vertex = 0, first_index = 0;  // the parent's copy begins at first_vertex
  GroupSize size;
};

// The children of one cell of one model; parent no_cell: its root.
struct FamilyId {
  std::uint32_t model = 0, parent = no_cell;
  friend bool operator==(const FamilyId&, const FamilyId&) = default;
};

class GlPlaces {
 public:
  // For these models. Those with the same attributes share groups, and no group has attributes that its models lack.
  // No group has more than `max_vertices`. `expected` is what all families of each model may take together, or empty:
  // the first groups are made that large, as far as they may; what comes beyond doubles the room there is.
  GlPlaces(std::vector<const Hierarchy*> models, std::uint64_t max_vertices, const std::vector<GroupSize>& expected);

  // A place for a family whose arrays are there. A new group is appended to groups() when no other has room. Throws
  // ResourceError when the family exceeds the largest group.
  const FamilyPlace& add(FamilyId family);
  void remove(FamilyId family);

  [[nodiscard]] const CellPlace& place(std::uint32_t model, std::uint32_t cell) const { return places_[model][cell]; }
  [[nodiscard]] const std::vector<GroupSize>& groups() const { return groups_; }
  [[nodiscard]] AttributeSet attributes(std::uint32_t group) const { return kinds_[rooms_[group].kind].attributes; }

  // What a family takes, the copy of its parent included.
  [[nodiscard]] static GroupSize family_size(const Hierarchy& hierarchy, std::uint32_t parent);

 private:
  struct Kind {
    AttributeSet attributes;
    GroupSize expected;
  };
  struct Room {
    RangeAllocator vertices, indices;
    std::size_t kind = 0;
  };
  [[nodiscard]] FamilyPlace find_room(GroupSize size, std::size_t kind);
  [[nodiscard]] GroupSize next_group(std::size_t kind) const;

  struct FamilyHash {
    std::size_t operator()(FamilyId f) const {
      return std::hash<std::uint64_t>{}((std::uint64_t{f.model} << 32) | f.parent);
    }
  };

  std::vector<const Hierarchy*> models_;
  std::vector<Kind> kinds_;
  std::vector<std::size_t> kind_of_model_;
  GroupSize largest_;
  std::vector<GroupSize> groups_;
  std::vector<Room> rooms_;                     // of the groups
  std::vector<std::vector<CellPlace>> places_;  // by model, of all cells; of those that are there
  std::unordered_map<FamilyId, FamilyPlace, FamilyHash> families_;
};

}  // namespace lodestone
