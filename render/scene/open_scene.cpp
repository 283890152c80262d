#include "render/scene/open_scene.h"

#include <algorithm>
#include <filesystem>

#include "core/base/error.h"
#include "core/hierarchy/lode/lode_file.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/save.h"
#include "parallel/mesh/load.h"
#include "render/scene/scene_file.h"

namespace lodestone {
namespace {

bool is_hierarchy(const SceneModel& model) { return !model.generate && is_lode_file(model.file); }

// A key that is equal for models made of the same source.
std::string key_of(const SceneModel& model) {
  if (!model.generate) return model.file + (model.fill_voids ? " filled" : "");
  const GenerateConfig& g = *model.generate;
  return "generated " + std::to_string(static_cast<int>(g.shape)) + " " + std::to_string(g.triangles) + " " +
         std::to_string(g.seed);
}

// Bytes of all its cells in memory, whatever the form of the file.
std::uint64_t bytes_of_cells(const CellStream& stream) {
  std::uint64_t bytes = stream.family_bytes(no_cell);
  const std::vector<Cell>& cells = stream.tables().cells;
  for (CellId c{0}; c < cells.size(); ++c)
    if (cells[c].child_count > 0) bytes += stream.family_bytes(c);
  return bytes;
}

// Budget of each hierarchy; 0: they are loaded as wholes.
std::uint64_t budget_of_each(const Scene& scene, const OpenSceneConfig& config) {
  if (config.memory_budget == 0) return 0;
  std::uint64_t count = 0, bytes = 0;
  for (const SceneModel& model : scene.models) {
    if (!is_hierarchy(model)) continue;
    ++count;
    if (config.stream_if_larger) bytes += bytes_of_cells(CellStream(model.file));
  }
  if (config.stream_if_larger && bytes <= config.memory_budget) return 0;
  return std::max<std::uint64_t>(config.memory_budget / std::max<std::uint64_t>(count, 1), 1);
}

void refuse_to_stream(const SceneModel& model) {
  throw InputError(describe(
      model.generate ? model.name : model.file, {}, "is a mesh, which cannot be streamed",
      "build a hierarchy of it first: lodestone build " + (model.generate ? "MESH" : model.file) + " -o MODEL.lode"));
}

void tell(const OpenSceneConfig& config, const char* phase, const SceneModel& model, std::optional<double> share = {}) {
  if (config.progress) config.progress(phase, model, share);
}

}  // namespace

Scene OpenScene::read(const std::vector<std::string>& files) {
  if (is_scene_file(files.front())) return read_scene(files.front());
  Scene scene = scene_of(files.front());
  for (std::size_t i = 1; i < files.size(); ++i) scene.models.push_back(scene_of(files[i]).models.front());
  return scene;
}

OpenScene::OpenScene(const Scene& scene, const OpenSceneConfig& config, Scheduler& scheduler) {
  const std::uint64_t budget = budget_of_each(scene, config);
  for (const SceneModel& model : scene.models) {
    if (config.cancel && *config.cancel) throw Cancelled{};
    const auto opened = std::ranges::find(sources_, key_of(model), &Source::key);
    // The cells in memory follow one placement in the scene.
    Source& source =
        opened == sources_.end() || opened->resident ? add_source(model, config, budget, scheduler) : *opened;
    ResidentCells* const resident = source.resident ? &*source.resident : nullptr;
    models_.push_back({resident ? &resident->hierarchy() : &*source.whole, resident});
    if (source.whole) wholes_.push_back(&*source.whole);
  }
  if (config.cancel && *config.cancel) throw Cancelled{};
}

OpenScene::OpenScene(Hierarchy hierarchy) {
  sources_.emplace_back().whole = std::move(hierarchy);
  models_.push_back({&*sources_.back().whole, nullptr});
  wholes_.push_back(&*sources_.back().whole);
}

bool OpenScene::streamed() const {
  return std::ranges::any_of(models_, [](const OpenModel& m) { return m.resident != nullptr; });
}

std::uint64_t OpenScene::resident_bytes() const {
  std::uint64_t bytes = 0;
  for (const OpenModel& model : models_) bytes += model.resident ? model.resident->bytes() : 0;
  return bytes;
}

bool OpenScene::complete() const {
  return std::ranges::all_of(models_, [](const OpenModel& m) { return !m.resident || m.resident->complete(); });
}

OpenScene::Source& OpenScene::add_source(const SceneModel& model, const OpenSceneConfig& config, std::uint64_t budget,
                                         Scheduler& scheduler) {
  Source& source = sources_.emplace_back();
  source.key = key_of(model);
  if (!is_hierarchy(model)) {
    if (config.memory_budget > 0 && !config.stream_if_larger) refuse_to_stream(model);
    source.whole.emplace(build(model, config, scheduler));
    return source;
  }
  tell(config, "loading", model);
  if (budget > 0) {
    source.stream.emplace(model.file);
    source.resident.emplace(*source.stream, ResidencyConfig{.budget_bytes = budget});
  }
  if (budget == 0 || config.whole_too) source.whole.emplace(load_lode(model.file, scheduler));
  return source;
}

Hierarchy OpenScene::build(const SceneModel& model, const OpenSceneConfig& config, Scheduler& scheduler) {
  tell(config, model.generate ? "generating" : "reading", model);
  RawMesh raw;
  if (model.generate) {
    raw = generate_mesh(*model.generate);
  } else {
    ReadConfig reading = config.reading;
    reading.fill_voids = reading.fill_voids || model.fill_voids;
    raw = load_mesh(model.file, scheduler, reading);
  }
  warnings_.insert(warnings_.end(), raw.warnings.begin(), raw.warnings.end());
  tell(config, "welding", model);
  Repairs repairs;
  IndexedMesh mesh = prepare_mesh(std::move(raw), repairs, scheduler, model.generate ? model.name : model.file);
  tell(config, "building", model, 0.0);
  BuildConfig building = config.build;
  building.cancel = config.cancel;
  building.progress = [&, shown = 0.0](double share) mutable {
    if (share - shown < 0.01) return;
    shown = share;
    tell(config, "building", model, std::clamp(share, 0.0, 1.0));
  };
  Hierarchy hierarchy = build_hierarchy(std::move(mesh), building, scheduler);
  hierarchy.provenance.repairs = repairs;
  return hierarchy;
}

}  // namespace lodestone
