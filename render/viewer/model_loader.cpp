#include "render/viewer/model_loader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <utility>

#include "core/hierarchy/family.h"
#include "core/hierarchy/lode_format.h"
#include "core/io/mesh_file.h"
#include "parallel/cancelling_scheduler.h"
#include "parallel/load.h"
#include "parallel/prepare.h"
#include "parallel/save.h"

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

}  // namespace

bool is_hierarchy_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, lode_magic.size()> begin{};
  return file.read(begin.data(), begin.size()) && begin == lode_magic;
}

ModelLoader::ModelLoader(LoadConfig config, std::function<void()> wake)
    : config_(std::move(config)), wake_(std::move(wake)) {
  const std::filesystem::path file = config_.path.has_filename() ? config_.path : config_.path.parent_path();
  name_ = file.filename().string();
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
  // What looks like a mesh by its name is one; what has no such name may be either, and the readers say what is wrong
  // with a file that is neither.
  if (is_hierarchy_file(config_.path) || config_.path.extension() == ".lode")
    open_hierarchy(*stopping);
  else
    build(*stopping);
  if (cancel_) throw Cancelled{};
}

void ModelLoader::open_hierarchy(Scheduler& scheduler) {
  enter("loading");
  Model& model = *model_;
  model.stream.emplace(config_.path);
  if (resident_bytes(*model.stream) > config_.memory_budget) {
    model.resident.emplace(*model.stream, ResidencyConfig{.budget_bytes = config_.memory_budget});
  } else {
    model.stream.reset();
    model.whole.emplace(load_lode(config_.path, scheduler));
  }
}

void ModelLoader::build(Scheduler& scheduler) {
  enter("reading");
  RawMesh raw = load_mesh(config_.path, scheduler, config_.reading);
  enter("welding");
  Repairs repairs;
  IndexedMesh mesh = prepare_mesh(std::move(raw), repairs, scheduler, config_.path.string());
  enter("building", 0.0f);
  BuildConfig build = config_.build;
  build.cancel = &cancel_;
  build.progress = [this, shown = 0.0](double share) mutable {
    if (share - shown < 0.01) return;
    shown = share;
    enter("building", static_cast<float>(std::clamp(share, 0.0, 1.0)));
  };
  model_->whole.emplace(build_hierarchy(std::move(mesh), build, scheduler));
  model_->whole->provenance.repairs = repairs;
}

}  // namespace lodestone::viewer
