// The overdraw of a tile (render/effects/overdraw.h).
#pragma once

#include <cstdint>
#include <span>

#include "render/backends/soft/geometry_stage.h"
#include "render/frame/image.h"

namespace lodestone::soft {

// Counts the triangles of tile `tile`, as the workers' lists have them for one sample a pixel, and puts their colours
// into the picture. Returns the sum of the counts.
std::uint64_t draw_overdraw(const Kernels& kernels, std::span<const GeometryStage::Workplace> workers, std::size_t tile,
                            PixelRect rect, Vec3f background, Image& image);

}  // namespace lodestone::soft
