// A scene before a camera: makes a frame that a backend can draw from an opened scene and a camera.
//
// Radii, selections and effects are made anew when the camera, the picture or the models have changed, and only then: a
// camera at rest re-selects nothing, and draw() draws nothing again.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/hierarchy/model/signatures.h"
#include "render/camera/placement.h"
#include "render/culling/back_faces.h"
#include "render/culling/runs.h"
#include "render/frame/renderer.h"
#include "render/lod/resident_cells.h"
#include "render/scene/scene.h"

namespace lodestone {

// A model of the scene, opened. Both pointers outlive the view.
struct OpenModel {
  const Hierarchy* hierarchy = nullptr;   // drawn
  ResidentCells* resident = nullptr;      // when it is streamed: its hierarchy() is the one that is drawn
  const BackFaces* back_faces = nullptr;  // to cull cells that turn their backs, if backs cannot be seen
};

// The surface is drawn where dot(normal, point) >= offset, in the scene.
struct ClipPlane {
  Vec3d normal{0, 0, 1};
  double offset = 0;
  friend bool operator==(const ClipPlane&, const ClipPlane&) = default;
};

// The parameters of a view of a scene, besides the camera.
struct ViewConfig {
  ImageSize size;
  int samples = 1;
  RadiiConfig radii;  // image height, field of view and aspect are taken from size and camera
  Blend blend = Blend::smoothstep;
  FrameSettings settings;
  EffectRequest effects;
  Vec3d towards_light = Scene{}.towards_light;  // as Scene has it
  std::vector<bool> hidden;  // models that are left out, shadows included; those beyond its end are shown
  std::optional<ClipPlane> clip;
  std::vector<bool> closed;  // models whose cut by the plane is filled; those beyond its end are left open
  bool cull_occluded = false, select_on_device = false;  // as in Frame
  friend bool operator==(const ViewConfig&, const ViewConfig&) = default;
};
[[nodiscard]] ViewConfig view_config(const Scene& scene, ImageSize size);  // as the scene requests

class SceneView {
 public:
  // One opened model for each of the scene's. Throws InputError for a model without cells.
  SceneView(const Scene& scene, std::vector<OpenModel> models);

  // The hierarchies of the models, those that several share once: ModelFrame::model numbers them.
  [[nodiscard]] std::vector<const Hierarchy*> uploaded() const;
  // Sends them to a renderer: to be called once for each, before draw().
  void upload(Renderer& renderer);

  // Makes the frame of this camera. False when nothing has changed since the last call: then the frame is the same.
  // `beside`: other views of the same models from this camera, each drawn in its turn: streamed cells are loaded for
  // all of them.
  bool update(const Camera& camera, const ViewConfig& config, std::span<const ViewConfig> beside = {});
  // While frozen, update() keeps the cells of the last frame as they were selected, radii and viewpoint included, and
  // loads nothing: only the camera moves.
  void freeze(bool frozen);
  [[nodiscard]] const Frame& frame() const { return frame_; }
  // For streamed models: true if every model has all the detail that it needs; bytes in memory; the rate of a model's
  // limits, 0 for a model in memory as a whole.
  [[nodiscard]] bool complete() const;
  [[nodiscard]] std::uint64_t resident_bytes() const;
  [[nodiscard]] float limit_rate(std::size_t model) const;

  // Passes the changes by streaming on to the renderer, and draws the frame, unless nothing has changed since the last
  // picture of this view: then the statistics are empty.
  FrameStats draw(Renderer& renderer) { return draw(renderer, frame_); }
  // The same with a frame made of frame(), such as one that draws models in parts.
  FrameStats draw(Renderer& renderer, const Frame& frame);

  [[nodiscard]] const Scene& scene() const { return scene_; }
  [[nodiscard]] std::size_t model_count() const { return placed_.size(); }
  [[nodiscard]] const Hierarchy& hierarchy(std::size_t model) const { return *placed_[model].open.hierarchy; }
  [[nodiscard]] const Similarity& placement(std::size_t model) const { return placed_[model].placement; }
  [[nodiscard]] const Radii& radii(std::size_t model) const { return placed_[model].radii; }
  [[nodiscard]] bool admissible() const;
  [[nodiscard]] Sphere bounding_sphere() const;        // of all models
  [[nodiscard]] Vec3d up() const;                      // a unit vector
  [[nodiscard]] double unit() const { return unit_; }  // scene lengths of one unit of clip w

 private:
  struct Placed {
    OpenModel open;
    std::uint32_t uploaded = 0;  // its number among those uploaded
    Similarity placement;        // of normalised model space, in the scene
    Similarity in_picture;       // the same in units of the picture, whose origin lies with the models
    Appearance appearance;
    std::shared_ptr<const Signatures> signatures;  // for adaptive radii
    Radii radii;
    std::optional<RadiiConfig> radii_config;  // that the radii were made by
    std::vector<DetailLimit> limits;          // of the frame
    std::uint64_t revision = 0;               // of the streamed cells in it
    std::vector<CellId> went, came;           // families that the renderer has yet to lose and to get
    Selection selection, casters;
    CullingRuns runs;
    std::vector<TriangleRange> ranges, caster_ranges;  // of the selections
  };
  void place_models();
  void set_radii(Placed& placed, const RadiiConfig& config);
  [[nodiscard]] bool is_hidden(std::size_t model) const {
    return model < config_.hidden.size() && config_.hidden[model];
  }
  void select(const ModelFrame& model, Placed& placed, bool hidden);
  void see_from_light();
  [[nodiscard]] bool stream(Placed& placed, const ModelFrame& model, const Camera& camera,
                            std::span<const ViewConfig> beside);

  Scene scene_;
  std::vector<Placed> placed_;
  Vec3d origin_;
  double unit_ = 1;

  std::optional<Camera> camera_;
  ViewConfig config_;
  Frame frame_;
  bool changed_ = false;  // since the last picture
  bool frozen_ = false;
};

// The camera path of the scene, for pictures of this size. Throws as read_camera_path does.
[[nodiscard]] std::vector<Camera> camera_path(const SceneView& view, ImageSize size);

}  // namespace lodestone
