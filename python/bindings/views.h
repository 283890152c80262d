// One hierarchy before a camera, as `lodestone render` sees it.
#pragma once

#include "python/bindings/bind.h"
#include "render/scene/scene_view.h"

namespace lodestone::python {

// Takes size: (width, height) of the picture.
[[nodiscard]] ImageSize take_size(Options& options);
// Takes size, samples, effects, tint, radii, metric, kappa0, pixel_error, beta, delta and blend.
[[nodiscard]] ViewConfig take_view(Options& options);

// The hierarchy must outlive the view.
[[nodiscard]] SceneView view_of_model(const Model& model);

}  // namespace lodestone::python
