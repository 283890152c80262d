// Work that is ended from outside, and that says how far it is.
#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "core/formats/mesh_file.h"
#include "core/mesh/generate.h"
#include "parallel/clean/prepare.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "parallel/mesh/load.h"
#include "parallel/scheduler/scheduler.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

class Watched : public FolderTest {
 protected:
  Watched() {
    mesh_ = (test_folder_.path() / "sphere.ply").string();
    model_ = (test_folder_.path() / "sphere.lode").string();
    (void)write_mesh(mesh_, generate_mesh({Shape::sphere, 200'000, 1}));
  }

  // From a file to a file, as a program does it.
  void all_of_it(Scheduler& scheduler) {
    Repairs repairs;
    IndexedMesh mesh = prepare_mesh(load_mesh(mesh_, scheduler), repairs, scheduler);
    save_lode(build_hierarchy(std::move(mesh), {}, scheduler), model_, scheduler);
    (void)load_lode(model_, scheduler);
  }

  std::string mesh_, model_;
};

TEST_F(Watched, TellsTheShareOfEveryLoop) {
  const auto inner = make_tbb_scheduler(3);
  struct Told {
    std::string work;
    double share;
  };
  std::vector<Told> told;
  const auto scheduler = make_watched_scheduler(*inner, {.progress = [&](const std::string& work, double share) {
    told.push_back({work, share});
  }});
  scheduler->name_work("halves");
  scheduler->for_chunks(1000, 1, [&](ChunkRange) { scheduler->for_chunks(5, 1, [](ChunkRange) {}); });
  ASSERT_EQ(told.size(), 100u);
  for (std::size_t i = 0; i < told.size(); ++i) {
    EXPECT_EQ(told[i].work, "halves");
    EXPECT_NEAR(told[i].share, static_cast<double>(i + 1) / 100, 1e-9);
  }
  told.clear();
  all_of_it(*scheduler);
  EXPECT_EQ(told.back().share, 1);
  std::size_t loops = 0;
  for (std::size_t i = 0; i < told.size(); ++i) {
    EXPECT_TRUE(told[i].share > 0 && told[i].share <= 1);
    loops += told[i].share == 1 ? 1 : 0;
  }
  EXPECT_GT(loops, 20u);
}

TEST_F(Watched, EndsAtAnyPointAndLeavesNoFile) {
  const auto inner = make_tbb_scheduler(2);
  std::size_t steps = 0;
  all_of_it(*make_watched_scheduler(*inner, {.progress = [&](const std::string&, double) { ++steps; }}));
  ASSERT_GT(steps, 50u);
  std::size_t unsaved = 0;
  for (std::size_t end = 1; end + 2 < steps; end += steps / 12) {  // in the last two steps nothing is left to begin
    std::filesystem::remove(model_);
    CancelFlag cancel{false};
    std::size_t step = 0;
    const auto scheduler = make_watched_scheduler(
        *inner, {.cancel = &cancel, .progress = [&](const std::string&, double) { cancel = ++step >= end; }});
    EXPECT_THROW(all_of_it(*scheduler), Cancelled) << end;
    // Either it had been saved before, and is whole, or there is nothing.
    EXPECT_EQ(test_folder_.files(), std::filesystem::exists(model_) ? 2u : 1u);
    if (std::filesystem::exists(model_)) {
      EXPECT_NO_THROW((void)load_lode(model_, *inner));
    } else {
      ++unsaved;
    }
  }
  EXPECT_GT(unsaved, 5u);
}

TEST_F(Watched, PassesOnWhatTheProgressThrows) {
  const auto inner = make_serial_scheduler();
  struct Enough : std::exception {};
  const auto scheduler =
      make_watched_scheduler(*inner, {.progress = [](const std::string&, double) { throw Enough(); }});
  EXPECT_THROW(all_of_it(*scheduler), Enough);
  all_of_it(*inner);
}

}  // namespace
}  // namespace lodestone
