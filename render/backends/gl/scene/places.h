// Places of cells in the buffers of the device, independent of OpenGL.
//
// A storage block holds at most what the driver allows (128 MiB on llvmpipe, some 11 million positions), so that a
// larger hierarchy takes several *groups* of buffers. The unit that is added and removed is a *family*, the children of
// one cell. A vertex shader reads the parent's vertices, too: a family begins with a copy of them, and can be placed
// anywhere.
//
// Rejected: the parent's position stored with every vertex (12 more bytes per vertex instead of 4 on average), and
// families placed in the group of their parent (nothing could be moved, and holes could not be filled).
#pragma once

#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"

namespace lodestone {

// The place of a cell among the vertices and indices of its group.
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
  std::uint32_t model = 0;
  CellId parent = no_cell;
  friend bool operator==(const FamilyId&, const FamilyId&) = default;
};

// Ranges of a row of numbered slots, given out and taken back: first fit, neighbours merged.
class RangeAllocator {
 public:
  explicit RangeAllocator(std::uint64_t slots) : free_slots_(slots) {
    if (slots > 0) free_.emplace(0, slots);
  }

  // The first of `count` consecutive free slots, which are no longer free; nothing when there are none. count = 0: 0.
  [[nodiscard]] std::optional<std::uint64_t> allocate(std::uint64_t count) {
    if (count == 0) return 0;
    for (auto range = free_.begin(); range != free_.end(); ++range) {
      const auto [first, length] = *range;
      if (length < count) continue;
      free_.erase(range);
      if (length > count) free_.emplace(first + count, length - count);
      free_slots_ -= count;
      return first;
    }
    return std::nullopt;
  }

  // Takes back a range as it was given out.
  void release(std::uint64_t first, std::uint64_t count) {
    if (count == 0) return;
    auto range = free_.emplace(first, count).first;
    free_slots_ += count;
    if (const auto next = std::next(range); next != free_.end() && range->first + range->second == next->first) {
      range->second += next->second;
      free_.erase(next);
    }
    if (range == free_.begin()) return;
    if (const auto previous = std::prev(range); previous->first + previous->second == range->first) {
      previous->second += range->second;
      free_.erase(range);
    }
  }

  [[nodiscard]] std::uint64_t free_slots() const { return free_slots_; }

 private:
  std::map<std::uint64_t, std::uint64_t> free_;  // first slot, length
  std::uint64_t free_slots_;
};

class GlPlaces {
 public:
  // Models with the same attributes share groups, and no group has attributes that its models lack. No group has more
  // than `max_vertices`. `expected` is what all families of each model may take together, or empty: the first groups
  // are made that large, if allowed; further ones double the room there is.
  GlPlaces(std::vector<const Hierarchy*> models, std::uint64_t max_vertices, const std::vector<GroupSize>& expected);

  // A place for a family whose arrays are loaded. A new group is appended to groups() when no other has room. Throws
  // ResourceError when the family exceeds the largest group.
  const FamilyPlace& add(FamilyId family);
  void remove(FamilyId family);

  [[nodiscard]] const CellPlace& place(std::uint32_t model, CellId cell) const { return places_[model][cell]; }
  // Those that have a place, of all models.
  [[nodiscard]] std::vector<FamilyId> families() const;
  [[nodiscard]] const std::vector<GroupSize>& groups() const { return groups_; }
  [[nodiscard]] AttributeSet attributes(std::uint32_t group) const { return kinds_[rooms_[group].kind].attributes; }

  // Slots that a family takes, the copy of its parent included.
  [[nodiscard]] static GroupSize family_size(const Hierarchy& hierarchy, CellId parent);

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
  std::vector<std::vector<CellPlace>> places_;  // by model, of all cells; valid for those on the device
  std::unordered_map<FamilyId, FamilyPlace, FamilyHash> families_;
};

}  // namespace lodestone
