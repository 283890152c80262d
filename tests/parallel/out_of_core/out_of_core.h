// A build out of core and the same one in memory.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/save.h"
#include "parallel/mesh/load.h"
#include "parallel/mesh/mesh_stream.h"
#include "parallel/out_of_core/build_model.h"
#include "tests/parallel/stream_meshes.h"
#include "tests/test_folder.h"

namespace lodestone::testing {

namespace fs = std::filesystem;

class OutOfCore : public FolderTest {
 protected:
  OutOfCore() {
    config_.build.cell_triangles = 100;
    config_.build.sigma0 = 1;
    config_.output = folder_ / "m.lode";
    config_.memory_limit = std::uint64_t{1} << 30;
    config_.part_triangles = 1500;
  }

  fs::path mesh(const RawMesh& raw) const {
    test::write_ply(folder_ / "m.ply", raw);
    return folder_ / "m.ply";
  }
  fs::path sphere() const { return mesh(test::raw_of(test::sphere_mesh(5))); }

  // The file that comes of building in memory.
  std::string in_memory(const fs::path& path) const {
    const auto scheduler = make_tbb_scheduler(2);
    Repairs repairs;
    IndexedMesh mesh = prepare_mesh(load_mesh(path, *scheduler), repairs, *scheduler, {}, config_.lattice);
    Hierarchy hierarchy = build_hierarchy(std::move(mesh), config_.build, *scheduler);
    hierarchy.provenance.repairs = repairs;
    save_lode(hierarchy, folder_ / "expected.lode", *scheduler, config_.form);
    return content(folder_ / "expected.lode");
  }

  ModelResult build(const fs::path& path, Scheduler& scheduler) const { return build(path, config_, scheduler); }
  static ModelResult build(const fs::path& path, const ModelConfig& config, Scheduler& scheduler) {
    return build_model({{path}, {}, open_mesh_stream(path)}, config, scheduler);
  }
  std::string built(const fs::path& path, int threads = 2) const {
    const auto scheduler = threads == 0 ? make_serial_scheduler() : make_tbb_scheduler(threads);
    (void)build(path, *scheduler);
    return content(folder_ / "m.lode");
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }

  ModelConfig config_;
};

}  // namespace lodestone::testing
