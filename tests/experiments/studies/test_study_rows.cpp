// Rows of particular studies: scaling, schedules, builds and tables, and which columns their settings fill.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "experiments/studies/experiment.h"
#include "parallel/scheduler/processors.h"
#include "parallel/scheduler/scheduler.h"
#include "tests/experiments/studies/study_case.h"

namespace lodestone {
namespace {

// As many as the scheduler has of `threads`: one in a build without oneTBB.
std::size_t workers_of(int threads) { return static_cast<std::size_t>(make_tbb_scheduler(threads)->workers()); }

TEST_F(Studies, ScalingTimesEachNumberOfWorkers) {
  for (const char* task : {"build", "raster", "reconstruct", "progressive"})
    for (const char* mode : {"strong", "weak"}) {
      const Row given = with(shallow, {{"threads", 3},
                                       {"rounds", 1},
                                       {"task", task},
                                       {"mode", mode},
                                       {"resolution", 24},
                                       {"frames", 2},
                                       {"width", 32},
                                       {"height", 32}});
      const std::vector<Row> rows = rows_of("scaling", given);
      ASSERT_EQ(rows.size(), workers_of(3)) << task;
      for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i].at("workers"), i + 1);
      EXPECT_EQ(joined(faults("scaling", given, rows)), "") << task << ' ' << mode;
      for (const Row& row : rows)
        EXPECT_EQ(number(row, "processors"),
                  std::min(number(row, "workers"), static_cast<double>(allowed_processors().size())));
      const bool weak = std::string(mode) == "weak";
      const Row& last = rows.back();
      const bool several = rows.size() > 1;
      EXPECT_EQ(weak && several, number(last, "work") > 2 * number(rows[0], "work")) << task << ' ' << mode;
      EXPECT_EQ(weak || !several, last.at("karp_flatt").is_null());
    }
}

TEST_F(Studies, VirtualWorkersComeAfterThoseThatAreMeasured) {
  const Row given = with(shallow, {{"threads", 2}, {"rounds", 1}, {"array", 1}, {"virtual_workers", 16}});
  generate_ply({Shape::sphere, 50'000, 1}, sphere_, *make_serial_scheduler());  // large enough to have a longest step
  const std::vector<Row> rows = rows_of("schedule", given);
  std::vector<std::size_t> expected{1, 4, 16};
  if (workers_of(2) == 2) expected.insert(expected.begin() + 1, 2);
  ASSERT_EQ(rows.size(), expected.size());
  // The slowdown of jobs beside each other is measured, and depends on what else the machine has to do.
  const auto undisturbed = [&](std::size_t i) { return number(rows[i], "speedup") * number(rows[i], "slowdown"); };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(number(rows[i], "workers"), expected[i]);
    EXPECT_EQ(rows[i].at("measured").is_null(), expected[i] > workers_of(2));
    EXPECT_GE(undisturbed(i), i == 0 ? 0.999 : undisturbed(i - 1) * 0.9);
    EXPECT_LE(number(rows[i], "speedup"), number(rows[i], "parallelism") * (1 + 1e-9));
  }
  EXPECT_NE(rows[0].at("critical").get<std::string>().find("partition"), std::string::npos);
}

TEST_F(Studies, MillionsPerCoreSecondAreThoseOfBuilding) {
  for (const char* name : {"build", "table"}) {
    const Row row = rows_of(name, shallow, 1).front();
    EXPECT_DOUBLE_EQ(number(row, "mtri_per_core_second") * number(row, "cpu_seconds"),
                     number(row, "input_triangles") * 1e-6);
  }
  const Row table = rows_of("table", shallow, 1).front();
  EXPECT_GT(number(table, "read_seconds"), 0);
  EXPECT_GT(number(table, "write_seconds"), 0);
  EXPECT_TRUE(table.at("spill_seconds").is_null());
  EXPECT_DOUBLE_EQ(number(table, "file_mtri_per_core_second") * number(table, "file_cpu_seconds"),
                   number(table, "input_triangles") * 1e-6);
}

TEST_F(Studies, TableBuildsOnDiskBeyondItsLimit) {
  const std::string large = (folder_ / "large.ply").string();
  generate_ply({Shape::sphere, 2'500'000, 1}, large, *make_serial_scheduler());
  const Experiment& experiment = find_experiment("table");
  const Parameters parameters(experiment.parameters, {{"memory_limit", 0.12}, {"threads", 2}});
  RunContext context;
  context.input = large;
  context.directory = folder_.string();
  const std::vector<Row> rows = experiment.run(parameters, context);
  const Row& row = rows.front();
  EXPECT_EQ(row.at("out_of_core"), true);
  EXPECT_GT(number(row, "scratch_bytes"), 0);
  for (const char* column : {"read_seconds", "spill_seconds", "write_seconds"}) EXPECT_GT(number(row, column), 0);
  EXPECT_LT(number(row, "spill_seconds"), number(row, "seconds"));
  std::vector<std::string> faults = experiment.verify(parameters, rows);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  std::erase(faults, "the build took more memory than the limit");  // sanitizers take a multiple of it for themselves
#endif
  EXPECT_EQ(joined(faults), "");
}

// Columns with needs: numbers in the settings that meet them, none in one that does not.
TEST_F(Studies, ColumnsAreThereAsTheirNeedsSay) {
  const auto measured = [&](const char* name, const Row& given, const char* column) {
    const Row small = {{"frames", 3}, {"width", 64}, {"height", 48}};
    const std::vector<Row> rows = rows_of(name, with(with(shallow, small), given));
    return std::ranges::any_of(rows, [&](const Row& row) { return row.value(column, Row()).is_number(); });
  };
  for (const char* column : {"image_error", "flip_pop_max"}) {
    EXPECT_TRUE(measured("flight", {{"image", true}, {"backend", "soft"}}, column)) << column;
    EXPECT_FALSE(measured("flight", {{"backend", "soft"}}, column)) << column;
  }
  EXPECT_TRUE(measured("flight", {{"kappa0", 1.0}}, "over_border"));
  EXPECT_FALSE(measured("flight", Row::object(), "over_border"));
  const Row orbit = {{"camera", "orbit"}, {"rounds", 1}};
  EXPECT_TRUE(measured("raster", orbit, "flip"));
  EXPECT_FALSE(measured("raster", with(orbit, {{"backend", "null"}}), "flip"));
  EXPECT_TRUE(measured("raster", with(orbit, {{"backend", "null"}}), "screen_error"));
  EXPECT_FALSE(measured("raster", with(orbit, {{"measured_frames", 0}}), "screen_error"));
  EXPECT_TRUE(measured("systems", {{"system", "step"}}, "jump_max"));
  EXPECT_FALSE(measured("systems", {{"system", "cross-fade"}}, "jump_max"));
}

}  // namespace
}  // namespace lodestone
