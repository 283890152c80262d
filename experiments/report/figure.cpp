#include "experiments/report/figure.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "experiments/metrics/cost/order_statistics.h"
#include "experiments/metrics/cost/pareto.h"
#include "experiments/report/number_text.h"
#include "experiments/report/outcome.h"

namespace lodestone {
namespace {

using nlohmann::json;

// A number of a setting that the figure shows.
struct Sample {
  std::size_t panel = 0;
  std::string series, data;
  json x;  // as it is in the row
  FigurePoint point;
  std::optional<double> mark;
};

// Parameters and labels that vary in any of the tables; with several tables, the sweep itself.
std::vector<std::string> varied_in(const std::vector<const SettingTable*>& tables) {
  std::vector<std::string> names;
  if (tables.size() > 1) names.emplace_back("sweep");
  for (const SettingTable* table : tables)
    for (const std::string& name : table->varied)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

const ColumnInfo* find_column(const std::vector<const SettingTable*>& tables, const std::string& name) {
  for (const SettingTable* table : tables)
    if (const ColumnInfo* column = table->find(name)) return column;
  return nullptr;
}

// Columns of the same unit share a panel; not where fronts are drawn, since a front is that of one error.
std::vector<FigurePanel> make_panels(const FigureRequest& spec, const std::vector<const SettingTable*>& tables,
                                     std::vector<std::size_t>& panel_of) {
  std::vector<FigurePanel> panels;
  for (const std::string& y : spec.y) {
    const ColumnInfo* column = find_column(tables, y);
    const std::string unit = shown_unit(column != nullptr ? column->unit : "").name;
    const auto same = std::find_if(panels.begin(), panels.end(), [&](const FigurePanel& p) {
      return p.y_unit == unit && !unit.empty() && !spec.pareto;
    });
    panel_of.push_back(static_cast<std::size_t>(same - panels.begin()));
    if (same == panels.end())
      panels.push_back({y, unit, column != nullptr && column->kind == ColumnInfo::Kind::quality, {}, {}});
    else
      same->y_name += ", " + y;
  }
  return panels;
}

// "sphere, step, kappa0 = 2": texts speak for themselves.
std::string series_name(const SettingRow& setting, const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    const json& value = setting.at(name).value;
    if (!text.empty()) text += ", ";
    text += value.is_string() ? value.get<std::string>() : name + " = " + value_text(value);
  }
  return text;
}

FigurePoint make_point(const SettingCell& x, const SettingCell& y, double x_divisor, double y_divisor) {
  FigurePoint point;
  if (x.is_number())
    point.x = x.number() / x_divisor, point.x_least = x.least / x_divisor, point.x_most = x.most / x_divisor;
  point.y = y.number() / y_divisor, point.y_least = y.least / y_divisor, point.y_most = y.most / y_divisor;
  return point;
}

class Sampler {
 public:
  Sampler(const FigureRequest& spec, const std::vector<const SettingTable*>& tables, Figure& figure)
      : spec_(spec), tables_(tables), figure_(figure) {
    figure.panels = make_panels(spec, tables, panel_of_);
  }

  std::vector<Sample> sample() {
    std::vector<std::string> told = varied_in(tables_);
    std::erase(told, spec_.x);
    for (const SettingTable* table : tables_)
      for (const SettingRow& setting : table->settings)
        for (std::size_t i = 0; i < spec_.y.size(); ++i) add(*table, setting, i, told);
    if (without_ > 0)
      figure_.notes.push_back(
          fmt::format("{} of {} points have no number and are left out", without_, without_ + samples_.size()));
    return std::move(samples_);
  }

 private:
  double divisor(const SettingTable& table, const std::string& name) const {
    const ColumnInfo* column = table.find(name);
    return column != nullptr ? shown_unit(column->unit).divisor : 1;
  }

  void add(const SettingTable& table, const SettingRow& setting, std::size_t i, const std::vector<std::string>& told) {
    const SettingCell& x = setting.at(spec_.x);
    const SettingCell& y = setting.at(spec_.y[i]);
    if (x.value.is_null() || !y.is_number() || !std::isfinite(y.number())) {
      ++without_;
      return;
    }
    Sample sample;
    sample.panel = panel_of_[i];
    sample.series = series_name(setting, spec_.series);
    if (std::count(panel_of_.begin(), panel_of_.end(), sample.panel) > 1)
      sample.series = spec_.y[i] + (sample.series.empty() ? "" : ": " + sample.series);
    sample.data = value_text(setting.at("data").value);
    sample.x = x.value;
    sample.point = make_point(x, y, divisor(table, spec_.x), divisor(table, spec_.y[i]));
    sample.point.label = setting_label(setting, told);
    if (const SettingCell& mark = setting.at(spec_.mark); mark.is_number())
      sample.mark = mark.number() / divisor(table, spec_.x);
    samples_.push_back(std::move(sample));
  }

  const FigureRequest& spec_;
  const std::vector<const SettingTable*>& tables_;
  Figure& figure_;
  std::vector<std::size_t> panel_of_;  // of each y
  std::vector<Sample> samples_;
  std::size_t without_ = 0;
};

// Where x is no number, and for bars, points stand at 0, 1, 2 ...: numbers by size, anything else as it comes.
void set_categories(Figure& figure, std::vector<Sample>& samples) {
  const bool numbers = std::all_of(samples.begin(), samples.end(), [](const Sample& s) { return s.x.is_number(); });
  if (numbers && figure.kind != "bar") return;
  std::vector<json> values;
  for (const Sample& s : samples)
    if (std::find(values.begin(), values.end(), s.x) == values.end()) values.push_back(s.x);
  if (numbers)
    std::sort(values.begin(), values.end(),
              [](const json& a, const json& b) { return a.get<double>() < b.get<double>(); });
  for (const json& value : values) figure.categories.push_back(value_text(value));
  for (Sample& s : samples)
    s.point.x = s.point.x_least = s.point.x_most =
        static_cast<double>(std::find(values.begin(), values.end(), s.x) - values.begin());
  figure.log_x = false;
}

// Points of one curve at one place: their median, and the range of all of them.
FigurePoint take_together(const std::vector<FigurePoint>& points) {
  FigurePoint together = points.front();
  std::vector<double> y;
  for (const FigurePoint& p : points) {
    y.push_back(p.y);
    together.x_least = std::min(together.x_least, p.x_least), together.x_most = std::max(together.x_most, p.x_most);
    together.y_least = std::min(together.y_least, p.y_least), together.y_most = std::max(together.y_most, p.y_most);
  }
  together.y = median_of(std::move(y));
  together.settings = points.size();
  if (points.size() > 1) together.label = fmt::format("median of {} settings", points.size());
  return together;
}

void add_series(Figure& figure, const std::vector<Sample>& samples) {
  bool together = false;
  for (std::size_t panel = 0; panel < figure.panels.size(); ++panel) {
    std::vector<FigureSeries>& all = figure.panels[panel].series;
    for (const Sample& s : samples) {
      if (s.panel != panel) continue;
      auto series = std::find_if(all.begin(), all.end(), [&](const FigureSeries& f) { return f.name == s.series; });
      if (series == all.end()) series = all.insert(all.end(), {s.series, {}});
      series->points.push_back(s.point);
    }
    if (figure.kind == "scatter") continue;
    for (FigureSeries& series : all) {
      std::map<double, std::vector<FigurePoint>> places;
      for (const FigurePoint& p : series.points) places[p.x].push_back(p);
      series.points.clear();
      for (const auto& [x, points] : places) {
        series.points.push_back(take_together(points));
        together = together || points.size() > 1;
      }
    }
  }
  if (together)
    figure.notes.emplace_back(
        "Several settings fall on one point: it is their median, and the whiskers are their range");
}

FigureFront make_front(const std::string& data, const std::vector<const Sample*>& members, bool more_is_better) {
  std::vector<CostError> points;
  for (const Sample* s : members) points.push_back({s->point.x, more_is_better ? -s->point.y : s->point.y});
  FigureFront front{data, points.size(), {}, {}};
  const std::vector<std::size_t> indices = pareto_front(points);
  for (const std::size_t i : indices) front.points.push_back(members[i]->point);
  if (more_is_better) {  // decibels and similarities have no scale of powers of ten
    for (std::size_t i = 0; i < indices.size(); ++i) front.choices.push_back({front.points[i].y, i});
    return front;
  }
  for (const double limit : error_limits(points))
    if (const auto i = cheapest_within(points, limit))
      front.choices.push_back(
          {limit, static_cast<std::size_t>(std::find(indices.begin(), indices.end(), *i) - indices.begin())});
  return front;
}

void add_fronts(Figure& figure, const std::vector<Sample>& samples) {
  if (!figure.categories.empty()) {
    figure.notes.emplace_back("No Pareto front: the cost is no number");
    return;
  }
  for (std::size_t panel = 0; panel < figure.panels.size(); ++panel) {
    std::map<std::string, std::vector<const Sample*>> inputs;
    for (const Sample& s : samples)
      if (s.panel == panel) inputs[s.data].push_back(&s);
    for (const auto& [data, members] : inputs)
      figure.panels[panel].fronts.push_back(make_front(data, members, figure.panels[panel].more_is_better));
  }
}

// A line for each different value; with several inputs it says whose.
void add_marks(Figure& figure, const std::vector<Sample>& samples, const std::string& name) {
  constexpr std::size_t most = 6;
  std::map<double, std::set<std::string>> places;
  std::set<std::string> inputs;
  for (const Sample& s : samples) {
    inputs.insert(s.data);
    if (s.mark && std::isfinite(*s.mark)) places[*s.mark].insert(s.data);
  }
  if (places.size() > most || !figure.categories.empty()) {
    figure.notes.push_back(
        fmt::format("{} is not drawn: {}", name,
                    figure.categories.empty() ? fmt::format("it has {} values", places.size()) : "x is no number"));
    return;
  }
  for (const auto& [x, whose] : places) {
    std::string label = name;
    if (inputs.size() > 1 && whose.size() < inputs.size()) {
      std::string list;
      for (const std::string& data : whose) list += (list.empty() ? "" : ", ") + data;
      label += " (" + list + ")";
    }
    figure.marks.push_back({x, label});
  }
}

}  // namespace

Figure make_figure(const FigureRequest& spec, const std::vector<const SettingTable*>& tables) {
  Figure figure;
  figure.title = spec.title, figure.kind = spec.kind;
  figure.log_x = spec.log_x, figure.log_y = spec.log_y;
  figure.x_name = spec.x;
  if (const ColumnInfo* x = find_column(tables, spec.x)) figure.x_unit = shown_unit(x->unit).name;
  std::vector<Sample> samples = Sampler(spec, tables, figure).sample();
  set_categories(figure, samples);
  add_series(figure, samples);
  if (spec.pareto) add_fronts(figure, samples);
  if (!spec.mark.empty()) add_marks(figure, samples, spec.mark);
  std::vector<std::vector<OutcomePoint>> points(figure.panels.size());
  for (const Sample& s : samples) points[s.panel].push_back({s.point.x, s.point.y, s.mark, s.point.label});
  figure.outcome = describe_outcome(figure, spec.mark, points);
  return figure;
}

namespace {

json to_json(const FigurePoint& p) {
  return {{"x", p.x},           {"x_least", p.x_least}, {"x_most", p.x_most},    {"y", p.y}, {"y_least", p.y_least},
          {"y_most", p.y_most}, {"label", p.label},     {"settings", p.settings}};
}

json to_json(const std::vector<FigurePoint>& points) {
  json list = json::array();
  for (const FigurePoint& p : points) list.push_back(to_json(p));
  return list;
}

json to_json(const FigurePanel& panel) {
  json series = json::array(), fronts = json::array();
  for (const FigureSeries& s : panel.series) series.push_back({{"name", s.name}, {"points", to_json(s.points)}});
  for (const FigureFront& f : panel.fronts) {
    json choices = json::array();
    for (const auto& choice : f.choices) choices.push_back({{"limit", choice.limit}, {"point", choice.point}});
    fronts.push_back(
        {{"data", f.data}, {"candidates", f.candidates}, {"points", to_json(f.points)}, {"choices", choices}});
  }
  return {{"y_name", panel.y_name},
          {"y_unit", panel.y_unit},
          {"more_is_better", panel.more_is_better},
          {"series", series},
          {"fronts", fronts}};
}

}  // namespace

json to_json(const Figure& figure) {
  json panels = json::array(), marks = json::array();
  for (const FigurePanel& panel : figure.panels) panels.push_back(to_json(panel));
  for (const FigureMark& mark : figure.marks) marks.push_back({{"x", mark.x}, {"label", mark.label}});
  return {{"title", figure.title},           {"kind", figure.kind},   {"x_name", figure.x_name},
          {"x_unit", figure.x_unit},         {"log_x", figure.log_x}, {"log_y", figure.log_y},
          {"categories", figure.categories}, {"panels", panels},      {"marks", marks},
          {"outcome", figure.outcome},       {"notes", figure.notes}};
}

}  // namespace lodestone
