#include "experiments/studies/scaling/scaling_work.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/mesh/raw_mesh.h"
#include "experiments/studies/study_input.h"
#include "experiments/subjects/result_hash.h"
#include "parallel/clean/prepare.h"
#include "parallel/progressive/make_progressive.h"
#include "render/backends/make_renderer.h"
#include "render/reconstruct/reconstruct.h"
#include "render/scene/scene_view.h"

namespace lodestone {
namespace {

class BuildScaling : public ScalingJob {
 public:
  BuildScaling(IndexedMesh mesh, const BuildConfig& config, Scheduler& scheduler)
      : mesh_(std::move(mesh)), config_(config), scheduler_(scheduler) {}
  void prepare() override {
    hierarchy_ = {};
    copy_ = mesh_;
  }
  void run() override { hierarchy_ = build_hierarchy(std::move(copy_), config_, scheduler_); }
  [[nodiscard]] double work() const override { return static_cast<double>(mesh_.triangles.size()); }
  [[nodiscard]] std::uint64_t hash() const override { return hash_of(hierarchy_); }

 private:
  IndexedMesh mesh_, copy_;
  BuildConfig config_;
  Scheduler& scheduler_;
  Hierarchy hierarchy_;
};

class ProgressiveJob : public ScalingJob {
 public:
  ProgressiveJob(IndexedMesh mesh, Scheduler& scheduler) : mesh_(std::move(mesh)), scheduler_(scheduler) {}
  void run() override {
    ProgressiveReport report;
    made_ = make_progressive(mesh_, {}, scheduler_, report);
  }
  [[nodiscard]] double work() const override { return static_cast<double>(mesh_.triangles.size()); }
  [[nodiscard]] std::uint64_t hash() const override { return hash_of(made_); }

 private:
  IndexedMesh mesh_;
  Scheduler& scheduler_;
  ProgressiveMesh made_;
};

class ReconstructJob : public ScalingJob {
 public:
  ReconstructJob(const IndexedMesh& mesh, double resolution, Scheduler& scheduler)
      : mesh_(mesh), scheduler_(scheduler) {
    config_.resolution = resolution;
  }
  void run() override { made_ = reconstruct(mesh_, config_, scheduler_); }
  [[nodiscard]] double work() const override { return static_cast<double>(made_.report.pixels); }
  [[nodiscard]] std::uint64_t hash() const override { return hash_of(made_.mesh); }

 private:
  const IndexedMesh& mesh_;
  ReconstructConfig config_;
  Scheduler& scheduler_;
  Reconstruction made_;
};

// Once around the model on `soft`.
class RasterJob : public ScalingJob {
 public:
  RasterJob(const IndexedMesh& mesh, const BuildConfig& config, ImageSize size, int frames, Scheduler& scheduler)
      : hierarchy_(build_hierarchy(IndexedMesh(mesh), config, scheduler)),
        view_(scene_of("input"), {{&hierarchy_}}),
        renderer_(make_renderer("soft", scheduler)),
        cameras_(orbit_path(view_.bounding_sphere(), frames, {view_.up(), aspect_of(size)})) {
    config_ = view_config(view_.scene(), size);
    view_.upload(*renderer_);
  }
  void run() override {
    for (const Camera& camera : cameras_) {
      view_.update(camera, config_);
      (void)view_.draw(*renderer_);
    }
  }
  [[nodiscard]] double work() const override {
    return static_cast<double>(config_.size.width) * config_.size.height * static_cast<double>(cameras_.size());
  }
  [[nodiscard]] std::uint64_t hash() const override { return hash_of(renderer_->read_back()); }

 private:
  Hierarchy hierarchy_;
  SceneView view_;
  std::unique_ptr<Renderer> renderer_;
  std::vector<Camera> cameras_;
  ViewConfig config_;
};

}  // namespace

const std::vector<std::string>& scaling_tasks() {
  static const std::vector<std::string> names{"build", "raster", "reconstruct", "progressive"};
  return names;
}

IndexedMesh side_by_side(const IndexedMesh& mesh, int copies, Scheduler& scheduler) {
  if (copies == 1) return mesh;
  const int columns = static_cast<int>(std::ceil(std::cbrt(copies) - 1e-9));
  const double step = 1.01 * mesh.transform.scale;
  RawMesh all;
  for (int copy = 0; copy < copies; ++copy) {
    RawMesh part = in_model_space(mesh);
    const Vec3d offset{step * (copy % columns), step * (copy / columns % columns), step * (copy / columns / columns)};
    for (Vec3d& p : part.positions) p = p + offset;
    append_mesh(all, std::move(part), "copies");
  }
  Repairs repairs;
  return prepare_mesh(std::move(all), repairs, scheduler, "copies");
}

std::unique_ptr<ScalingJob> make_scaling_job(const IndexedMesh& mesh, const Parameters& parameters,
                                             const RunContext& context, int times, Scheduler& scheduler) {
  const std::string task = parameters.text("task");
  const double side = std::sqrt(times);  // of pictures with so many times the pixels
  const auto pixels = [&](const char* name) { return static_cast<int>(std::lround(side * parameters.number(name))); };
  if (task == "build")
    return std::make_unique<BuildScaling>(side_by_side(mesh, times, scheduler), build_config(parameters, context),
                                          scheduler);
  if (task == "progressive") return std::make_unique<ProgressiveJob>(side_by_side(mesh, times, scheduler), scheduler);
  if (task == "reconstruct")
    return std::make_unique<ReconstructJob>(mesh, side * parameters.number("resolution"), scheduler);
  return std::make_unique<RasterJob>(mesh, build_config(parameters, context),
                                     ImageSize{pixels("width"), pixels("height")}, parameters.integer("frames"),
                                     scheduler);
}

}  // namespace lodestone
