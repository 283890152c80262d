// Colours a picture by lambda: shows vertices on their way to their parents' positions.
//
// One distance tells it. In a band (a_l, r_{l-1}) every vertex at that distance belongs to a drawn cell of level l: its
// parent's box holds it and so is nearer than r_{l-1}, and no point of its own box is farther from it than rho_l h_l,
// so that the box is at least r_l away (docs/architecture.md, section 5). The pixel's own position is used for the
// vertex, an error of the displacement of the morph, at most sigma0 h_l / 2.
//
// With adaptive radii it is the lambda of the vertices that no other cell uses, in the drawn cell whose box holds the
// point; where boxes overlap, the first one in the order of the cells decides.
#pragma once

#include <optional>

#include "parallel/scheduler/scheduler.h"
#include "render/frame/frame.h"
#include "render/frame/image.h"

namespace lodestone::viewer {

// lambda at p, in the band that contains it; empty outside all bands, and where nothing moves.
[[nodiscard]] std::optional<float> band_lambda(const MorphContext& morph, Vec3f p);

// The colour of lambda in [0, 1], each channel in [0, 1].
[[nodiscard]] Vec3f band_colour(float lambda);

// Mixes the colour of the band into the picture: blue where the band begins (lambda = 1), orange where it ends. Pixels
// of the background and outside the bands keep their colour. `image` is the picture of the frame, with depth. If the
// bounds of several models cover a pixel, the first one in a band decides.
void tint_band(Image& image, const Frame& frame, Scheduler& scheduler);

}  // namespace lodestone::viewer
