#include "render/viewer/session/model_loader.h"

#include <utility>

#include "parallel/scheduler/scheduler.h"
#include "render/scene/scene_file.h"

namespace lodestone::viewer {
namespace {

std::string name_of_files(const std::vector<std::filesystem::path>& paths) {
  if (paths.empty()) return {};
  const std::filesystem::path& first = paths.front();
  std::string name = (first.has_filename() ? first : first.parent_path()).filename().string();
  if (paths.size() > 1) name += " and " + std::to_string(paths.size() - 1) + " more";
  return name;
}

}  // namespace

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
  const std::unique_ptr<Scheduler> stopping = make_watched_scheduler(*scheduler, {.cancel = &cancel_});
  model_ = std::make_unique<Model>();
  model_->name = name_;
  enter("opening");
  std::vector<std::string> files;
  for (const std::filesystem::path& path : config_.paths) files.push_back(path.string());
  model_->is_scene_file = is_scene_file(files.front());
  model_->scene = OpenScene::read(files);
  if (config_.reading.up) model_->scene.up = config_.reading.up;
  OpenSceneConfig opening;
  opening.memory_budget = config_.memory_budget;
  opening.stream_if_larger = true;
  opening.reading = config_.reading;
  opening.build = config_.build;
  opening.cancel = &cancel_;
  opening.progress = [this](const std::string& phase, const SceneModel&, std::optional<double> share) {
    enter(phase, share);
  };
  model_->opened = OpenScene(model_->scene, opening, *stopping);
}

}  // namespace lodestone::viewer
