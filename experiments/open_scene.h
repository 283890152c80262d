// The models of a scene, opened: hierarchies as their files have them, streamed if there is a budget of memory, and
// meshes built on the fly.
#pragma once

#include <list>
#include <optional>
#include <string>
#include <vector>

#include "experiments/progress.h"
#include "parallel/cell_stream.h"
#include "parallel/scheduler.h"
#include "render/scene/scene_view.h"

namespace lodestone {

struct OpenSceneConfig {
  std::uint64_t memory_budget = 0;  // bytes for the cells of all models; 0: they are loaded as wholes
  bool whole_too = false;           // streamed models as wholes beside that, for what looks at all of them
  const CancelFlag* cancel = nullptr;
};

class OpenScene {
 public:
  // Reads a scene file, or makes a scene of one model of a hierarchy or mesh.
  [[nodiscard]] static Scene read(const std::string& file);

  // A model that several of the scene share is opened once. Throws what reading, building and loading throw, naming the
  // file; InputError for a mesh under a memory budget; Cancelled.
  OpenScene(const Scene& scene, const OpenSceneConfig& config, Scheduler& scheduler, Progress& progress);

  [[nodiscard]] std::vector<OpenModel> models() const { return models_; }
  // As wholes; only with whole_too or without a budget.
  [[nodiscard]] std::vector<const Hierarchy*> wholes() const { return wholes_; }
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Source {
    std::string key;  // what it is made of
    std::optional<CellStream> stream;
    std::optional<ResidentCells> resident;
    std::optional<Hierarchy> whole;
  };
  void open(const SceneModel& model, const OpenSceneConfig& config, std::uint64_t budget, Source& source,
            Scheduler& scheduler);

  std::list<Source> sources_;  // do not move: others point to them
  std::vector<OpenModel> models_;
  std::vector<const Hierarchy*> wholes_;
  std::vector<std::string> warnings_;
};

}  // namespace lodestone
