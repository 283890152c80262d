// The context below the gl backend: threads, other users of the context, and messages without a context.
#include <epoxy/gl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "tests/render/backends/gl_fixture.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

using namespace lodestone::test;

TEST_F(GlTest, ThreadsMayTakeTurns) {
  const NaiveHierarchy low = naive_hierarchy(plate(8), 1);
  WholeFrame whole(low.hierarchy, with_kappa0(2), from_above);
  renderer_->upload(low.hierarchy);
  (void)renderer_->draw(whole.frame);
  const Image here = renderer_->read_back();
  Image there;
  std::thread([&] {
    (void)renderer_->draw(whole.frame);
    there = renderer_->read_back();
  }).join();
  EXPECT_EQ(here.rgba, there.rgba);
}

// Code that shares the context may leave it in any state.
TEST_F(GlTest, AForeignStateDoesNotShow) {
  const NaiveHierarchy low = naive_hierarchy(plate(8), 1);
  WholeFrame whole(low.hierarchy, with_kappa0(2), from_above);
  auto context = make_headless_context();
  GlContext& shared = *context;
  const auto renderer = make_gl_renderer(std::move(context));
  renderer->upload(low.hierarchy);
  (void)renderer->draw(whole.frame);
  const Image before = renderer->read_back();
  {
    const CurrentContext current(shared);
    for (const GLenum on : {GL_BLEND, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST}) glEnable(on);
    glBlendFunc(GL_ONE, GL_ONE);
    glFrontFace(GL_CW);
    glScissor(0, 0, 3, 3);
    glDepthFunc(GL_NEVER);
    glDepthMask(GL_FALSE);
    glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glPixelStorei(GL_PACK_ROW_LENGTH, 777);
  }
  (void)renderer->draw(whole.frame);
  EXPECT_EQ(renderer->read_back().rgba, before.rgba);
  EXPECT_EQ(renderer->read_back().depth, before.depth);
}

// A context that is bound from outside, as a window's is, remains bound.
TEST_F(GlTest, AContextThatWasCurrentStaysCurrent) {
  auto context = make_headless_context();
  GlContext& watched = *context;
  EXPECT_FALSE(watched.is_current());
  EXPECT_FALSE(watched.origin().empty());
  auto renderer = make_gl_renderer(std::move(context));
  EXPECT_FALSE(watched.is_current());
  const NaiveHierarchy low = naive_hierarchy(plate(2), 0);
  watched.make_current();
  renderer->upload(low.hierarchy);
  EXPECT_TRUE(watched.is_current());
  std::thread([&] { EXPECT_THROW(renderer->upload(low.hierarchy), ResourceError); }).join();
  watched.release();
  std::thread([&] { EXPECT_NO_THROW(renderer->upload(low.hierarchy)); }).join();
}

// ---- what is missing, and what to do about it: each in a process of its own, where OpenGL was not opened before ----

class GlMissingTest : public ::testing::Test {
 protected:
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }

  // Runs `make_gl_renderer` in a new process with a changed environment; its message must match.
  static void expect_refusal(const char* variable, const std::string& value, const std::string& message) {
    setenv(variable, value.c_str(), 1);
    EXPECT_EXIT(report(), ::testing::ExitedWithCode(7), message);
    unsetenv(variable);
  }

  static bool is_mesa() {
    try {
      return make_gl_renderer()->device().find("Mesa") != std::string::npos;
    } catch (const UnsupportedError&) {
      return false;
    }
  }

 private:
  [[noreturn]] static void report() {
    try {
      (void)make_gl_renderer();
    } catch (const UnsupportedError& error) {
      std::fprintf(stderr, "%s\n", error.what());
      _exit(7);
    }
    _exit(0);
  }
};

TEST_F(GlMissingTest, LibrariesAreNamed) {
  // The dynamic linker searches there first, and finds a file that is not a library.
  const TestFolder folder;
  folder.write("libEGL.so.1", "none");
  expect_refusal("LD_LIBRARY_PATH", folder.path().string(), "libEGL.so.1 is missing; install libegl1.*--backend soft");
}

TEST_F(GlMissingTest, DriversAreNamed) {
  expect_refusal("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json",
                 "OpenGL without a window: .*EGL default display: .*; install libegl1 and libgl1-mesa-dri, or use "
                 "--backend soft");
}

TEST_F(GlMissingTest, VersionIsNamed) {
  // The new process runs this test from the start, with the variable set.
  if (!std::getenv("MESA_GL_VERSION_OVERRIDE") && !is_mesa()) GTEST_SKIP() << "needs OpenGL 4.5 by Mesa";
  expect_refusal("MESA_GL_VERSION_OVERRIDE", "3.3", "OpenGL 4.5.*missing.*--backend soft");
}

}  // namespace
}  // namespace lodestone
