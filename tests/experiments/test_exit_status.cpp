// The status that the command ends with, by the kind of what went wrong.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "experiments/command_line/exit_status.h"
#include "experiments/program.h"
#include "parallel/hierarchy/build.h"
#include "parallel/hierarchy/save.h"
#include "render/backends/make_renderer.h"
#include "tests/test_folder.h"
#include "tests/test_meshes.h"

namespace lodestone {
namespace {

TEST(ExitStatus, FollowsTheKindOfError) {
  const auto status = [](const auto& error) { return static_cast<int>(exit_status(error)); };
  EXPECT_EQ(status(NegativeResult("no")), 1);
  EXPECT_EQ(status(UsageError("--what")), 2);
  EXPECT_EQ(status(InputError("in.ply")), 3);
  EXPECT_EQ(status(FileError("in.ply")), 4);
  EXPECT_EQ(status(std::filesystem::filesystem_error("in", std::make_error_code(std::errc::io_error))), 4);
  EXPECT_EQ(status(UnsupportedError("gl")), 5);
  EXPECT_EQ(status(ResourceError("memory")), 6);
  EXPECT_EQ(status(std::bad_alloc()), 6);
  EXPECT_EQ(status(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again))), 6);
  EXPECT_EQ(status(std::logic_error("a mistake")), 7);
}

class Program : public FolderTest {};

// A backend of somebody's own may fail in ways that none of ours does.
TEST_F(Program, SaysThatAMistakeIsItsOwn) {
  const auto scheduler = make_serial_scheduler();
  const std::string model = folder_ / "sphere.lode";
  save_lode(build_hierarchy(test::sphere_mesh(3), {}, *scheduler), model, *scheduler);
  add_backend("mistaken",
              {.frames = [](Scheduler&) -> std::unique_ptr<Renderer> { throw std::logic_error("a mistake"); }});
  std::vector<std::string> words{"lodestone", "render", model, "--frames", "1", "--backend", "mistaken", "--quiet"};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_program(static_cast<int>(argv.size()), argv.data()), 7);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "lodestone: a mistake\n");
}

}  // namespace
}  // namespace lodestone
