// The report's figures are computed here: aggregation, joins, fronts, and what is said of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "experiments/metrics/cost/pareto.h"
#include "experiments/report/findings.h"
#include "experiments/report/html.h"
#include "experiments/report/number_text.h"
#include "experiments/report/report.h"

namespace lodestone {
namespace {

using Kind = ColumnInfo::Kind;
using nlohmann::json;

// ---- fronts

// The definition, point by point.
std::vector<std::size_t> obvious_front(const std::vector<CostError>& points) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < points.size(); ++i) {
    bool beaten = !std::isfinite(points[i].cost) || !std::isfinite(points[i].error);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const bool equal = points[k].cost == points[i].cost && points[k].error == points[i].error;
      const bool at_most = points[k].cost <= points[i].cost && points[k].error <= points[i].error;
      beaten = beaten || (at_most && (!equal || k < i));
    }
    if (!beaten) front.push_back(i);
  }
  std::sort(front.begin(), front.end(), [&](std::size_t a, std::size_t b) { return points[a].cost < points[b].cost; });
  return front;
}

TEST(Pareto, FrontIsThatOfTheDefinition) {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    std::vector<CostError> points(random() % 30);
    for (CostError& p : points) p = {static_cast<double>(random() % 8), static_cast<double>(random() % 8)};
    if (!points.empty() && round % 3 == 0) points[0].error = NAN;
    EXPECT_EQ(pareto_front(points), obvious_front(points));
    const double limit = static_cast<double>(random() % 9) - 0.5;
    const auto cheapest = cheapest_within(points, limit);
    double least = INFINITY;
    for (const CostError& p : points)
      if (p.error <= limit) least = std::min(least, p.cost);
    ASSERT_EQ(cheapest.has_value(), std::isfinite(least));
    if (cheapest) {
      EXPECT_EQ(points[*cheapest].cost, least);
    }
  }
}

TEST(Pareto, LimitsAreRoundAndSpanTheFront) {
  EXPECT_EQ(error_limits(std::vector<CostError>{{1, 0.3}, {2, 0.02}, {3, 0.03}}),
            (std::vector<double>{0.02, 0.05, 0.1, 0.2, 0.5}));
  EXPECT_EQ(error_limits(std::vector<CostError>{{1, 3}, {2, 0}}), (std::vector<double>{0, 5}));
  EXPECT_EQ(error_limits(std::vector<CostError>{{1, 0}}), std::vector<double>{0});
  EXPECT_EQ(error_limits({}), std::vector<double>{});
  const std::vector<double> decades = error_limits(std::vector<CostError>{{1, 700}, {2, 0.0011}});
  EXPECT_EQ(decades, (std::vector<double>{0.01, 0.1, 1, 10, 100, 1000}));
}

// ---- settings

RunRecord make_run(const std::string& id, const std::string& data, json parameters,
                   std::vector<std::vector<Row>> rows) {
  RunRecord run;
  run.id = id, run.data = data, run.parameters = std::move(parameters);
  for (std::size_t r = 0; r < rows.size(); ++r)
    run.repetitions.push_back({static_cast<int>(r), true, std::move(rows[r]), std::nullopt, json::object()});
  return run;
}

SweepRecord make_sweep(std::vector<ColumnInfo> columns, std::vector<std::string> parameters) {
  SweepRecord sweep;
  sweep.name = "sweep", sweep.experiment = "flight", sweep.columns = std::move(columns);
  for (const std::string& name : parameters) sweep.parameters.push_back({name, nullptr, "", "", 0, 0, {}});
  return sweep;
}

TEST(Aggregate, CostsAreMediansAndAccuracyIsWhereItWasMeasured) {
  SweepRecord sweep = make_sweep({{"seconds", "s", "", Kind::cost}, {"gap", "pixels", "", Kind::accuracy}}, {"kappa0"});
  sweep.runs.push_back(
      make_run("a", "sphere", {{"kappa0", 2.0}},
               {{{{"seconds", 3.0}, {"gap", 0.5}}}, {{{"seconds", 1.0}}}, {{{"seconds", 2.0}, {"gap", nullptr}}}}));
  const SettingTable table = aggregate(sweep);
  ASSERT_EQ(table.settings.size(), 1U);
  const SettingCell& seconds = table.settings[0].at("seconds");
  EXPECT_EQ(seconds.value, 2.0);
  EXPECT_EQ(seconds.least, 1.0);
  EXPECT_EQ(seconds.most, 3.0);
  EXPECT_EQ(seconds.count, 3);
  EXPECT_EQ(table.settings[0].at("gap").value, 0.5);
  EXPECT_EQ(table.settings[0].at("gap").count, 1);
  EXPECT_EQ(table.settings[0].at("kappa0").value, 2.0);
  EXPECT_EQ(table.settings[0].at("data").value, "sphere");
  EXPECT_TRUE(table.settings[0].at("nothing").value.is_null());
  EXPECT_TRUE(table.varied.empty());
}

TEST(Aggregate, RangesWithinARepetitionWidenThoseOverAll) {
  SweepRecord sweep = make_sweep({{"seconds", "s", "", Kind::cost},
                                  {"seconds_min", "s", "", Kind::cost},
                                  {"seconds_max", "s", "", Kind::cost},
                                  {"gap", "", "", Kind::accuracy},
                                  {"gap_max", "", "", Kind::accuracy}},
                                 {});
  sweep.runs.push_back(make_run("a", "", json::object(),
                                {{{{"seconds", 3}, {"seconds_min", 2}, {"seconds_max", 4}, {"gap_max", 1}}},
                                 {{{"seconds", 5}, {"seconds_min", 4.5}, {"seconds_max", 9}}}}));
  const SettingTable table = aggregate(sweep);
  EXPECT_EQ(table.settings[0].at("seconds").value, 4.0);
  EXPECT_EQ(table.settings[0].at("seconds").least, 2.0);
  EXPECT_EQ(table.settings[0].at("seconds").most, 9.0);
  EXPECT_EQ(table.find("seconds_min"), nullptr);
  EXPECT_NE(table.find("gap_max"), nullptr) << "is no cost";
  EXPECT_EQ(table.settings[0].at("seconds_max").value, 6.5) << "figures may name it";
}

TEST(Aggregate, WhatDoesNotVerifyIsLeftOutWithAllItsRepetitions) {
  SweepRecord sweep = make_sweep({{"seconds", "s", "", Kind::cost}}, {"kappa0"});
  for (const char* id : {"good", "wrong", "crashed", "lacking", "missing"})
    sweep.runs.push_back(make_run(id, "sphere", {{"kappa0", 1}}, {{{{"seconds", 1}}}, {{{"seconds", 2}}}}));
  sweep.runs[1].repetitions[1].fault = RunFault{"verify", {"open edges"}};
  for (Repetition& r : sweep.runs[2].repetitions) r = {r.number, false, {}, RunFault{"crash", {"signal 9"}}, {}};
  sweep.runs[3].repetitions[0] = {0, false, {}, RunFault{"error", {"no room"}}, {}};
  for (Repetition& r : sweep.runs[4].repetitions) r = {r.number, false, {}, std::nullopt, {}};
  std::vector<RunState> states;
  for (const RunRecord& run : sweep.runs) states.push_back(state_of(run));
  EXPECT_EQ(states, (std::vector<RunState>{RunState::complete, RunState::unverified, RunState::failed,
                                           RunState::incomplete, RunState::missing}));
  const SettingTable table = aggregate(sweep);
  ASSERT_EQ(table.settings.size(), 2U);
  EXPECT_EQ(table.settings[0].run, 0U);
  EXPECT_EQ(table.settings[1].run, 3U);
  EXPECT_EQ(table.settings[1].at("seconds").value, 2.0);
  const RunCounts counts = count_runs(sweep);
  EXPECT_EQ(counts.reported(), 2U);
  EXPECT_EQ(counts.unverified + counts.failed + counts.missing, 3U);
}

// What unsteady_results() says of a run with these rows.
std::vector<std::string> unsteady(std::vector<std::vector<Row>> rows) {
  const std::vector<ColumnInfo> columns{{"hash", "", "", Kind::label},
                                        {"triangles", "", "", Kind::count},
                                        {"gap", "", "", Kind::accuracy},
                                        {"seconds", "s", "", Kind::cost}};
  return unsteady_results(make_run("a", "", json::object(), std::move(rows)), columns);
}

TEST(Repetitions, ResultsAreEqualAndCostsAreNot) {
  using Texts = std::vector<std::string>;
  EXPECT_EQ(unsteady({}), Texts{});
  EXPECT_EQ(unsteady({{{{"triangles", 10}, {"gap", 0.1}, {"seconds", 1}}},
                      {{{"triangles", 10}, {"gap", 0.1 + 1e-17}, {"seconds", 2}}}}),
            Texts{});
  EXPECT_EQ(unsteady({{{{"hash", "a"}, {"gap", 0.1}}}, {{{"hash", "a"}}}, {{{"hash", "a"}, {"gap", nullptr}}}}),
            Texts{})
      << "what was not measured again does not differ";
  EXPECT_EQ(unsteady({{{{"triangles", 10}}}, {{{"triangles", 11}}}}),
            Texts{"triangles differs between repetitions: 10 and 11"});
  EXPECT_EQ(unsteady({{{{"gap", nullptr}}}, {{{"gap", 0.25}}}, {{{"gap", 0.5}, {"hash", "b"}}}}),
            Texts{"gap differs between repetitions: 0.25 and 0.5"});
  EXPECT_EQ(unsteady({{{{"hash", "a"}, {"gap", 1}}}, {{{"hash", "b"}, {"gap", 2}}}}).size(), 2U);
  EXPECT_EQ(unsteady({{{{"seconds", 1}}}, {{{"seconds", 2}}, {{"seconds", 3}}}}),
            Texts{"the number of rows differs between repetitions: 1 and 2"});
}

TEST(Aggregate, RunsWhoseResultsDifferAreLeftOut) {
  SweepRecord sweep = make_sweep({{"triangles", "", "", Kind::count}}, {});
  for (const char* id : {"a", "b"})
    sweep.runs.push_back(make_run(id, "", json::object(), {{{{"triangles", 10}}}, {{{"triangles", 10}}}}));
  sweep.runs[0].repetitions[1].rows[0]["triangles"] = 11;
  for (RunRecord& run : sweep.runs) run.unsteady = unsteady_results(run, sweep.columns);
  EXPECT_EQ(state_of(sweep.runs[0]), RunState::unverified);
  const SettingTable table = aggregate(sweep);
  ASSERT_EQ(table.settings.size(), 1U);
  EXPECT_EQ(table.settings[0].run, 1U);
}

TEST(Aggregate, RowsOfARunAreJoinedByPlaceAndToldApartByTexts) {
  SweepRecord sweep =
      make_sweep({{"stage", "", "", Kind::label}, {"hash", "", "", Kind::label}, {"seconds", "s", "", Kind::cost}}, {});
  const auto rows = [](double a, double b) {
    return std::vector<Row>{{{"stage", "read"}, {"hash", "0123456789abcdef"}, {"seconds", a}},
                            {{"stage", "write"}, {"hash", "fedcba9876543210"}, {"seconds", b}}};
  };
  sweep.runs.push_back(make_run("a", "", json::object(), {rows(1, 10), rows(2, 20), rows(3, 30)}));
  const SettingTable table = aggregate(sweep);
  ASSERT_EQ(table.settings.size(), 2U);
  EXPECT_EQ(table.settings[0].at("seconds").value, 2.0);
  EXPECT_EQ(table.settings[1].at("seconds").value, 20.0);
  EXPECT_EQ(table.varied, std::vector<std::string>{"stage"});
  EXPECT_EQ(setting_label(table.settings[1], table.varied), "stage = write");
}

TEST(Aggregate, LabelsThatFollowFromOthersAreNotRepeated) {
  SweepRecord sweep = make_sweep({{"effects", "", "", Kind::label}, {"effect", "", "", Kind::label}}, {});
  sweep.runs.push_back(
      make_run("a", "", json::object(),
               {{{{"effects", "all but fog"}, {"effect", "fog"}}, {{"effects", "all"}, {"effect", nullptr}}}}));
  sweep.runs.push_back(make_run("b", "", json::object(), {{{{"effects", "all but light"}, {"effect", "light"}}}}));
  EXPECT_EQ(aggregate(sweep).varied, std::vector<std::string>{"effects"});
}

TEST(Aggregate, NumbersMayPartRowsAndTruthValuesDoNot) {
  SweepRecord sweep = make_sweep({{"frame", "", "", Kind::label}, {"closed", "", "", Kind::label}}, {});
  sweep.runs.push_back(make_run("a", "", json::object(),
                                {{{{"frame", 12345678}, {"closed", true}}, {{"frame", 1}, {"closed", false}}}}));
  EXPECT_EQ(aggregate(sweep).varied, std::vector<std::string>{"frame"});
}

TEST(Aggregate, ScalingIsAgainstOneThreadOfTheSameSetting) {
  SweepRecord sweep = make_sweep({{"seconds", "s", "", Kind::cost}}, {"strategy", "threads"});
  for (const char* strategy : {"graph", "levels"})
    for (const int threads : {1, 2, 4}) {
      const double serial = strategy[0] == 'g' ? 0.0 : 0.2, seconds = 8 * (serial + (1 - serial) / threads);
      sweep.runs.push_back(
          make_run(strategy + std::to_string(threads), "sphere", {{"strategy", strategy}, {"threads", threads}},
                   {{{{"seconds", seconds}}}, {{{"seconds", seconds * 1.1}}}, {{{"seconds", seconds}}}}));
    }
  const SettingTable table = aggregate(sweep);
  for (const SettingRow& setting : table.settings) {
    const double p = setting.at("threads").number(), serial = setting.at("strategy").value == "graph" ? 0 : 0.2;
    const double speedup = 1 / (serial + (1 - serial) / p);
    EXPECT_NEAR(setting.at("speedup").number(), speedup, 1e-12);
    EXPECT_NEAR(setting.at("efficiency").number(), speedup / p, 1e-12);
    EXPECT_LE(setting.at("speedup").least, setting.at("speedup").number());
    EXPECT_GE(setting.at("speedup").most, setting.at("speedup").number());
    ASSERT_EQ(setting.at("karp_flatt").value.is_null(), p == 1);
    if (p > 1) {
      EXPECT_NEAR(setting.at("karp_flatt").number(), serial, 1e-12);
    }
  }
}

TEST(Aggregate, WithoutOneThreadThereIsNoSpeedup) {
  SweepRecord sweep = make_sweep({{"seconds", "s", "", Kind::cost}}, {"threads"});
  for (const int threads : {2, 4})
    sweep.runs.push_back(make_run(std::to_string(threads), "", {{"threads", threads}}, {{{{"seconds", 1.0}}}}));
  const SettingTable table = aggregate(sweep);
  for (const SettingRow& setting : table.settings) EXPECT_TRUE(setting.at("speedup").value.is_null());
}

// ---- figures

SweepRecord border_sweep() {
  SweepRecord sweep = make_sweep({{"gap", "pixels", "", Kind::accuracy},
                                  {"seconds", "s", "", Kind::cost},
                                  {"memory", "bytes", "", Kind::cost},
                                  {"rho", "", "", Kind::accuracy}},
                                 {"kappa0", "blend"});
  for (const char* blend : {"linear", "step"})
    for (const double kappa0 : {4.0, 1.0, 2.0})
      sweep.runs.push_back(
          make_run(blend + std::to_string(kappa0), "sphere", {{"kappa0", kappa0}, {"blend", blend}},
                   {{{{"gap", std::max(0.0, 3 - kappa0)}, {"seconds", kappa0}, {"memory", 2097152}, {"rho", 3.0}}}}));
  return sweep;
}

TEST(Figures, CurvesAreSortedAndMarksAreDrawnOnce) {
  const SettingTable table = aggregate(border_sweep());
  FigureRequest request;
  request.sweeps = {"sweep"}, request.x = "kappa0", request.y = {"gap"}, request.series = {"data", "blend"},
  request.mark = "rho";
  const Figure figure = make_figure(request, {&table});
  ASSERT_EQ(figure.panels.size(), 1U);
  ASSERT_EQ(figure.panels[0].series.size(), 2U);
  EXPECT_EQ(figure.panels[0].series[1].name, "sphere, step");
  std::vector<double> x;
  for (const FigurePoint& p : figure.panels[0].series[0].points) x.push_back(p.x);
  EXPECT_EQ(x, (std::vector<double>{1, 2, 4}));
  ASSERT_EQ(figure.marks.size(), 1U);
  EXPECT_EQ(figure.marks[0].x, 3.0);
  EXPECT_EQ(figure.outcome, "gap: from rho (2 settings) 0 pixels; below rho (4 settings) 1 to 2 pixels.");
}

TEST(Figures, SettingsOnOnePlaceAreTakenTogetherAndThatIsSaid) {
  SweepRecord sweep = border_sweep();
  for (RunRecord& run : sweep.runs)
    if (run.parameters["blend"] == "step") run.repetitions[0].rows[0]["seconds"] = 10.0;
  const SettingTable table = aggregate(sweep);
  FigureRequest request;
  request.sweeps = {"sweep"}, request.x = "kappa0", request.y = {"seconds", "memory"};
  const Figure figure = make_figure(request, {&table});
  ASSERT_EQ(figure.panels.size(), 2U) << "seconds and bytes share no axis";
  const FigurePoint& first = figure.panels[0].series[0].points[0];
  EXPECT_EQ(first.settings, 2U);
  EXPECT_EQ(first.y, 5.5);
  EXPECT_EQ(first.y_least, 1.0);
  EXPECT_EQ(first.y_most, 10.0);
  EXPECT_EQ(figure.notes.size(), 1U);
  EXPECT_EQ(figure.panels[1].y_unit, "MiB");
  EXPECT_EQ(figure.panels[1].series[0].points[0].y, 2.0);
}

TEST(Figures, FrontsNameTheCheapestSettingForAnError) {
  const SettingTable table = aggregate(border_sweep());
  FigureRequest request;
  request.sweeps = {"sweep"}, request.x = "seconds", request.y = {"gap"}, request.kind = "scatter",
  request.pareto = true;
  const Figure figure = make_figure(request, {&table});
  ASSERT_EQ(figure.panels[0].fronts.size(), 1U);
  const FigureFront& front = figure.panels[0].fronts[0];
  EXPECT_EQ(front.candidates, 6U);
  ASSERT_EQ(front.points.size(), 3U);
  ASSERT_EQ(front.choices.size(), 3U);
  EXPECT_EQ(front.choices[0].limit, 0);
  EXPECT_EQ(front.points[front.choices[0].point].x, 4.0);
  EXPECT_EQ(front.choices[1].limit, 1);
  EXPECT_EQ(front.points[front.choices[1].point].x, 2.0);
  EXPECT_EQ(figure.outcome,
            "3 of 6 settings on the front; gap of at most 1 pixels costs 2 s (kappa0 = 2, blend = linear).");
}

TEST(Figures, FrontsOfQualityRise) {
  SweepRecord sweep = make_sweep({{"psnr", "dB", "", Kind::quality}, {"seconds", "s", "", Kind::cost}}, {"tolerance"});
  for (const auto& [tolerance, psnr, seconds] :
       {std::array{1.0, 42.0, 3.0}, {2.0, 38.0, 2.0}, {3.0, 35.0, 2.5}, {4.0, 33.0, 1.0}})
    sweep.runs.push_back(make_run(std::to_string(tolerance), "sphere", {{"tolerance", tolerance}},
                                  {{{{"psnr", psnr}, {"seconds", seconds}}}}));
  const SettingTable table = aggregate(sweep);
  FigureRequest request;
  request.sweeps = {"sweep"}, request.x = "seconds", request.y = {"psnr"}, request.pareto = true;
  const Figure figure = make_figure(request, {&table});
  std::vector<double> front;
  for (const FigurePoint& p : figure.panels.at(0).fronts.at(0).points) front.push_back(p.y);
  EXPECT_EQ(front, (std::vector<double>{33, 38, 42})) << "35 dB for 2.5 s is beaten by 38 dB for 2 s";
  EXPECT_EQ(figure.outcome, "3 of 4 settings on the front; psnr of at least 38 dB costs 2 s (tolerance = 2).");
}

TEST(Figures, AFrontIsThatOfOneError) {
  SweepRecord sweep = make_sweep(
      {{"rms", "%", "", Kind::accuracy}, {"error_max", "%", "", Kind::accuracy}, {"seconds", "s", "", Kind::cost}},
      {"sigma0"});
  for (const double sigma0 : {1.0, 2.0})
    sweep.runs.push_back(make_run(std::to_string(sigma0), "sphere", {{"sigma0", sigma0}},
                                  {{{{"rms", sigma0}, {"error_max", 10 * sigma0}, {"seconds", 3 - sigma0}}}}));
  const SettingTable table = aggregate(sweep);
  FigureRequest request;
  request.sweeps = {"sweep"}, request.x = "seconds", request.y = {"rms", "error_max"};
  EXPECT_EQ(make_figure(request, {&table}).panels.size(), 1U) << "one unit, one axis";
  request.pareto = true;
  const Figure figure = make_figure(request, {&table});
  ASSERT_EQ(figure.panels.size(), 2U);
  for (const FigurePanel& panel : figure.panels) EXPECT_EQ(panel.fronts.at(0).candidates, 2U);
}

TEST(Figures, TextsAndBarsStandAtPlacesOfTheirOwn) {
  const SettingTable table = aggregate(border_sweep());
  FigureRequest request;
  request.sweeps = {"sweep"}, request.x = "blend", request.y = {"gap"}, request.series = {"kappa0"},
  request.kind = "bar";
  request.pareto = true, request.mark = "rho";
  const Figure bars = make_figure(request, {&table});
  EXPECT_EQ(bars.categories, (std::vector<std::string>{"linear", "step"}));
  EXPECT_EQ(bars.panels[0].series[0].points[1].x, 1.0);
  EXPECT_TRUE(bars.panels[0].fronts.empty());
  EXPECT_TRUE(bars.marks.empty());
  EXPECT_EQ(bars.notes.size(), 2U);
  request.x = "kappa0", request.series = {"blend"};
  EXPECT_EQ(make_figure(request, {&table}).categories, (std::vector<std::string>{"1", "2", "4"}));
}

TEST(Figures, WithoutNumbersSaySo) {
  SweepRecord sweep = border_sweep();
  for (RunRecord& run : sweep.runs) run.repetitions[0].rows[0]["gap"] = nullptr;
  const SettingTable table = aggregate(sweep);
  FigureRequest request;
  request.sweeps = {"sweep"}, request.x = "kappa0", request.y = {"gap"}, request.pareto = true;
  const Figure figure = make_figure(request, {&table});
  EXPECT_EQ(figure.outcome, "No setting that verified has numbers for gap.");
  EXPECT_EQ(figure.notes.at(0), "6 of 6 points have no number and are left out");
}

// ---- texts

TEST(NumberText, IsForPeople) {
  EXPECT_EQ(number_text(0), "0");
  EXPECT_EQ(number_text(1234567), "1,234,567");
  EXPECT_EQ(number_text(-1234), "-1,234");
  EXPECT_EQ(number_text(0.0123456), "0.01235");
  EXPECT_EQ(number_text(1.5e-7), "1.5e-07");
  EXPECT_EQ(number_text(123456.7), "123,457");
  EXPECT_EQ(number_text(9999.4), "9999");
  EXPECT_EQ(number_text(9999.7), "10,000");
  EXPECT_EQ(number_text(1e20), "1e+20");
  EXPECT_EQ(number_text(NAN), "not a number");
  EXPECT_EQ(value_text(true), "yes");
  EXPECT_EQ(value_text(nullptr), "–");
}

TEST(HtmlText, NothingOfTheDataIsMarkup) {
  Html page;
  page.add("<td title=\"{}\">{}</td>{}{}", "a\"b", "<script>&'", Html::Raw{"<br>"}, 3);
  EXPECT_EQ(page.text(), "<td title=\"a&quot;b\">&lt;script&gt;&amp;&#39;</td><br>3");
}

}  // namespace
}  // namespace lodestone
