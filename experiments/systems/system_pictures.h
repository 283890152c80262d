// Pictures of a scene by each of the compared systems, and what they were made of, for the metrics.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/systems/lod_system.h"
#include "parallel/scheduler/clock.h"
#include "render/frame/renderer.h"
#include "render/scene/scene_view.h"

namespace lodestone {

struct SystemConfig {
  double fade_width = 0.25;  // of systems that fade, as a share of the radius at which a level becomes good enough
};

// A model of the scene as a system drew it, before culling; of several parts the first.
struct SystemModel {
  const Hierarchy* hierarchy = nullptr;
  Radii radii;  // that made the system of it
  Radii morph;  // those of the scene
  Blend blend = Blend::smoothstep;
  Vec3f viewpoint;
  Selection whole;                 // a partition (keep_culled)
  ViewProjection view_projection;  // of its normalised space
  // Whose cells these are, where a system has its own; what its skirts are.
  const Patches* patches = nullptr;
  Selection skirts{};

  // Points into this object.
  [[nodiscard]] MorphContext context() const { return {hierarchy, &radii, blend, viewpoint}; }
};

// The size of the vertices and triangles of the surface before culling, skirts included.
[[nodiscard]] std::uint64_t drawn_bytes(const SystemModel& model);

// Cells of patches that are remade are those of the last picture of the system.
struct SystemPicture {
  Image image;
  FrameStats stats;  // of all pictures, added up
  int pictures = 1;  // that were drawn and blended
  std::vector<SystemModel> models;
};

// The scene, the renderer and the scheduler outlive this. Uploads what it draws. Throws InputError for a scene with
// streamed models: M_L must be there.
class SystemPictures {
 public:
  SystemPictures(SceneView& scene, Renderer& renderer, Scheduler& scheduler, const SystemConfig& config = {});

  // As SceneView::update and Renderer::draw throw; InputError for an unknown system, and for one that blends pictures
  // of a scene with several models, which would fade at different distances, and for patches where the view has no
  // tolerance in pixels.
  [[nodiscard]] SystemPicture draw(std::string_view system, const Camera& camera, const ViewConfig& view);

  // The time that it took to make the patches of a system, which is done now if it was not; nothing for one without.
  [[nodiscard]] StageTime prepare(std::string_view system);

 private:
  struct OwnScene {
    std::vector<std::shared_ptr<Patches>> models;
    std::unique_ptr<SceneView> view;
    StageTime time;
  };
  OwnScene& own_scene(std::string_view name, const LodSystem& system);
  void show(SceneView& view, bool remade = false);
  [[nodiscard]] SystemPicture draw_patches(OwnScene& own, const Camera& camera, const ViewConfig& view);
  using SelectInSight = std::function<Selection(std::size_t model, const ViewProjection& projection)>;
  void draw_frame(Frame& frame, const SelectInSight& select, SystemPicture& picture);
  void draw_part(const std::vector<std::vector<SystemPart>>& parts, std::size_t part, SystemPicture& picture);

  SceneView& scene_;
  Renderer& renderer_;
  Scheduler& scheduler_;
  SystemConfig config_;
  std::map<std::string, OwnScene, std::less<>> own_;
  const SceneView* shown_ = nullptr;  // what the renderer has
};

// share of b and 1 - share of a, by channel, rounded; the nearer depth. Of one size.
[[nodiscard]] Image blended(const Image& a, const Image& b, double share);

}  // namespace lodestone
