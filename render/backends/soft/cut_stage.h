// Cuts of solids (render/effects/cut_face.h): found from the fronts and backs of each solid that its plane keeps, put
// before the surfaces of a tile as an opaque layer.
#pragma once

#include <array>
#include <vector>

#include "render/backends/soft/geometry_stage.h"
#include "render/effects/cut_face.h"

namespace lodestone::soft {

class CutStage {
 public:
  CutStage(Scheduler& scheduler, const Kernels& kernels)
      : scheduler_(scheduler), kernels_(kernels), fronts_(scheduler, kernels), backs_(scheduler, kernels) {}

  // Finds the nearest cut at each sample of the frame, which must outlive its pictures; false if there is none.
  bool find(const Frame& frame);

  // Moves the surfaces of tile `number` up to the cuts in front of them; false if there are none.
  template <int Samples>
  bool put_depth(std::size_t number, TileBuffer<Samples>& tile) const;
  // Adds the light of these cuts behind that of the layers.
  template <int Samples>
  void put_light(std::size_t number, const TileBuffer<Samples>& tile, const LayerLight& light) const;

 private:
  template <int Samples>
  void find(std::uint8_t number);

  Scheduler& scheduler_;
  const Kernels& kernels_;
  GeometryStage fronts_, backs_;  // of one solid at a time
  const Frame* frame_ = nullptr;
  std::vector<effects::CutFace> faces_;
  // Tile by tile, in the order of TileBuffer: depth, 1 where there is none, and the number of the face.
  std::vector<float> depth_;
  std::vector<std::uint8_t> face_;
};

}  // namespace lodestone::soft
