// Transparent surfaces of a tile (render/effects/transparency.h): what of them lies before the opaque ones, sorted by
// depth at each sample, shaded layer by layer from the front, and added up.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "render/backends/soft/geometry_stage.h"

namespace lodestone::soft {

// One for each worker and number of samples.
template <int Samples>
class TileLayers {
 public:
  // Finds, sorts, shades and adds up the layers of tile `number` in front of `opaque`; `job` is that of the transparent
  // surfaces. Null if there are none; else valid until the next call.
  LayerLight* draw(const Kernels& kernels, std::span<const GeometryStage::Workplace> workers, std::size_t number,
                   const TileBuffer<Samples>& opaque, const ResolveJob& job);
  // The light of no layers at all.
  LayerLight* none(const TileBuffer<Samples>& opaque);

 private:
  static constexpr std::size_t samples = TileBuffer<Samples>::samples;
  void collect(const Kernels& kernels, std::span<const GeometryStage::Workplace> workers, std::size_t number,
               PixelRect rect, const TileBuffer<Samples>& opaque);
  std::size_t sort();
  void put_layer(std::size_t rank);

  LayerList found_;
  std::vector<LayerItem> sorted_;                   // by sample, then from the front
  std::array<std::uint32_t, samples + 1> first_{};  // in sorted_, by sample
  TileBuffer<Samples> layer_;                       // one layer, as if it were opaque
  std::vector<float> planes_;                       // of light_
  LayerLight light_;
};

extern template class TileLayers<1>;
extern template class TileLayers<4>;

}  // namespace lodestone::soft
