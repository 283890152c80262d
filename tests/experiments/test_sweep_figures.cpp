// Figures and metrics that a sweep file asks for: checked against what its sweeps will have.
#include "experiments/sweep/plan.h"
#include "tests/experiments/sweep_files.h"

namespace lodestone {
namespace {

using namespace testing;

TEST_F(SweepFiles, FiguresAreCheckedAgainstTheirSweeps) {
  const std::string head = clock("[[figure]]\ntitle = \"t\"\n");
  const std::string scaling =
      "sweep = \"s\"\nx = \"threads\"\ny = [\"gap\", \"speedup\"]\nmark = \"rho\"\nlog = \"xy\"";
  const std::string threads = clock("parameters = { threads = [1, 2] }\n[[figure]]\ntitle = \"t\"\n");
  const SweepFile file = load(threads + scaling);
  ASSERT_EQ(file.figures.size(), 1u);
  EXPECT_EQ(file.figures[0].y, (std::vector<std::string>{"gap", "speedup"}));
  EXPECT_EQ(file.figures[0].kind, "line");
  refused(head + "sweep = \"s\"\nx = \"kappa0\"\ny = \"gaps\"", 12,
          "'gaps' is neither a parameter nor a column of clock");
  refused(head + "sweep = \"t\"\nx = \"kappa0\"\ny = \"gap\"", 10, "'t' is not a sweep of this file");
  refused(head + "sweep = \"s\"\nx = \"kappa0\"", 8, "needs title, sweep, x and y");
  refused(head + "sweep = \"s\"\nx = \"kappa0\"\ny = \"gap\"\nkind = \"pie\"", 13, "line, scatter, bar");
  refused(head + "sweep = \"s\"\nx = \"kappa0\"\ny = \"gap\"\ncolour = \"red\"", 13, "unknown key 'colour'");
}

TEST_F(SweepFiles, FiguresThatPoolSettingsAreRefused) {
  const auto figure = [](const std::string& rest) {
    return clock(
        "parameters = { kappa0 = [1, 2], blend = [\"linear\", \"step\"] }\n[[figure]]\ntitle = \"t\"\n"
        "sweep = \"s\"\ny = \"gap\"\n" +
        rest);
  };
  refused(figure("x = \"kappa0\""), 13, "differ in 'blend'; name what parts them in series");
  refused(figure("x = \"kappa0\"\nkind = \"bar\"\nwhere = { fast = false }"), 13, "differ in 'blend'");
  for (const char* whole :
       {"x = \"kappa0\"\nseries = \"blend\"", "x = \"kappa0\"\nkind = \"scatter\"",
        "x = \"kappa0\"\nwhere = { blend = \"step\" }", "x = \"rho\"", "x = \"blend\"\nwhere = { kappa0 = \"< 2\" }"})
    EXPECT_EQ(load(figure(whole)).figures.size(), 1u) << whole;
}

TEST_F(SweepFiles, WhereHasValuesAndComparisons) {
  const std::string head = clock("[[figure]]\ntitle = \"t\"\nsweep = \"s\"\nx = \"kappa0\"\ny = \"gap\"\nwhere = ");
  const auto where =
      load(head + R"({ blend = "step", fast = true, gap = "<= 0.5", threads = 2, sweep = "s" })").figures[0].where;
  const std::map<std::string, Json> expected = {
      {"blend", "step"}, {"fast", true}, {"gap", "<= 0.5"}, {"threads", 2}, {"sweep", "s"}};
  EXPECT_EQ(where, expected);
  refused(head + "{ nothing = 1 }", 13, "'nothing' is neither a parameter nor a column");
  refused(head + "{ gap = \"<= many\" }", 13, "gap must be compared with a number, as \"<= 0.5\"");
  refused(head + "{ gap = [1, 2] }", 13, "gap must be a number, a text or a truth value");
  refused(head + "1", 13, "where must be a table");
}

TEST_F(SweepFiles, FiguresOfWhatNoSettingHasAreRefused) {
  const auto figure = [](const std::string& parameters, const std::string& rest) {
    return strict("parameters = { " + parameters + " }\n[[figure]]\ntitle = \"t\"\nsweep = \"s\"\n" + rest);
  };
  refused(figure("", "x = \"kappa0\"\ny = \"gap\""), 13,
          "'gap' is measured in no setting of sweep 's'; set fast = true and blend to something else than \"step\" in "
          "sweep 's'");
  refused(figure("", "x = \"rho\"\ny = \"plain\""), 12, "set kappa0 = 3.0 or fast = true in sweep 's'");
  refused(figure("", "x = \"kappa0\"\ny = \"plain\"\nmark = \"rho\""), 14, "measured in no setting");
  refused(figure("", "x = \"kappa0\"\ny = \"speedup\""), 13, "'speedup' is neither a parameter nor a column");
  refused(clock("parameters = { threads = [2, 4] }\n[[figure]]\ntitle = \"t\"\nsweep = \"s\"\nx = \"threads\"\n"
                "y = \"efficiency\""),
          13, "set threads to several numbers, 1 among them, in sweep 's'");

  const SweepFile all = load(figure("fast = true", "x = \"rho\"\ny = [\"gap\", \"plain\"]\nseries = \"kappa0\""));
  EXPECT_EQ(all.notes, std::vector<std::string>{});
  const SweepFile some = load(figure("fast = [false, true]", "x = \"fast\"\ny = [\"plain\", \"gap\"]"));
  EXPECT_EQ(some.notes, std::vector<std::string>{
                            "line 13: figure 't', y 'gap' is measured in 1 of 2 settings of sweep 's' only; for "
                            "the others set fast = true and blend to something else than \"step\""});
}

TEST_F(SweepFiles, MetricsAreColumnsThatTheSettingsHave) {
  const SweepFile file = load(strict("metrics = [\"plain\", \"rho\"]\nparameters = { kappa0 = [2, 3] }"));
  EXPECT_EQ(file.sweeps[0].metrics, (std::vector<std::string>{"plain", "rho"}));
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_NE(file.notes[0].find("line 8: sweep 's', metrics 'rho' is measured in 1 of 2 settings"), std::string::npos);
  EXPECT_EQ(make_plan(file, {}).json.at("sweeps").at(0).at("metrics"), Json({"plain", "rho"}));
  refused(strict("metrics = [\"plain\", \"gaps\"]"), 8, "'gaps' is not a column of strict; known are gap, plain, rho");
  refused(strict("metrics = \"kappa0\""), 8, "'kappa0' is not a column of strict");
  refused(strict("metrics = [\"gap\"]"), 8, "'gap' is measured in no setting of sweep 's'; set fast = true");
  refused(strict("metrics = [\"plain\", \"plain\"]"), 8, "has 'plain' twice");
  refused(strict("metrics = []"), 8, "must be a text, or texts");
}

}  // namespace
}  // namespace lodestone
