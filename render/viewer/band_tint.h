// Colours a picture by lambda: where vertices are on their way to their parents' places.
//
// One distance tells it. In a band (a_l, r_{l-1}) every vertex at that distance belongs to a drawn cell of level l: its
// parent's box holds it and so is nearer than r_{l-1}, and no point of its own box is farther from it than rho_l h_l,
// so that the box is at least r_l away (docs/architecture.md, section 5). The pixel's own place stands for the vertex,
// which is off by the displacement of the morph, at most sigma0 h_l / 2.
#pragma once

#include <optional>

#include "parallel/scheduler/scheduler.h"
#include "render/frame/frame.h"
#include "render/frame/image.h"

namespace lodestone::viewer {

// lambda of what stands at p, in the band it is in; empty outside all bands.
[[nodiscard]] std::optional<float> band_lambda(const MorphContext& morph, Vec3f p);

// Mixes the colour of the band into what is seen: blue where the band begins (lambda = 1), orange where it ends. The
// background and what stands still keep their colour. `image` is the picture of the frame, with depth. Where several
// models could be seen at a pixel, judging by their bounds, the first one in a band tells.
void tint_band(Image& image, const Frame& frame, Scheduler& scheduler);

}  // namespace lodestone::viewer
