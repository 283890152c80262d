// The order in which processors are taken, and threads that are bound to some.
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <thread>

#include "parallel/scheduler/processors.h"

namespace lodestone {
namespace {

std::vector<int> order(const std::vector<int>& processors, const std::map<int, std::string>& cores) {
  return one_per_core_first(processors, [&](int processor) { return cores.at(processor); });
}

TEST(OnePerCoreFirst, HoweverTheMachineNumbersThem) {
  const std::vector<int> four = {0, 1, 2, 3};
  EXPECT_EQ(order(four, {{0, "0,2"}, {1, "1,3"}, {2, "0,2"}, {3, "1,3"}}), four);
  EXPECT_EQ(order(four, {{0, "0-1"}, {1, "0-1"}, {2, "2-3"}, {3, "2-3"}}), (std::vector<int>{0, 2, 1, 3}));
  EXPECT_EQ(order(four, {{0, "a"}, {1, "b"}, {2, "c"}, {3, "d"}}), four) << "no core has two";
  EXPECT_EQ(order(four, {{0, "a"}, {1, "a"}, {2, "a"}, {3, "b"}}), (std::vector<int>{0, 3, 1, 2}));
  EXPECT_EQ(order({5, 4, 1}, {{1, "x"}, {4, "y"}, {5, "x"}}), (std::vector<int>{5, 4, 1})) << "as given in a turn";
  EXPECT_TRUE(order({}, {}).empty());
}

TEST(OnePerCoreFirst, LosesNoneOfThisMachine) {
  std::vector<int> ordered = one_per_core_first(allowed_processors());
  std::sort(ordered.begin(), ordered.end());
  EXPECT_EQ(ordered, allowed_processors());
}

TEST(CoreByCore, HowTheMachineNumbersThem) {
  const std::map<int, std::string> cores{{0, "0,2"}, {1, "1,3"}, {2, "0,2"}, {3, "1,3"}};
  const auto core_of = [&](int processor) { return cores.at(processor); };
  EXPECT_EQ(core_by_core({0, 1, 2, 3}, core_of), (std::vector<int>{0, 2, 1, 3}));
  EXPECT_EQ(core_by_core({3, 2, 1}, core_of), (std::vector<int>{3, 1, 2})) << "as given in a core";
  EXPECT_TRUE(core_by_core({}, core_of).empty());
}

TEST(CountCores, NoMoreThanProcessorsAndAtLeastOneOfEach) {
  const std::vector<int> all = allowed_processors();
  EXPECT_LE(count_cores(all), all.size());
  EXPECT_GE(count_cores(all), 1u);
  EXPECT_LE(count_nodes(all), count_cores(all));
  EXPECT_EQ(count_nodes({all.front()}), 1u);
}

TEST(CoreOfProcessor, IsItsOwnWhereTheSystemTellsNothing) {
  EXPECT_NE(core_of_processor(90001), core_of_processor(90002));
}

// A thread that does nothing but to be there.
class IdleThread {
 public:
  IdleThread()
      : thread_([this] {
          id_ = gettid();
          id_.notify_all();
          ended_.wait(false);
        }) {
    id_.wait(0);
  }
  ~IdleThread() {
    ended_ = true;
    ended_.notify_all();
    thread_.join();
  }
  [[nodiscard]] int processors() const {
    cpu_set_t set;
    CPU_ZERO(&set);
    EXPECT_EQ(sched_getaffinity(id_, sizeof set, &set), 0);
    return CPU_COUNT(&set);
  }

 private:
  std::atomic<pid_t> id_ = 0;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

TEST(BoundThreads, AreAllOfTheProcessForAWhile) {
  const std::vector<int> all = allowed_processors();
  const IdleThread before;
  {
    const BoundThreads binding({all.back()});
    const IdleThread within;
    EXPECT_EQ(allowed_processors(), std::vector<int>{all.back()});
    EXPECT_EQ(before.processors(), 1);
    EXPECT_EQ(within.processors(), 1);
  }
  EXPECT_EQ(allowed_processors(), all);
  EXPECT_EQ(before.processors(), static_cast<int>(all.size()));
}

TEST(BoundThreads, FindThoseThatWereStartedWithin) {
  const std::vector<int> all = allowed_processors();
  std::unique_ptr<IdleThread> within;
  {
    const BoundThreads binding({all.front()});
    within = std::make_unique<IdleThread>();
  }
  EXPECT_EQ(within->processors(), static_cast<int>(all.size()));
}

TEST(PinTo, NothingIsAnywhere) {
  const std::vector<int> all = allowed_processors();
  pin_to({});
  EXPECT_EQ(allowed_processors(), all);
}

// Otherwise both would go on side by side on the processor that they were bound to before.
TEST(BoundThreads, LeaveTheFirstToTheCallingOne) {
  const std::vector<int> all = allowed_processors();
  if (all.size() < 2) GTEST_SKIP() << "needs two processors";
  const IdleThread other;
  const std::vector<int> two(all.begin(), all.begin() + 2);
  const BoundThreads binding(two);
  EXPECT_EQ(allowed_processors(), two);
  EXPECT_EQ(other.processors(), 1);
}

}  // namespace
}  // namespace lodestone
