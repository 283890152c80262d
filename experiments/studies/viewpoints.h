// Viewpoints of a model: camera paths, and viewpoints that are hard on a level of detail.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "experiments/studies/experiment.h"
#include "experiments/studies/verdict.h"
#include "render/camera/camera.h"
#include "render/lod/radii.h"

namespace lodestone {

struct Shot {
  Camera camera;
  bool follows = false;  // the shot before is a small step away: pops are measured between the two
};

// "frames", and the part of a path that they are spread over, "from" and "to".
[[nodiscard]] std::vector<ParameterInfo> path_parameters();
// The part has to have a length.
void check_path(SettingVerdict& verdict, const Parameters& parameters);
// "camera": the name of a path (render/camera/camera.h), one of `more` names, or the file of a recorded path, as
// `render --camera` takes it.
[[nodiscard]] ParameterInfo camera_parameter(const std::string& description, std::vector<std::string> more = {});
// Cameras of the path that "camera" names, or of its file. Throws what read_camera_path throws.
[[nodiscard]] std::vector<Camera> path_cameras(const Hierarchy& hierarchy, const Parameters& parameters);

// "camera" (a path, random, adversarial, or a file), "step", "seed", and those of a path.
[[nodiscard]] std::vector<ParameterInfo> viewpoint_parameters();
void check_viewpoints(SettingVerdict& verdict, const Parameters& parameters);

// A path or a file: its frames, each following the one before.
// random: pairs of viewpoints a step apart, spread evenly over directions, and between 1.1 and 8 radii of the bounding
// sphere in the logarithm of the distance, looking at a point within its inner half.
// adversarial: pairs on both sides of the exchange of a cell, where inadmissible radii crack first
// (metrics/adversary.h). Throws InputError when there are no adversarial viewpoints.
[[nodiscard]] std::vector<Shot> viewpoints(const Hierarchy& hierarchy, const Radii& radii,
                                           const Parameters& parameters);

}  // namespace lodestone
