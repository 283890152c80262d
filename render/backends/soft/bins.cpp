#include "render/backends/soft/bins.h"

#include "render/backends/soft/raster_types.h"

namespace lodestone::soft {

template <class T>
void Bins<T>::grow(List& list) {
  if (used_ == chunks_.size()) chunks_.push_back(std::make_unique_for_overwrite<Chunk>());
  Chunk* chunk = chunks_[used_++].get();
  chunk->previous = list.chunk;
  list = {chunk->items, chunk->items + run_items, chunk};
}

template class Bins<Fragment>;
template class Bins<TriangleRecord>;

}  // namespace lodestone::soft
