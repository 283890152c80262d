// A scene as plain data: models and their placements, lights and effects, the camera's path through it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/mesh/generate.h"
#include "render/camera/camera.h"
#include "render/camera/placement.h"
#include "render/effects/plan.h"
#include "render/frame/frame.h"
#include "render/lod/radii.h"

namespace lodestone {

// The point of a model that is put at SceneModel::position.
enum class Anchor : std::uint8_t {
  origin,  // its own origin
  centre,  // the middle of its bounds
  base,    // the middle of the lower side of its bounds, once it is turned
};

struct SceneModel {
  std::string name;  // for messages; unique in a scene
  // A hierarchy (.lode), or a mesh that is built when the scene is opened; or made instead of read.
  std::string file;
  std::optional<GenerateConfig> generate;
  bool fill_voids = false;  // of a height grid, as ReadConfig has it

  Vec3d position;
  Vec3d rotation;                // degrees about x, then y, then z
  double scale = 1;              // positive
  std::optional<double> extent;  // instead of a scale: the longest side of its bounds, once it is turned
  Anchor anchor = Anchor::origin;
  Appearance appearance;
  std::optional<Vec3f> colour;  // appearance.base_colour; without it the usual one
};

// The camera's path: one of the usual ones, a file of key frames, or keys of its own.
struct SceneCamera {
  std::string path = "orbit";  // orbit, wander; fly-in, walk (of a model); a file; empty: the keys
  std::string fly_to;          // fly-in, walk: name of the model; empty: the first
  std::vector<Camera> keys;
  int frames = 120;
};

struct Scene {
  std::vector<SceneModel> models;
  std::optional<UpAxis> up;  // empty: that of the first model
  FrameSettings settings;
  Vec3d towards_light{0.4, -0.5, 0.8};  // the directional light; any length but zero
  SceneCamera camera;
  EffectRequest effects;
  RadiiConfig radii;  // image size and field of view follow from the picture
  Blend blend = Blend::smoothstep;
};

// The placement from the normalised space of the model, with its transform and the bounds of its root, to the scene.
[[nodiscard]] Similarity placement_of(const SceneModel& model, const Hierarchy& hierarchy);

// A scene of one unmoved model, in units of its file.
[[nodiscard]] Scene scene_of(const std::string& file);

}  // namespace lodestone
