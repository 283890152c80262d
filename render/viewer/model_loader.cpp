#include "render/viewer/model_loader.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <utility>

#include "core/hierarchy/family.h"
#include "core/hierarchy/lode_format.h"
#include "parallel/cancelling_scheduler.h"
#include "parallel/generate.h"
#include "parallel/load.h"
#include "parallel/prepare.h"
#include "parallel/save.h"
#include "render/scene/scene_file.h"

namespace lodestone::viewer {
namespace {

// Of all cells in memory, whatever the form of the file.
std::uint64_t resident_bytes(const CellStream& stream) {
  std::uint64_t bytes = stream.family_bytes(no_cell);
  const std::vector<Cell>& cells = stream.tables().cells;
  for (std::uint32_t c = 0; c < cells.size(); ++c)
    if (cells[c].child_count > 0) bytes += stream.family_bytes(c);
  return bytes;
}

bool is_hierarchy(const SceneModel& model) {
  return !model.generate && (is_hierarchy_file(model.file) || std::filesystem::path(model.file).extension() == ".lode");
}

// Equal for models that are made of the same.
std::string source_of(const SceneModel& model) {
  if (!model.generate) return model.file + (model.fill_voids ? " filled" : "");
  const GenerateConfig& g = *model.generate;
  return "generated " + std::to_string(static_cast<int>(g.shape)) + ' ' + std::to_string(g.triangles) + ' ' +
         std::to_string(g.seed);
}

std::string name_of_files(const std::vector<std::filesystem::path>& paths) {
  if (paths.empty()) return {};
  const std::filesystem::path& first = paths.front();
  std::string name = (first.has_filename() ? first : first.parent_path()).filename().string();
  if (paths.size() > 1) name += " and " + std::to_string(paths.size() - 1) + " more";
  return name;
}

}  // namespace

bool is_hierarchy_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, lode_magic.size()> begin{};
  return file.read(begin.data(), begin.size()) && begin == lode_magic;
}

// ---- what is opened ----

bool Model::streamed() const {
  return std::ranges::any_of(models, [](const OpenModel& m) { return m.resident != nullptr; });
}

std::uint64_t Model::resident_bytes() const {
  std::uint64_t bytes = 0;
  for (const OpenModel& model : models) bytes += model.resident ? model.resident->bytes() : 0;
  return bytes;
}

bool Model::complete() const {
  return std::ranges::all_of(models, [](const OpenModel& m) { return !m.resident || m.resident->complete(); });
}

std::unique_ptr<Model> make_model(const std::string& name, Hierarchy hierarchy) {
  auto model = std::make_unique<Model>();
  model->name = name;
  model->scene = scene_of(name);
  model->sources.emplace_back().whole = std::move(hierarchy);
  model->models.push_back({&*model->sources.back().whole, nullptr});
  return model;
}

// ---- opening ----

ModelLoader::ModelLoader(LoadConfig config, std::function<void()> wake)
    : config_(std::move(config)), name_(name_of_files(config_.paths)), wake_(std::move(wake)) {
  job_ = std::make_unique<BackgroundJob>([this] { work(); }, wake_);
}

ModelLoader::~ModelLoader() {
  cancel_ = true;
  job_.reset();
}

LoadStatus ModelLoader::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

std::unique_ptr<Model> ModelLoader::take() {
  job_->finish();
  if (cancel_) throw Cancelled{};  // it may have been ready just before
  return std::move(model_);
}

void ModelLoader::enter(std::string phase, std::optional<float> share) {
  {
    const std::lock_guard lock(mutex_);
    status_ = {std::move(phase), share};
  }
  wake_();
}

void ModelLoader::work() {
  const std::unique_ptr<Scheduler> scheduler = make_tbb_scheduler(config_.threads);
  const std::unique_ptr<Scheduler> stopping = make_cancelling_scheduler(*scheduler, &cancel_);
  model_ = std::make_unique<Model>();
  model_->name = name_;
  enter("opening");
  read_scene();
  choose_streaming();
  std::map<std::string, Model::Source*> opened;
  for (const SceneModel& model : model_->scene.models) {
    if (cancel_) throw Cancelled{};
    Model::Source*& source = opened[source_of(model)];
    if (!source || source->resident) {  // what is loaded follows one place in the scene
      source = &model_->sources.emplace_back();
      open(model, *source, *stopping);
    }
    ResidentCells* const resident = source->resident ? &*source->resident : nullptr;
    model_->models.push_back({resident ? &resident->hierarchy() : &*source->whole, resident});
  }
  if (cancel_) throw Cancelled{};
}

void ModelLoader::read_scene() {
  const std::string first = config_.paths.front().string();
  model_->is_scene_file = is_scene_file(first);
  model_->scene = model_->is_scene_file ? lodestone::read_scene(first) : scene_of(first);
  for (std::size_t i = 1; i < config_.paths.size() && !model_->is_scene_file; ++i) {
    Scene other = scene_of(config_.paths[i].string());
    model_->scene.models.push_back(std::move(other.models.front()));
  }
}

// All hierarchies of the scene together fit into the budget, or each has its share of it.
void ModelLoader::choose_streaming() {
  std::uint64_t bytes = 0, count = 0;
  for (const SceneModel& model : model_->scene.models) {
    if (!is_hierarchy(model)) continue;
    bytes += resident_bytes(CellStream(model.file));
    ++count;
  }
  budget_ = bytes > config_.memory_budget ? std::max<std::uint64_t>(config_.memory_budget / count, 1) : 0;
}

void ModelLoader::open(const SceneModel& model, Model::Source& source, Scheduler& scheduler) {
  if (is_hierarchy(model)) {
    enter("loading");
    if (budget_ == 0) {
      source.whole.emplace(load_lode(model.file, scheduler));
      return;
    }
    source.stream.emplace(model.file);
    source.resident.emplace(*source.stream, ResidencyConfig{.budget_bytes = budget_});
    return;
  }
  if (model.generate) {
    enter("generating");
    source.whole.emplace(build(generate_mesh(*model.generate), model.name, scheduler));
    return;
  }
  enter("reading");
  ReadConfig reading = config_.reading;
  reading.fill_voids = reading.fill_voids || model.fill_voids;
  RawMesh raw = load_mesh(model.file, scheduler, reading);
  model_->warnings.insert(model_->warnings.end(), raw.warnings.begin(), raw.warnings.end());
  source.whole.emplace(build(std::move(raw), model.file, scheduler));
}

Hierarchy ModelLoader::build(RawMesh raw, const std::string& name, Scheduler& scheduler) {
  enter("welding");
  Repairs repairs;
  IndexedMesh mesh = prepare_mesh(std::move(raw), repairs, scheduler, name);
  enter("building", 0.0f);
  BuildConfig build = config_.build;
  build.cancel = &cancel_;
  build.progress = [this, shown = 0.0](double share) mutable {
    if (share - shown < 0.01) return;
    shown = share;
    enter("building", static_cast<float>(std::clamp(share, 0.0, 1.0)));
  };
  Hierarchy hierarchy = build_hierarchy(std::move(mesh), build, scheduler);
  hierarchy.provenance.repairs = repairs;
  return hierarchy;
}

}  // namespace lodestone::viewer
