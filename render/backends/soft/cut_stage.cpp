#include "render/backends/soft/cut_stage.h"

#include <algorithm>

namespace lodestone::soft {
namespace {

// A place in a picture, in pixels from the upper left corner.
struct PicturePoint {
  double x = 0, y = 0;
};
template <int Samples>
PicturePoint point_of(std::size_t sample, PixelRect rect) {
  const SnappedPoint offset = sample_offsets<Samples>[sample / tile_pixels];
  const std::size_t pixel = sample % tile_pixels;
  return {rect.x0 + static_cast<double>(pixel % tile_size) + 0.5 + offset.x / double{subpixels},
          rect.y0 + static_cast<double>(pixel / tile_size) + 0.5 + offset.y / double{subpixels}};
}

float depth_at(const effects::CutFace& face, PicturePoint at) {
  return static_cast<float>(face.depth[0] * at.x + face.depth[1] * at.y + face.depth[2]);
}

}  // namespace

bool CutStage::find(const Frame& frame) {
  frame_ = &frame;
  faces_ = effects::cut_faces(frame);
  // Pictures of more solids than a byte can number are not worth another byte a sample.
  faces_.resize(std::min<std::size_t>(faces_.size(), 256));
  if (faces_.empty()) return false;
  const std::size_t samples = TileGrid(frame.size).count() * tile_pixels * static_cast<std::size_t>(frame.samples);
  depth_.assign(samples, 1);
  face_.resize(samples);
  for (std::size_t k = 0; k < faces_.size(); ++k) {
    if (frame.samples == 1) {
      find<1>(static_cast<std::uint8_t>(k));
    } else {
      find<4>(static_cast<std::uint8_t>(k));
    }
  }
  return true;
}

template <int Samples>
void CutStage::find(std::uint8_t number) {
  const effects::CutFace& face = faces_[number];
  GeometryPass pass;
  pass.models = {{face.model}};
  pass.selection = &ModelFrame::solid;
  pass.size = frame_->size;
  pass.side = ShownSide::front;
  fronts_.run(pass, Samples);
  pass.side = ShownSide::back;
  backs_.run(pass, Samples);
  const TileGrid grid(frame_->size);
  constexpr std::size_t samples = TileBuffer<Samples>::samples;
  scheduler_.for_chunks(grid.count(), 1, [&](ChunkRange range) {
    const PixelRect rect = grid.rect(range.begin);
    alignas(64) std::array<std::int32_t, samples> fronts{}, backs{};
    count_tile<Samples>(kernels_, fronts_.workers(), range.begin, rect, fronts.data());
    count_tile<Samples>(kernels_, backs_.workers(), range.begin, rect, backs.data());
    for (std::size_t s = 0; s < samples; ++s) {
      if (fronts[s] == backs[s]) continue;
      const float z = depth_at(face, point_of<Samples>(s, rect));
      float& nearest = depth_[range.begin * samples + s];
      if (!(z >= 0 && z < nearest)) continue;
      nearest = z;
      face_[range.begin * samples + s] = number;
    }
  });
}

template <int Samples>
bool CutStage::put_depth(std::size_t number, TileBuffer<Samples>& tile) const {
  const float* const depth = &depth_[number * TileBuffer<Samples>::samples];
  bool any = false;
  for (std::size_t s = 0; s < TileBuffer<Samples>::samples; ++s)
    if (depth[s] < tile.depth[s] && tile.depth[s] < 1) {  // some triangle of the solid is there, and known
      tile.depth[s] = depth[s];
      any = true;
    }
  return any;
}

template <int Samples>
void CutStage::put_light(std::size_t number, const TileBuffer<Samples>& tile, const LayerLight& light) const {
  const std::size_t first = number * TileBuffer<Samples>::samples;
  const PixelRect rect = TileGrid(frame_->size).rect(number);
  for (std::size_t s = 0; s < TileBuffer<Samples>::samples; ++s) {
    const float z = depth_[first + s];
    if (!(z < 1 && z == tile.depth[s])) continue;
    const auto [x, y] = point_of<Samples>(s, rect);
    const Vec3f colour = effects::cut_colour(faces_[face_[first + s]], *frame_, x, y, z);
    const float share = light.through[s];
    light.red[s] += share * colour.x, light.green[s] += share * colour.y, light.blue[s] += share * colour.z;
    light.through[s] = 0;
  }
}

template bool CutStage::put_depth<1>(std::size_t, TileBuffer<1>&) const;
template bool CutStage::put_depth<4>(std::size_t, TileBuffer<4>&) const;
template void CutStage::put_light<1>(std::size_t, const TileBuffer<1>&, const LayerLight&) const;
template void CutStage::put_light<4>(std::size_t, const TileBuffer<4>&, const LayerLight&) const;

}  // namespace lodestone::soft
