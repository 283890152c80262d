// Opening a model while the window goes on: a .lode file is loaded or streamed, a mesh is built into a hierarchy in
// memory. Nothing is written.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "core/io/read_config.h"
#include "parallel/background_job.h"
#include "parallel/build.h"
#include "parallel/cell_stream.h"
#include "parallel/scheduler.h"
#include "render/lod/resident_cells.h"

namespace lodestone::viewer {

// What the viewer looks at: a whole hierarchy, or what is there of a streamed one.
struct Model {
  std::string name;  // the file's, without its folder
  std::optional<CellStream> stream;
  std::optional<ResidentCells> resident;
  std::optional<Hierarchy> whole;
  [[nodiscard]] const Hierarchy& hierarchy() const { return whole ? *whole : resident->hierarchy(); }
};

struct LoadConfig {
  std::filesystem::path path;
  int threads = 0;  // as make_tbb_scheduler
  // A file whose cells take more than this in memory is streamed, with this as its budget.
  std::uint64_t memory_budget = std::uint64_t{2} << 30;
  ReadConfig reading{};  // of meshes
  BuildConfig build{};   // likewise; cancel and progress are the loader's own
};

// How far it is.
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
  void open_hierarchy(Scheduler& scheduler);
  void build(Scheduler& scheduler);
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

// Whether the file begins as a .lode file does. False for what cannot be opened.
[[nodiscard]] bool is_hierarchy_file(const std::filesystem::path& path);

}  // namespace lodestone::viewer
