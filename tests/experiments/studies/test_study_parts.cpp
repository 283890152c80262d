// The parts of experiments: timing, verdicts, viewpoints, surfaces, copies of a mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/mesh/clean.h"
#include "core/mesh/generate.h"
#include "experiments/studies/frame_measures.h"
#include "experiments/studies/model_drawer.h"
#include "experiments/studies/rounds.h"
#include "experiments/studies/scaling/scaling_work.h"
#include "experiments/studies/verdict.h"
#include "experiments/studies/viewpoints.h"
#include "experiments/subjects/frame_proof.h"
#include "experiments/subjects/frame_times.h"
#include "experiments/subjects/result_hash.h"
#include "parallel/hierarchy/build.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

IndexedMesh sphere(std::uint64_t triangles) {
  Repairs repairs;
  return clean_mesh(generate_mesh({Shape::sphere, triangles, 1}), repairs);
}

Hierarchy built(float sigma0, Scheduler& scheduler) {
  BuildConfig config;
  config.sigma0 = sigma0;
  config.cell_triangles = 100;
  return build_hierarchy(sphere(3000), config, scheduler);
}

TEST(Rounds, TheFirstOneWarmsUp) {
  int calls = 0;
  const Rounds rounds = time_rounds(3, {}, [&] { return StageTime{double(++calls), 0}; });
  EXPECT_EQ(calls, 4);
  EXPECT_EQ(rounds.wall, (std::vector<double>{2, 3, 4}));
}

TEST(Rounds, CancellationEndsThem) {
  const CancelFlag cancelled = true;
  RunContext context;
  context.cancel = &cancelled;
  EXPECT_THROW((void)time_rounds(3, context, [] { return StageTime{}; }), Cancelled);
}

TEST(FrameRounds, RangesAreOverRoundsAndNotOverFrames) {
  FrameRounds rounds;
  const StageTime fast{0.001, 0.002}, slow{0.009, 0.016};
  rounds.add(std::vector{fast, slow});
  rounds.add(std::vector{fast, fast, slow, slow});
  Row row;
  add_frames(row, rounds);
  for (const char* column : {"frame_ms", "frame_ms_min", "frame_ms_max"})
    EXPECT_DOUBLE_EQ(row.at(column).get<double>(), 5) << column;
  for (const char* column : {"frame_cpu_ms", "frame_cpu_ms_min", "frame_cpu_ms_max"})
    EXPECT_DOUBLE_EQ(row.at(column).get<double>(), 9) << column;
  EXPECT_DOUBLE_EQ(row.at("frame_ms_worst").get<double>(), 9);

  rounds.add(std::vector{fast});
  add_frames(row, rounds);
  EXPECT_DOUBLE_EQ(row.at("frame_ms").get<double>(), 5);
  EXPECT_DOUBLE_EQ(row.at("frame_ms_min").get<double>(), 1);
  EXPECT_DOUBLE_EQ(row.at("frame_ms_worst").get<double>(), 9);
}

TEST(FrameRounds, AreCheckedForTheirOrder) {
  FrameRounds rounds;
  for (const double seconds : {0.3, 0.1, 0.1}) rounds.add(std::vector{StageTime{seconds, seconds}});
  Row good;
  add_frames(good, rounds);
  const auto faults = [](const Row& row) {
    const std::vector<Row> rows{row};
    RowVerdict verdict(frame_columns("a frame"), rows);
    check_frames(verdict);
    return std::move(verdict).messages().size();
  };
  EXPECT_EQ(faults(good), 0u);
  for (const auto& [column, value] : {std::pair{"frame_ms", 400}, {"frame_ms_worst", 1}, {"frame_cpu_ms_min", 200}}) {
    Row bad = good;
    bad[column] = value;
    EXPECT_GT(faults(bad), 0u) << column;
  }
}

const std::vector<ColumnInfo> columns{{"name", "", "label", ColumnInfo::Kind::label},
                                      {"n", "", "count", ColumnInfo::Kind::count},
                                      {"s", "s", "cost", ColumnInfo::Kind::cost},
                                      {"s_min", "s", "cost", ColumnInfo::Kind::cost},
                                      {"s_max", "s", "cost", ColumnInfo::Kind::cost}};

std::size_t faults(
    const std::vector<Row>& rows, const std::function<void(RowVerdict&)>& checks = [](RowVerdict&) {}) {
  RowVerdict verdict(columns, rows);
  checks(verdict);
  return std::move(verdict).messages().size();
}

// Patches have no vertices to follow: null gaps say nothing about their open edges.
TEST(SurfaceVerdict, AsksForGapsWhereTheyAreMeasured) {
  const std::vector<ColumnInfo> surface = SurfaceSummary::columns();
  const auto messages = [&](const Row& gap) {
    const std::vector<Row> rows{Row{{"gap_max", gap}, {"open_edges", 3}}};
    RowVerdict verdict(surface, rows);
    check_surface(verdict, true);
    return std::move(verdict).messages().size();
  };
  EXPECT_EQ(messages(nullptr), 0u);
  EXPECT_EQ(messages(0.1), 0u);
  EXPECT_EQ(messages(0.0), 1u);
}

TEST(RowVerdict, KnowsColumnsAndTheirKinds) {
  EXPECT_EQ(faults({{{"name", "a"}, {"n", 3}, {"s", -0.5}}}), 0u);
  EXPECT_EQ(faults({{{"name", nullptr}, {"n", nullptr}}}), 0u);
  EXPECT_EQ(faults({}), 1u);
  EXPECT_EQ(faults({Row(3)}), 1u);
  EXPECT_EQ(faults({{{"other", 1}}}), 1u);
  EXPECT_EQ(faults({{{"name", 3}}}), 1u);
  EXPECT_EQ(faults({{{"n", -1}}}), 1u);
  EXPECT_EQ(faults({{{"n", "many"}}}), 1u);
  EXPECT_EQ(faults({{{"s", std::nan("")}}}), 1u);
  EXPECT_EQ(faults({{{"s", INFINITY}}}), 1u);
}

TEST(RowVerdict, Checks) {
  const Row good = {{"name", "a"}, {"s", 2}, {"s_min", 1}, {"s_max", 3}};
  EXPECT_EQ(faults({good}, [](RowVerdict& v) { v.spread("s"); }), 0u);
  for (const auto& [column, value] : {std::pair{"s", 0}, {"s", 4}, {"s_min", 3}}) {
    Row bad = good;
    bad[column] = value;
    EXPECT_GT(faults({bad}, [](RowVerdict& v) { v.spread("s"); }), 0u) << column;
  }
  for (const double same : {-2.0, 0.0, 2.0})
    EXPECT_EQ(faults({{{"s_min", same}, {"s", same}}}, [](RowVerdict& v) { v.in_order("s_min", "s"); }), 0u) << same;
  EXPECT_EQ(faults({{{"s_min", -1}, {"s", -2}}}, [](RowVerdict& v) { v.in_order("s_min", "s"); }), 1u);
  EXPECT_EQ(faults({good}, [](RowVerdict& v) { v.at_most("s", 2); }), 0u);
  EXPECT_EQ(faults({good}, [](RowVerdict& v) { v.at_most("s", 1.9); }), 1u);
  EXPECT_EQ(faults({good}, [](RowVerdict& v) { v.present("n"); }), 1u);
  EXPECT_EQ(faults({good}, [](RowVerdict& v) { v.present("name"); }), 0u);
  EXPECT_EQ(faults({good}, [](RowVerdict& v) { v.equal("s", "s_min"); }), 1u);
  EXPECT_EQ(faults({good}, [](RowVerdict& v) { v.equal("s", "n"); }), 0u);  // a column that is not there
  EXPECT_EQ(faults({{{"name", false}}}, [](RowVerdict& v) { v.is_true("name"); }), 1u);
}

TEST(SurfaceSummary, TakesTheWorstFrameAndLeavesOutWhatNoneHas) {
  SurfaceSummary summary;
  summary.add({.triangles = 10, .open_edges = 0});
  summary.add(
      {.triangles = 30,
       .open_edges = 4,
       .gap = 0.5,
       .gap_mean_pixels = 3,
       .torn_pixels = 2,
       .jump = JumpSample{.largest = 0.1, .pixels = 3, .p99 = 0.05, .step = 2, .over_bound = 0.9, .vacuous = true}});
  Row row;
  summary.add_to(row);
  EXPECT_EQ(row.at("surface_triangles"), 20);
  EXPECT_EQ(row.at("open_edges"), 4);
  EXPECT_EQ(row.at("cracked_frames"), 50);
  EXPECT_EQ(row.at("torn_pixels"), 2);
  EXPECT_EQ(row.at("gap_mean_pixels"), 3);
  EXPECT_TRUE(row.at("leak_pixels").is_null());
  EXPECT_EQ(row.at("jump_over_bound"), 0.9);
  EXPECT_EQ(row.at("jump_pixels"), 3);
  EXPECT_EQ(row.at("viewpoint_step"), 2);
  EXPECT_EQ(row.at("vacuous_frames"), 100) << "of the frames that follow another";
  summary.add({.jump = JumpSample{}});  // no bound in one frame: none at all
  summary.add_to(row);
  EXPECT_TRUE(row.at("jump_over_bound").is_null());
}

// Two steps and a leap: what a sample says of the surface is what the metrics say of its frame, and of jumps where it
// follows the frame before.
TEST(SurfaceMeasures, TakeJumpsFromTheFrameBeforeThatAFrameFollows) {
  const auto scheduler = make_serial_scheduler();
  const Hierarchy hierarchy = built(0.2f, *scheduler);
  const ImageSize size{64, 48};
  ModelDrawer drawer(hierarchy, view_of_model(size, 1), "null", *scheduler);
  SurfaceMeasures measures(hierarchy, size, *scheduler);
  const std::vector<Camera> path = fly_in_path(hierarchy, 12);
  struct Past {
    Vec3f viewpoint;
    Radii radii;
    Selection whole;
  };
  std::vector<Past> frames;
  std::vector<SurfaceSample> samples;
  const std::vector<Shot> shots{{path[6], false}, {path[7], true}, {path[9], false}};
  for (const Shot& shot : shots) {
    (void)drawer.draw(shot.camera);
    const ModelFrame& frame = drawer.view().frame().only();
    samples.push_back(measures.measure(frame, shot));
    Past& past = frames.emplace_back(Past{frame.morph.viewpoint, *frame.morph.radii, {}});
    select_cells(hierarchy, past.radii, past.viewpoint, {}, past.whole);
    double triangles = 0;
    for (const SelectedCell& s : past.whole.cells)
      triangles += static_cast<double>(hierarchy.cells[s.cell].triangles.size());
    EXPECT_EQ(samples.back().triangles, triangles);
    EXPECT_EQ(samples.back().leak_pixels, 0);
  }
  EXPECT_FALSE(samples[0].jump);
  EXPECT_FALSE(samples[2].jump);
  const auto morph = [&](const Past& past) {
    return MorphContext{&hierarchy, &past.radii, Blend::smoothstep, past.viewpoint};
  };
  const PopReport jumps =
      largest_jump(morph(frames[0]), frames[0].whole, morph(frames[1]), frames[1].whole, *scheduler);
  ASSERT_GT(jumps.max_jump, 0);
  ASSERT_TRUE(samples[1].jump);
  EXPECT_EQ(samples[1].jump->largest, 100 * jumps.max_jump);
  EXPECT_EQ(samples[1].jump->per_step, jumps.max_jump / jumps.step);
  EXPECT_EQ(samples[1].jump->over_bound, jumps.jump_over_bound);
}

class Viewpoints : public ::testing::Test {
 protected:
  Hierarchy hierarchy_ = built(0.2f, *make_serial_scheduler());

  [[nodiscard]] std::vector<Shot> shots(const char* camera, int frames, int seed = 1) const {
    const Parameters parameters(viewpoint_parameters(), {{"camera", camera}, {"frames", frames}, {"seed", seed}});
    RadiiConfig config;
    config.rule = RadiiRule::uniform;
    config.kappa0 = 1.0f;
    return viewpoints(hierarchy_, make_radii(hierarchy_, config), parameters);
  }
};

TEST_F(Viewpoints, PathsFollowAndPairsDoInPairs) {
  for (const char* path : {"orbit", "fly-in", "walk", "wander"}) {
    const std::vector<Shot> path_shots = shots(path, 5);
    ASSERT_EQ(path_shots.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(path_shots[i].follows, i > 0);
  }
  for (const char* pairs : {"random", "adversarial"}) {
    const std::vector<Shot> pair_shots = shots(pairs, 8);
    ASSERT_GE(pair_shots.size(), 2u);
    ASSERT_LE(pair_shots.size(), 8u);
    for (std::size_t i = 0; i < pair_shots.size(); ++i) EXPECT_EQ(pair_shots[i].follows, i % 2 == 1) << pairs;
  }
}

TEST_F(Viewpoints, PartsOfARecordedPathAreThoseOfTheWhole) {
  TestFolder folder;
  const std::string file = (folder.path() / "walk.json").string();
  const std::vector<Camera> keys = orbit_path(hierarchy_, 5);
  write_camera_path(file, keys);
  const auto part = [&](double from, double to, int frames) {
    return path_cameras(hierarchy_, Parameters(viewpoint_parameters(),
                                               {{"camera", file}, {"from", from}, {"to", to}, {"frames", frames}}));
  };
  const std::vector<Camera> whole = part(0, 1, 9);
  EXPECT_EQ(whole, read_camera_path(file, 9));
  EXPECT_EQ(whole.front().position, keys.front().position);
  EXPECT_EQ(whole.back().position, keys.back().position);
  const std::vector<Camera> half = part(0.5, 1, 5), all = read_camera_path(file, 10);
  EXPECT_TRUE(std::equal(half.begin(), half.end(), all.begin() + 5));
  const std::vector<Shot> path_shots = shots(file.c_str(), 5);
  ASSERT_EQ(path_shots.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(path_shots[i].follows, i > 0);
  EXPECT_THROW((void)shots((folder.path() / "none.json").c_str(), 5), FileError);
}

TEST_F(Viewpoints, RandomOnesFollowFromTheSeedAndKeepTheirStep) {
  const std::vector<Shot> first = shots("random", 40), again = shots("random", 40), other = shots("random", 40, 2);
  const Sphere bounds = bounding_sphere(hierarchy_);
  ASSERT_EQ(first.size(), 40u);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].camera, again[i].camera);
    const double distance = length(first[i].camera.position - bounds.centre) / bounds.radius;
    EXPECT_GT(distance, 1.08);
    EXPECT_LT(distance, 8.1);
    if (i % 2 == 1) {
      EXPECT_NEAR(length(first[i].camera.position - first[i - 1].camera.position) /
                      length(first[i - 1].camera.position - bounds.centre),
                  0.01, 1e-9);
    }
  }
  EXPECT_FALSE(first[0].camera == other[0].camera);
}

TEST(SideBySide, CopiesDoNotTouch) {
  const IndexedMesh one = sphere(500);
  const auto scheduler = make_serial_scheduler();
  for (const int copies : {1, 2, 3, 9}) {
    const IndexedMesh many = side_by_side(one, copies, *scheduler);
    EXPECT_EQ(many.triangles.size(), static_cast<std::size_t>(copies) * one.triangles.size());
    EXPECT_EQ(many.positions.size(), static_cast<std::size_t>(copies) * one.positions.size());
  }
}

TEST(ResultHash, TellsResultsApart) {
  const auto scheduler = make_serial_scheduler();
  const Hierarchy a = built(0.2f, *scheduler);
  const Hierarchy b = built(0.2f, *make_tbb_scheduler(3));
  const Hierarchy c = built(0.1f, *scheduler);
  EXPECT_EQ(hash_of(a), hash_of(b));
  EXPECT_NE(hash_of(a), hash_of(c));
  EXPECT_EQ(to_hex(hash_of(a)).size(), 16u);
}

}  // namespace
}  // namespace lodestone
