// Growing lists, one per tile, in memory that is used again from frame to frame.
//
// Every worker has lists of its own and appends without locks. Which worker found what depends on timing; the depth
// test that reads the lists does not depend on their order (tile_buffer.h), so the picture does not either.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace lodestone::soft {

template <class T>
class Bins {
 public:
  // Maximum number of items that follow each other in memory.
  static constexpr std::size_t run_items = 4096 / sizeof(T);

  // Empties all lists; `count` of them from now on. Keeps the memory.
  void reset(std::size_t count) {
    lists_.assign(count, {});
    used_ = 0;
  }

  [[gnu::always_inline]] void push(std::size_t list, const T& item) {
    List& l = lists_[list];
    if (l.next == l.end) [[unlikely]]
      grow(l);
    *l.next++ = item;
  }

  // The place of the list's next item; null for an empty list. It changes as soon as something is appended.
  [[nodiscard]] const T* end_of(std::size_t list) const { return lists_[list].next; }

  // Calls visit(first, last) for runs of the list's items, in no particular order of runs.
  template <class Visit>
  void for_each_run(std::size_t list, const Visit& visit) const {
    const T* last = lists_[list].next;
    for (const Chunk* chunk = lists_[list].chunk; chunk; chunk = chunk->previous) {
      visit(static_cast<const T*>(chunk->items), last);
      if (chunk->previous) last = chunk->previous->items + run_items;
    }
  }

 private:
  struct Chunk {
    T items[run_items];
    Chunk* previous;
  };
  struct List {
    T *next = nullptr, *end = nullptr;
    Chunk* chunk = nullptr;
  };

  void grow(List& list);  // in bins.cpp: one copy, whatever instruction set the caller is compiled for

  std::vector<List> lists_;
  std::vector<std::unique_ptr<Chunk>> chunks_;
  std::size_t used_ = 0;
};

}  // namespace lodestone::soft
