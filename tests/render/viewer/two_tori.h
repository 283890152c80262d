// A scene of two models, drawn by soft without a window.
#pragma once

#include <gtest/gtest.h>

#include "core/hierarchy/lode/lode_file.h"
#include "render/backends/make_renderer.h"
#include "render/camera/camera.h"
#include "render/viewer/session/view_drawing.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_folder.h"
#include "tests/test_meshes.h"

namespace lodestone::viewer::test {

namespace meshes = lodestone::test;

// Two tori that pass through each other, one of them turned and enlarged.
inline std::unique_ptr<Model> two_tori(const std::string& file, Scheduler& scheduler) {
  auto model = std::make_unique<Model>();
  model->scene = scene_of(file);
  model->scene.models.push_back(model->scene.models.front());
  SceneModel& second = model->scene.models.back();
  second.name = "second";
  second.rotation = {90, 20, 0};
  second.position = {0.6, 0.1, 0};
  second.scale = 1.3;
  model->opened = OpenScene(model->scene, {}, scheduler);
  return model;
}

class TwoTori : public FolderTest {
 protected:
  static constexpr ImageSize size{160, 120};

  TwoTori() {
    const std::string file = (folder_ / "torus.lode").string();
    (void)write_lode(meshes::naive_hierarchy(meshes::torus_mesh(96, 48), 3).hierarchy, file);
    model_ = two_tori(file, *scheduler_);
    drawing_.set_renderer(renderer_.get());
    drawing_.set_model(model_.get());
    look_at(state_, drawing_.bounding_sphere(), orbit_path(drawing_.bounding_sphere(), 1).front());
    state_.current().by_kappa0 = true;
    state_.current().kappa0 = 1;
  }
  Image draw() {
    (void)drawing_.draw(state_, 0, size);
    return renderer_->read_back();
  }

  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
  std::unique_ptr<Renderer> renderer_ = make_renderer("soft", *scheduler_);
  std::unique_ptr<Model> model_;
  ViewDrawing drawing_{*scheduler_};
  ViewState state_;
};

}  // namespace lodestone::viewer::test
