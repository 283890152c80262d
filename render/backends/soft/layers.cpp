#include "render/backends/soft/layers.h"

#include <algorithm>
#include <tuple>

namespace lodestone::soft {

void LayerList::grow() {
  items_.resize(std::max<std::size_t>(2 * items_.size(), 4096));
  data = items_.data();
  room = items_.size();
}

template <int Samples>
LayerLight* TileLayers<Samples>::draw(const Kernels& kernels, std::span<const GeometryStage::Workplace> workers,
                                      std::size_t number, const TileBuffer<Samples>& opaque, const ResolveJob& job) {
  collect(kernels, workers, number, job.rect, opaque);
  if (found_.count == 0) return nullptr;
  const std::size_t layers = sort();
  (void)none(opaque);
  for (std::size_t rank = 0; rank < layers; ++rank) {
    put_layer(rank);
    kernels.of<Samples>().shade_layer(job, layer_, light_);
  }
  return &light_;
}

template <int Samples>
LayerLight* TileLayers<Samples>::none(const TileBuffer<Samples>& opaque) {
  planes_.assign(7 * samples, 0);
  const auto plane = [&](std::size_t k) { return &planes_[k * samples]; };
  light_ = {plane(0), plane(1), plane(2), plane(3), plane(4), plane(5), plane(6)};
  std::fill_n(light_.through, samples, 1.0f);
  std::fill_n(light_.seen, samples, 1.0f);
  std::fill_n(light_.first, samples, 1.0f);
  std::ranges::copy(opaque.depth, light_.depth);
  return &light_;
}

template <int Samples>
void TileLayers<Samples>::collect(const Kernels& kernels, std::span<const GeometryStage::Workplace> workers,
                                  std::size_t number, PixelRect rect, const TileBuffer<Samples>& opaque) {
  found_.count = 0;
  layer_.sources = {};
  for (const GeometryStage::Workplace& w : workers) {
    w.bins.fragments.for_each_run(number, [&](const Fragment* first, const Fragment* last) {
      std::uint32_t own = Reference::first_of_run(layer_.sources.fragment_runs.size());
      layer_.sources.fragment_runs.push_back(first);
      for (const Fragment* f = first; f != last; ++f, ++own)
        if (f->z < opaque.depth[f->sample]) found_.push({f->sample, f->z, f->triangle, own});
    });
    w.bins.triangles.for_each_run(number, [&](const TriangleRecord* first, const TriangleRecord* last) {
      const std::uint32_t own = Reference::record_bit | Reference::first_of_run(layer_.sources.record_runs.size());
      layer_.sources.record_runs.push_back(first);
      kernels.of<Samples>().collect_layers(first, last, rect, opaque, own, found_);
    });
  }
}

// The place where an item was found depends on timing; the order is total, so that the result does not. Returns the
// largest number of layers over a sample.
template <int Samples>
std::size_t TileLayers<Samples>::sort() {
  first_.fill(0);
  for (std::size_t k = 0; k < found_.count; ++k) ++first_[found_.data[k].sample + 1];
  std::uint32_t most = 0;
  for (std::size_t s = 0; s < samples; ++s) {
    most = std::max(most, first_[s + 1]);
    first_[s + 1] += first_[s];
  }
  sorted_.resize(found_.count);
  for (std::size_t k = found_.count; k-- > 0;) sorted_[--first_[found_.data[k].sample + 1]] = found_.data[k];
  // first_[s + 1] is where s begins by now.
  std::copy(first_.begin() + 1, first_.end(), first_.begin());
  first_[samples] = static_cast<std::uint32_t>(found_.count);
  const auto key = [](const LayerItem& i) { return std::tuple(i.z, i.triangle); };
  for (std::size_t s = 0; s < samples; ++s)
    if (first_[s + 1] - first_[s] > 1)
      std::sort(&sorted_[first_[s]], sorted_.data() + first_[s + 1],
                [&](const LayerItem& a, const LayerItem& b) { return key(a) < key(b); });
  return most;
}

template <int Samples>
void TileLayers<Samples>::put_layer(std::size_t rank) {
  for (std::size_t s = 0; s < samples; ++s) {
    const std::size_t at = first_[s] + rank;
    const bool there = at < first_[s + 1] && sorted_[at].z < light_.depth[s];  // not behind a masked surface
    layer_.depth[s] = there ? sorted_[at].z : 1;
    layer_.reference[s] = there ? sorted_[at].reference : 0;
  }
}

template class TileLayers<1>;
template class TileLayers<4>;

}  // namespace lodestone::soft
