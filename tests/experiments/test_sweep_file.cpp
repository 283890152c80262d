// Sweep files: what designs come to, and that whatever is wrong is told with its line.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include "experiments/sweep/plan.h"
#include "experiments/sweep/sha256.h"
#include "tests/experiments/sweep_files.h"

namespace lodestone {
namespace {

using namespace testing;

TEST_F(SweepFiles, GridIsTheProduct) {
  const auto made = settings(R"(parameters = { blend = ["linear", "step"], threads = [1, 2], fast = true })");
  const std::vector<Json> expected = {{{"blend", "linear"}, {"fast", true}, {"threads", 1}},
                                      {{"blend", "linear"}, {"fast", true}, {"threads", 2}},
                                      {{"blend", "step"}, {"fast", true}, {"threads", 1}},
                                      {{"blend", "step"}, {"fast", true}, {"threads", 2}}};
  EXPECT_EQ(made, expected);
  EXPECT_EQ(settings(""), std::vector<Json>{Json::object()});
}

TEST_F(SweepFiles, RangesHaveTheirEndsAndEqualSteps) {
  const auto linear = settings("parameters = { kappa0 = { from = 1, to = 2, count = 6 } }");
  ASSERT_EQ(linear.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(linear[i].at("kappa0").get<double>(),
              std::strtod(("1." + std::to_string(2 * i % 10)).c_str(), nullptr) + (i == 5));
  const auto log = settings(R"(parameters = { kappa0 = { from = 1, to = 8, count = 4, scale = "log" } })");
  ASSERT_EQ(log.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(log[i].at("kappa0").get<double>(), 1 << i);
  const auto whole = settings(R"(parameters = { threads = { from = 1, to = 4, count = 9, scale = "log" } })");
  const std::vector<Json> expected = {{{"threads", 1}}, {{"threads", 2}}, {{"threads", 3}}, {{"threads", 4}}};
  EXPECT_EQ(whole, expected);
}

TEST_F(SweepFiles, ListHasItsSettings) {
  const auto made = settings("design = \"list\"\nparameters = [{ blend = \"step\", kappa0 = 2 }, {}, { kappa0 = 3 }]");
  const std::vector<Json> expected = {{{"blend", "step"}, {"kappa0", 2.0}}, Json::object(), {{"kappa0", 3.0}}};
  EXPECT_EQ(made, expected);
}

TEST_F(SweepFiles, RandomDrawsStayWhatTheyAre) {
  const std::string ranges = R"(kappa0 = { from = 1, to = 64, scale = "log" }, threads = { from = 1, to = 4 })";
  const auto draw = [&](int count, const std::string& more, int seed = 7) {
    return settings("design = \"random\"\nseed = " + std::to_string(seed) + "\ncount = " + std::to_string(count) +
                    "\nparameters = { " + ranges + more + " }");
  };
  const auto few = draw(20, ""), many = draw(400, ""), wider = draw(20, ", blend = [\"linear\", \"step\"]");
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
  EXPECT_NE(few, draw(20, "", 8));
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].at("kappa0"), wider[i].at("kappa0"));
  std::map<int, int> threads;
  int low = 0;
  for (const Json& setting : many) {
    const double kappa0 = setting.at("kappa0").get<double>();
    EXPECT_TRUE(kappa0 >= 1 && kappa0 <= 64);
    low += kappa0 < 8 ? 1 : 0;  // half of them, on a log scale
    ++threads[setting.at("threads").get<int>()];
  }
  EXPECT_NEAR(low, 200, 40);
  ASSERT_EQ(threads.size(), 4u);
  for (const auto& [value, count] : threads) EXPECT_NEAR(count, 100, 35) << value;
  EXPECT_EQ(std::set<Json>(many.begin(), many.end()).size(), many.size());
}

TEST_F(SweepFiles, AFormReplacesParameterByParameter) {
  const std::string text =
      "repetitions = 5\nparameters = { threads = [1, 2, 4], blend = [\"linear\", \"step\"] }\n"
      "small = { repetitions = 1, parameters = { threads = 2 } }\nfull = { parameters = { threads = [1, 2, 4, 8] } }";
  EXPECT_EQ(settings(text).size(), 6u);
  EXPECT_EQ(settings(text, SweepForm::full).size(), 8u);
  EXPECT_EQ(load(clock(text), SweepForm::full).sweeps[0].repetitions, 5);
  const std::vector<Json> expected = {{{"blend", "linear"}, {"threads", 2}}, {{"blend", "step"}, {"threads", 2}}};
  EXPECT_EQ(settings(text, SweepForm::small), expected);
  EXPECT_EQ(load(clock(text), SweepForm::small).sweeps[0].repetitions, 1);
  refused(clock("small = { parameters = { threads = 99 } }"), 8, "from 1 to 64");
  refused(clock("full = { parameters = { threads = 99 } }"), 8, "from 1 to 64");
}

TEST_F(SweepFiles, EffectsAreThoseOfTheRenderer) {
  const auto made = settings(R"(parameters = { effects = ["auto", "none", "wireframe,head-light", "fog"] })");
  ASSERT_EQ(made.size(), 4u);
  EXPECT_EQ(made[1].at("effects"), "none");
  EXPECT_EQ(made[2].at("effects"), "head-light,wireframe");
  refused(clock("\nparameters = { effects = [\"auto\", \"head-light,glow\"] }"), 9,
          "effects = \"head-light,glow\": unknown effect 'glow'; known are auto, all, none, geomorph");
  refused(clock("parameters = { effects = \"\" }"), 8, "unknown effect ''");
  refused(clock("parameters = { effects = [\"fog,wireframe\", \"wireframe,fog\"] }"), 8,
          "has the value \"wireframe,fog\" twice");
}

TEST_F(SweepFiles, ARecordedPathIsLookedIntoAndReadOnce) {
  const std::string name = (folder_ / "walk.json").string();
  const auto camera = [](const std::string& names) { return clock("\nparameters = { camera = [" + names + "] }"); };
  const std::string missing =
      name +
      ": cannot be opened for reading: No such file or directory; name a good file, relative to that of the sweep";
  refused(camera("\"orbit\", \"" + name + "\""), 9, "camera = \"" + name + "\": ");
  refused(camera("\"" + name + "\""), 9, missing);
  refused(clock("design = \"list\"\nparameters = [{},\n{ camera = \"" + name + "\" }]"), 10, missing);
  refused(camera("\"orbits\""), 9, "known are orbit, fly-in, walk, wander, or the file of a recorded path (.json)");

  const std::string key = R"({"position": [4, 0, 0], "target": [0, 0, 0]})";
  for (const auto& [content, wrong] : {std::pair{std::string("{"), "is not valid JSON"},
                                       {"{\"frames\": []}", "\"frames\" is empty"},
                                       {"{\"frames\": [{\"position\": [1, 2, 3]}]}", "has no \"target\""}}) {
    test_folder_.write("walk.json", content);
    refused(camera("\"" + name + "\""), 9, wrong);
  }
  test_folder_.write("walk.json", "{\"frames\": [" + key + "]}");
  const SweepFile file = load(camera("\"fly-in\", \"" + name + "\""));
  EXPECT_EQ(file.sweeps[0].settings[1].at("camera"), name);
  ASSERT_EQ(file.files.size(), 1u);
  EXPECT_EQ(file.files.at(name).sha256, sha256("{\"frames\": [" + key + "]}"));
  EXPECT_EQ(file.files.at(name).copy, "data/" + file.files.at(name).sha256.substr(0, 16) + ".json");
  const std::string detour = (folder_ / "." / "walk.json").string();
  refused(camera("\"" + name + "\", \"" + detour + "\""), 9, "twice");
}

TEST_F(SweepFiles, WhatIsWrongIsToldWithItsLine) {
  refused(clock("parameters = { kapa0 = 2 }"), 8, "unknown parameter 'kapa0'; known are blend, kappa0");
  refused(clock("[sweep.parameters]\nblend = \"slow\""), 9, "known are linear, step, cosine");
  refused(clock("parameters = { kappa0 = \"much\" }"), 8, "must be a number");
  refused(clock("parameters = { threads = 1.5 }"), 8, "must be a whole number");
  refused(clock("parameters = { kappa0 = [1, 1000] }"), 8, "from 0.1 to 100 cells");
  refused(clock("parameters = { kappa0 = [1, 2, 1.0] }"), 8, "has the value 1.0 twice");
  refused(clock("parameters = { kappa0 = [] }"), 8, "at least one value");
  refused(clock("parameters = { kappa0 = [[1]] }"), 8, "must be a number, a text, or true or false");
  refused(clock("parameters = { kappa0 = { from = 1, to = 2 } }"), 8, "needs a count");
  refused(clock("parameters = { kappa0 = { from = 1, count = 2 } }"), 8, "needs from and to");
  refused(clock("parameters = { kappa0 = { from = 2, to = 1, count = 2 } }"), 8, "must be above from");
  refused(clock("parameters = { kappa0 = { from = 1, to = 200, count = 2 } }"), 8, "from 0.1 to 100");
  refused(clock("parameters = { kappa0 = { from = 1, to = 2, count = 2, step = 1 } }"), 8, "unknown key 'step'");
  refused(clock("parameters = { threads = { from = 1.5, to = 2, count = 2 } }"), 8, "must be a whole number");
  refused(clock("parameters = { blend = { from = 1, to = 2, count = 2 } }"), 8, "has no range");
  refused(clock("parameters = [{ kappa0 = 1 }]"), 8, "needs design = \"list\"");
  refused(clock("design = \"list\""), 5, "needs parameters");
  refused(clock("design = \"list\"\nparameters = [{ kappa0 = 2 }, {}]"), 9, "twice, defaults filled in");
  refused(clock("design = \"list\"\nparameters = [{ kappa0 = [1, 2] }]"), 9, "must be a number, a text");
  refused(clock("design = \"halton\""), 8, "must be one of grid, list, random");
  refused(clock("design = \"random\"\nparameters = { kappa0 = [1, 2] }"), 5, "needs a count");
  refused(clock("design = \"random\"\ncount = 3\nparameters = { kappa0 = [1, 2] }"), 9, "of which only 2 differ");
  refused(clock("design = \"random\"\ncount = 3\nparameters = { kappa0 = { from = 1, to = 2, count = 3 } }"), 10,
          "belongs to a grid");
  refused(clock("count = 3"), 8, "belongs to design = \"random\"");
  refused(clock("seed = 3"), 8, "belongs to design = \"random\"");
  refused(clock("repetitions = 0"), 8, "repetitions must be a whole number from 1");
  refused(clock("data = [\"ball\"]"), 8, "clock takes none");
  refused(clock("colour = 1"), 8, "unknown key 'colour'");
  refused(clock("[[sweep]]\nname = \"s\"\nexperiment = \"clock\""), 9, "another sweep's already");
  refused(clock("[[sweep]]\nname = \"a/b\"\nexperiment = \"clock\""), 9, "letters, digits");
  refused(clock("[[sweep]]\nname = \"t\"\nexperiment = \"clok\""), 10, "unknown experiment 'clok'");
  refused(clock("[[sweep]]\nname = \"t\"\nexperiment = \"flight\""), 8, "needs data");
  refused(clock("[[sweep]]\nname = \"t\"\nexperiment = \"flight\"\ndata = \"bal\""), 11,
          "'bal' is unknown; known are ball");
  refused("name = \"x\"\n[data]\na = { path = \"a\", generate = \"box\" }", 3, "one of them");
  refused("name = \"x\"\n[data]\na = { path = \"a\", seed = 1 }", 3, "seed belongs to generate");
  refused("name = \"x\"\n[data]\na = { path = \"a\", sha256 = \"12\" }", 3, "64 hexadecimal digits");
  refused("name = \"x\"\n[data]\na = { generate = \"cone\" }", 3, "generate is wrong");
  refused("name = \"x\"\n[data]\na = { generate = \"box\", colour = 1 }", 3, "unknown key 'colour' in a");
  refused("name = \"x\"\n= 3", 2, "is not valid TOML");
  refused("title = \"x\"", 1, "needs a name");
  EXPECT_THROW((void)load("name = \"x\""), InputError);
}

TEST_F(SweepFiles, ContradictionsAreToldWithTheLineOfTheParameter) {
  refused(strict("[sweep.parameters]\nfast = true\nblend = \"step\""), 10, "a step cannot be fast; take another blend");
  refused(strict("[sweep.parameters]\nfast = [false, true]\nblend = [\"linear\", \"step\"]"), 10, "cannot be fast");
  refused(strict("design = \"list\"\nparameters = [{ fast = true },\n { fast = true, blend = \"step\" }]"), 10,
          "cannot be fast");
  refused(strict("design = \"random\"\ncount = 2\n[sweep.parameters]\nfast = true\nblend = [\"step\", \"linear\"]"), 12,
          "cannot be fast");
  refused(strict("parameters = { fast = true }\nsmall = { parameters = { blend = \"step\" } }"), 9,
          "small, a step cannot be fast");
}

TEST_F(SweepFiles, ParametersGivenForNothingAreRefused) {
  refused(strict("[sweep.parameters]\nblend = \"step\"\nkappa0 = 2"), 10,
          "kappa0 has no effect beside blend = \"step\"; leave it out");
  refused(strict("[sweep.parameters]\nblend = [\"linear\", \"step\"]\nkappa0 = [1, 2]"), 10,
          "kappa0 has no effect beside blend = \"step\", where its values make equal runs");
  refused(strict("design = \"list\"\nparameters = [{ kappa0 = 3 }, { blend = \"step\" },\n"
                 "{ blend = \"step\", kappa0 = 3 }]"),
          10, "equal runs");
  // Used by one of the settings, and no two runs are equal.
  EXPECT_EQ(load(strict("parameters = { blend = [\"linear\", \"step\"], kappa0 = 3 }")).sweeps[0].settings.size(), 2u);
  EXPECT_EQ(load(strict("parameters = { blend = \"step\" }")).sweeps[0].settings.size(), 1u);
}

TEST(Plan, IdsDependOnWhatDecidesTheResult) {
  SweepRun run;
  run.experiment = &known_experiments().front();
  run.program = "p";
  run.parameters = {{"a", 1}};
  run.input.sha256 = "i";
  const std::string id = run_id(run);
  EXPECT_EQ(id.size(), 16u);
  SweepRun other = run;
  other.data = "renamed";
  other.input.path = "moved";
  EXPECT_EQ(run_id(other), id);
  const auto differs = [&](const auto& change) {
    SweepRun changed = run;
    change(changed);
    return run_id(changed) != id;
  };
  EXPECT_TRUE(differs([](SweepRun& r) { r.experiment = &known_experiments().back(); }));
  EXPECT_TRUE(differs([](SweepRun& r) { r.program = "q"; }));
  EXPECT_TRUE(differs([](SweepRun& r) { r.parameters["a"] = 2; }));
  EXPECT_TRUE(differs([](SweepRun& r) { r.input.sha256 = "j"; }));
}

TEST(Plan, IdsHaveTheContentOfAFileAndNotItsName) {
  const auto id = [](const char* name, const char* hash) {
    SweepRun run;
    run.experiment = &known_experiments().front();
    run.parameters = {{"camera", name}};
    run.files["camera"] = {hash, "data/0.json", nullptr};
    return run_id(run);
  };
  EXPECT_EQ(id("walk.json", "a"), id("stroll.json", "a"));
  EXPECT_NE(id("walk.json", "a"), id("walk.json", "b"));
}

TEST(Plan, ShardsAreAPartitionOfOneSize) {
  SweepPlan plan;
  for (int i = 0; i < 23; ++i) {
    plan.runs.emplace_back();
    plan.runs.back().id = std::to_string((i * 7919) % 1000 + 1000);
  }
  for (const int count : {1, 2, 5, 23, 40}) {
    std::multiset<std::string> ids;
    for (int index = 1; index <= count; ++index) {
      const std::vector<SweepRun> part = runs_of(plan, {index, count});
      EXPECT_LE(part.size(), static_cast<std::size_t>((23 + count - 1) / count));
      for (const SweepRun& run : part) ids.insert(run.id);
    }
    EXPECT_EQ(ids.size(), 23u);
    EXPECT_EQ(std::set<std::string>(ids.begin(), ids.end()).size(), 23u);
  }
  for (const char* wrong : {"0/2", "3/2", "1", "/", "1/", "a/b", "1/2/3", "-1/2", ""})
    EXPECT_THROW((void)parse_shard(wrong), InputError) << wrong;
  EXPECT_EQ(parse_shard("2/8").count, 8);
}

}  // namespace
}  // namespace lodestone
