// LOD systems that are compared. Most draw the cells of one hierarchy for the same radii and differ in nothing else:
// the usual selection and morph with other numbers. Bands that begin beyond everything leave every vertex where its own
// level has it, radii of 0 and infinity select one level as a whole, and pictures of several such parts are blended.
// Others make patches of their own of the finest level, and choose among them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/hierarchy/model/hierarchy.h"
#include "parallel/scheduler/scheduler.h"
#include "render/lod/blend.h"
#include "render/lod/radii.h"

namespace lodestone {

// The model and the viewpoint of a frame.
struct SystemQuery {
  const Hierarchy& hierarchy;
  const Radii& radii;  // of the scene, which all systems get
  Blend blend = Blend::smoothstep;
  Vec3f viewpoint;        // in normalised space
  double fade_width = 0;  // of systems that fade, as a share of the radius at which a level becomes good enough
};

// A picture of these radii, and its share of what is seen.
struct SystemPart {
  Radii radii;
  Blend blend = Blend::smoothstep;
  double share = 1;
};

// Points of the finest level, and where a system has drawn them.
struct DrawnPoints {
  std::span<const Vec3f> points;
  std::vector<Vec3f> places;  // one for each
};

// Patches, each drawn as it is, that a system has instead of the cells of the model.
class Patches {
 public:
  virtual ~Patches() = default;
  // One level, whose cells are the patches, in the normalised space of the model. The box of the first is that of the
  // whole model, which cameras look at.
  [[nodiscard]] virtual const Hierarchy& hierarchy() const = 0;
  // Those that are drawn for the whole surface, ascending; those of the call before are drawn no more. An error of 1 is
  // within the tolerance from `reach` on. The same for the same arguments, whatever was drawn before.
  [[nodiscard]] virtual std::vector<CellId> select(Vec3f viewpoint, double reach) = 0;
  // True if select() makes patches anew: they are sent to the renderer each time.
  [[nodiscard]] virtual bool remakes() const { return false; }
  // True for a patch that only covers cracks: it is not a part of the surface.
  [[nodiscard]] virtual bool is_skirt(CellId /*cell*/) const { return false; }
  // Points as select() has placed them; none for systems whose vertices cannot be followed. Where a vertex is drawn at
  // a border of the model, its place is one of these, bit for bit.
  [[nodiscard]] virtual DrawnPoints drawn_points() const { return {}; }
};

struct LodSystem {
  std::string description = {};  // half a sentence
  // One part; where it blends, two, of which the first is looked at for cracks. Shares are in [0, 1] and add up to 1. A
  // function of the query alone.
  std::function<std::vector<SystemPart>(const SystemQuery&)> parts = {};
  bool keeps_promise = false;  // neither cracks nor pops with admissible radii
  bool blends = false;         // two pictures at times, so that it draws scenes of one model alone
  bool moves_vertices = true;  // false: vertices are not followed, and there are no jumps
  // Instead of parts: makes the patches of a model from its finest level, once. Throws InputError for a model that it
  // cannot draw. The same for any scheduler.
  std::function<std::shared_ptr<Patches>(const Hierarchy&, Scheduler&)> patches = {};
  std::optional<RadiiRule> radii = {};  // instead of the view's
};

// A system of the patches that System(model, arguments..., scheduler) makes.
template <class System, class... Arguments>
[[nodiscard]] LodSystem patch_system(std::string description, Arguments... arguments) {
  LodSystem system;
  system.description = std::move(description);
  system.patches = [arguments...](const Hierarchy& model, Scheduler& scheduler) {
    return std::make_shared<System>(model, arguments..., scheduler);
  };
  return system;
}

// Makes a system known to the experiment `systems`. Throws InputError for a name that is taken or cannot be one
// (core/base/registry.h), and for a system with neither parts nor patches, or with both. To be called before any is
// used.
void add_lod_system(const std::string& name, LodSystem system);

// Throws InputError listing the known names.
[[nodiscard]] const LodSystem& lod_system(std::string_view name);

// "morph": this program's; cells by distance, vertices morphed.
// "adaptive": the same with a radius for every cell.
// "step": as "morph" with the blend `step`: vertices jump in the middle of the band, but nothing cracks.
// "discrete": cells by distance, each at the level that the distance chooses, no morph: it pops, and cracks.
// "cross-fade": the whole model at one level; two pictures blended while levels change: no cracks, ghosts.
// "cluster-dag", "cluster-dag-measured": clusters of the finest level (cluster_dag/cluster_dag.h), exchanged in groups.
// "progressive-whole": a progressive mesh as a whole, vertices morphed from prefix to prefix.
// "vdpm": a progressive mesh, refined where it is seen.
// "tiles-replace", "tiles-replace-skirts": tiles that are simplified alone and replace each other.
// "chunked-skirts", "clipmap": of height fields; chunks of a quadtree, and nested grids around the viewer.
// "known-step": the finest level, which steps aside by the tolerance now and then.
// "full": M_L, what the others are measured against.
// Then what was added.
[[nodiscard]] std::vector<std::string> lod_system_names();
inline constexpr std::string_view full_system = "full";

// The same selection, lambda = 1 everywhere. jump_bounds() of such radii has no bound.
[[nodiscard]] Radii without_morph(const Radii& radii);

// Selects all cells of a level, lambda = 1 everywhere.
[[nodiscard]] Radii whole_level(const Radii& radii, int level);

// The levels of the whole model that are seen: `share` of the coarse one and 1 - share of the fine one; one level when
// they are equal.
struct CrossFade {
  int fine = 0, coarse = 0;
  double share = 0;
  friend bool operator==(const CrossFade&, const CrossFade&) = default;
};

// A level l is good enough when (2) holds for the box of the whole model, d(v_p, B(root)) >= r_l. The coarsest one that
// is appears gradually between r_l and (1 + width) r_l, or r_{l-1} if that is nearer; so what is seen is continuous in
// the viewpoint. width >= 0; 0: it appears at once.
[[nodiscard]] CrossFade cross_fade(const Hierarchy& hierarchy, const Radii& radii, Vec3f viewpoint, double width);

}  // namespace lodestone
