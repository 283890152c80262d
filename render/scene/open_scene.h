// The opened models of a scene: hierarchies from their files, streamed if there is a budget of memory, and meshes built
// on the fly. Nothing is written.
#pragma once

#include <functional>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "core/formats/common/read_config.h"
#include "parallel/hierarchy/build.h"
#include "parallel/scheduler/scheduler.h"
#include "parallel/streaming/cell_stream.h"
#include "render/lod/resident_cells.h"
#include "render/scene/scene_view.h"

namespace lodestone {

struct OpenSceneConfig {
  std::uint64_t memory_budget = 0;  // bytes for the cells of all models; 0: they are loaded as wholes
  // True: the budget is only a bound; hierarchies that fit into it together are loaded as wholes, and meshes are built.
  // False: everything is streamed, and a mesh is an error.
  bool stream_if_larger = false;
  bool whole_too = false;  // also load streamed models as wholes, for metrics that need all cells
  ReadConfig reading{};    // of meshes
  BuildConfig build{};     // likewise; without cancel and progress, which are here
  const CancelFlag* cancel = nullptr;
  // The current phase ("loading", "generating", "reading", "welding", "building"), the model of the scene, and the
  // share of the phase that is done, if known.
  std::function<void(const std::string& phase, const SceneModel& model, std::optional<double> share)> progress;
};

class OpenScene {
 public:
  // Reads a scene file, or makes a scene of hierarchies and meshes, shown together and unmoved. Files after a scene
  // file are ignored.
  [[nodiscard]] static Scene read(const std::vector<std::string>& files);
  [[nodiscard]] static Scene read(const std::string& file) { return read(std::vector{file}); }

  OpenScene() = default;
  // A model that several of the scene share is opened once. Throws what reading, building and loading throw, naming the
  // file; InputError for a mesh that would have to be streamed; Cancelled.
  OpenScene(const Scene& scene, const OpenSceneConfig& config, Scheduler& scheduler);
  // One model that is in memory already.
  explicit OpenScene(Hierarchy hierarchy);
  OpenScene(OpenScene&&) = default;
  OpenScene& operator=(OpenScene&&) = default;

  // One for each of the scene's.
  [[nodiscard]] const std::vector<OpenModel>& models() const { return models_; }
  // The whole hierarchies; only with whole_too or without a budget.
  [[nodiscard]] std::vector<const Hierarchy*> wholes() const { return wholes_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  [[nodiscard]] bool streamed() const;
  [[nodiscard]] std::uint64_t resident_bytes() const;  // of the cells in memory, of streamed models
  [[nodiscard]] bool complete() const;                 // streamed models have all the detail that they need

 private:
  struct Source {
    std::string key;  // of its source
    std::optional<CellStream> stream;
    std::optional<ResidentCells> resident;
    std::optional<Hierarchy> whole;
  };
  Source& add_source(const SceneModel& model, const OpenSceneConfig& config, std::uint64_t budget,
                     Scheduler& scheduler);
  [[nodiscard]] Hierarchy build(const SceneModel& model, const OpenSceneConfig& config, Scheduler& scheduler);

  std::list<Source> sources_;  // do not move: others point to them
  std::vector<OpenModel> models_;
  std::vector<const Hierarchy*> wholes_;
  std::vector<std::string> warnings_;
};

}  // namespace lodestone
