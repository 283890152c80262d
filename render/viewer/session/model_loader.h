// Opens a scene or model while the window keeps responding: hierarchies are loaded or streamed, meshes are built into
// hierarchies in memory. Nothing is written.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "parallel/scheduler/background_job.h"
#include "render/scene/open_scene.h"

namespace lodestone::viewer {

// The scene of the viewer, with its opened models.
struct Model {
  std::string name;  // the file's, without its folder
  Scene scene;
  bool is_scene_file = false;  // it has lights and a camera of its own
  OpenScene opened;
};

struct LoadConfig {
  // A scene (.toml), or hierarchies (.lode) and meshes, which are then shown together, unmoved.
  std::vector<std::filesystem::path> paths;
  int threads = 0;  // as make_tbb_scheduler
  // Hierarchies whose cells take more than this in memory are streamed, with this as their budget.
  std::uint64_t memory_budget = std::uint64_t{2} << 30;
  ReadConfig reading{};  // of meshes
  BuildConfig build{};   // likewise; cancel and progress are the loader's own
};

// Its progress.
struct LoadStatus {
  std::string phase;           // "reading", "welding", "building", "loading"
  std::optional<float> share;  // of the phase, in [0, 1]; empty: not known
};

class ModelLoader {
 public:
  // Starts at once. `wake` is called, on other threads, when the status has changed.
  ModelLoader(LoadConfig config, std::function<void()> wake);
  // Cancels and waits: a build stops at the next block, a reader of text at the end of its file.
  ~ModelLoader();
  ModelLoader(const ModelLoader&) = delete;
  ModelLoader& operator=(const ModelLoader&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] LoadStatus status() const;
  [[nodiscard]] bool ended() const { return job_->ended(); }
  void cancel() { cancel_ = true; }
  // Waits for the end and hands out the model. Throws what opening it threw; Cancelled after cancel().
  [[nodiscard]] std::unique_ptr<Model> take();

 private:
  void work();
  void enter(std::string phase, std::optional<float> share = {});

  LoadConfig config_;
  std::string name_;
  std::function<void()> wake_;
  CancelFlag cancel_{false};
  mutable std::mutex mutex_;
  LoadStatus status_;  // with the lock held
  std::unique_ptr<Model> model_;
  std::unique_ptr<BackgroundJob> job_;  // the last member: it ends before what it uses
};

}  // namespace lodestone::viewer
