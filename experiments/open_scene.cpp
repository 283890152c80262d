#include "experiments/open_scene.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/base/error.h"
#include "parallel/build.h"
#include "parallel/load.h"
#include "parallel/prepare.h"
#include "parallel/save.h"
#include "render/scene/scene_file.h"

namespace lodestone {
namespace {

bool is_hierarchy_file(const std::string& file) { return std::filesystem::path(file).extension() == ".lode"; }

// Equal for models that are opened once.
std::string key_of(const SceneModel& model) {
  if (!model.generate) return model.file + (model.fill_voids ? " filled" : "");
  const GenerateConfig& g = *model.generate;
  return "generated " + std::to_string(static_cast<int>(g.shape)) + " " + std::to_string(g.triangles) + " " +
         std::to_string(g.seed);
}

Hierarchy build(RawMesh mesh, const std::string& name, const CancelFlag* cancel, Scheduler& scheduler) {
  Repairs repairs;
  BuildConfig config;
  config.cancel = cancel;
  return build_hierarchy(prepare_mesh(std::move(mesh), repairs, scheduler, name), config, scheduler);
}

}  // namespace

Scene OpenScene::read(const std::string& file) { return is_scene_file(file) ? read_scene(file) : scene_of(file); }

OpenScene::OpenScene(const Scene& scene, const OpenSceneConfig& config, Scheduler& scheduler, Progress& progress) {
  std::set<std::string> keys;
  for (const SceneModel& model : scene.models) keys.insert(key_of(model));
  for (const SceneModel& model : scene.models) {
    auto source = std::ranges::find(sources_, key_of(model), &Source::key);
    if (source == sources_.end() || config.memory_budget > 0) {  // residency follows one place in the scene
      if (config.cancel && *config.cancel) throw Cancelled{};
      progress.phase("opening " + model.name);
      sources_.emplace_back();
      source = std::prev(sources_.end());
      source->key = key_of(model);
      open(model, config, config.memory_budget / scene.models.size(), *source, scheduler);
    }
    models_.push_back({source->resident ? &source->resident->hierarchy() : &*source->whole,
                       source->resident ? &*source->resident : nullptr});
    if (source->whole) wholes_.push_back(&*source->whole);
  }
}

void OpenScene::open(const SceneModel& model, const OpenSceneConfig& config, std::uint64_t budget, Source& source,
                     Scheduler& scheduler) {
  if (!model.generate && is_hierarchy_file(model.file)) {
    if (budget > 0) {
      source.stream.emplace(model.file);
      source.resident.emplace(*source.stream, ResidencyConfig{.budget_bytes = budget});
    }
    if (!source.resident || config.whole_too) source.whole.emplace(load_lode(model.file, scheduler));
    return;
  }
  if (budget > 0)
    throw InputError(describe(
        model.generate ? model.name : model.file, {}, "is a mesh, which cannot be streamed",
        "build a hierarchy of it first: lodestone build " + (model.generate ? "MESH" : model.file) + " -o MODEL.lode"));
  if (model.generate) {
    source.whole.emplace(build(generate_mesh(*model.generate), model.name, config.cancel, scheduler));
    return;
  }
  ReadConfig reading;
  reading.fill_voids = model.fill_voids;
  RawMesh mesh = load_mesh(model.file, scheduler, reading);
  warnings_.insert(warnings_.end(), mesh.warnings.begin(), mesh.warnings.end());
  source.whole.emplace(build(std::move(mesh), model.file, config.cancel, scheduler));
}

}  // namespace lodestone
