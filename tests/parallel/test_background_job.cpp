// Work on a thread of its own.
#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "parallel/scheduler/background_job.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {
namespace {

TEST(BackgroundJob, RunsBesideTheCallerAndSaysWhenItEnds) {
  std::atomic<bool> may_end{false}, told{false};
  std::thread::id worker;
  BackgroundJob job(
      [&] {
        worker = std::this_thread::get_id();
        while (!may_end) std::this_thread::yield();
      },
      [&] { told = true; });
  EXPECT_FALSE(job.ended());
  EXPECT_FALSE(told);
  may_end = true;
  job.finish();
  EXPECT_TRUE(job.ended());
  EXPECT_TRUE(told);
  EXPECT_NE(worker, std::this_thread::get_id());
}

TEST(BackgroundJob, RethrowsOnce) {
  BackgroundJob job([] { throw std::runtime_error("no"); });
  EXPECT_THROW(job.finish(), std::runtime_error);
  EXPECT_NO_THROW(job.finish());
  BackgroundJob cancelled([] { throw Cancelled{}; });
  EXPECT_THROW(cancelled.finish(), Cancelled);
}

TEST(BackgroundJob, TheDestructorWaits) {
  bool done = false;
  {
    const BackgroundJob job([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      done = true;
    });
  }
  EXPECT_TRUE(done);
  {
    const BackgroundJob unheard([] { throw std::runtime_error("nobody asks"); });
  }
}

}  // namespace
}  // namespace lodestone
