// A session of the viewer without its window, with a hierarchy and a mesh to open.
#pragma once

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/hierarchy/lode/lode_file.h"
#include "render/backends/make_renderer.h"
#include "render/viewer/session/view_session.h"
#include "tests/naive_hierarchy.h"
#include "tests/test_folder.h"
#include "tests/test_meshes.h"

namespace lodestone::viewer {

class Session : public FolderTest {
 protected:
  Session() {
    hierarchy_ = test::naive_hierarchy(test::torus_mesh(96, 48), 3).hierarchy;
    (void)write_lode(hierarchy_, lode_);
    std::ofstream mesh(mesh_);
    mesh << "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    session_.drawing().set_renderer(renderer_.get());
  }

  SessionConfig config() {
    SessionConfig config;
    config.load.threads = 2;
    config.folder = folder_;
    config.wake = [this] { ++wakes_; };
    config.say = [this](const std::string& line) { said_.push_back(line); };
    return config;
  }
  // Waits as the window's loop does.
  bool opened() { return opened(session_); }
  static bool opened(ViewSession& session) {
    while (session.loader() && !session.loader()->ended()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return session.collect(0);
  }

  std::string lode_ = (folder_ / "torus.lode").string(), mesh_ = (folder_ / "tetrahedron.off").string();
  Hierarchy hierarchy_;
  std::atomic<int> wakes_{0};
  std::vector<std::string> said_;
  std::unique_ptr<Scheduler> scheduler_ = make_serial_scheduler();
  std::unique_ptr<Renderer> renderer_ = make_renderer("soft", *scheduler_);
  ViewSession session_{config(), *scheduler_};
};

}  // namespace lodestone::viewer
