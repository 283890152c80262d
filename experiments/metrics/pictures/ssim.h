// Structural similarity of two pictures (wang2004).
#pragma once

#include "parallel/scheduler/scheduler.h"
#include "render/frame/image.h"

namespace lodestone {

// Mean of the index over all places of an 11x11 window inside the picture, weighted by a Gaussian of sigma 1.5; K1 =
// 0.01, K2 = 0.03, of luma (0.299, 0.587, 0.114) in 0..255. In [-1, 1]; 1: equal. Throws InputError for pictures of
// different sizes or smaller than the window. The same bytes for any number of workers.
[[nodiscard]] double ssim(const Image& a, const Image& b, Scheduler& scheduler);

}  // namespace lodestone
