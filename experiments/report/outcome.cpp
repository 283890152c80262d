#include "experiments/report/outcome.h"

#include <fmt/core.h>

#include <algorithm>

#include "experiments/report/number_text.h"

namespace lodestone {
namespace {

std::string with_unit(double value, const std::string& unit) {
  return number_text(value) + (unit.empty() ? "" : " " + unit);
}

std::string range_text(const std::vector<OutcomePoint>& points, const std::string& unit) {
  const auto [least, most] =
      std::minmax_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  if (number_text(least->y) == number_text(most->y)) return with_unit(least->y, unit);
  return fmt::format("{} to {}", number_text(least->y), with_unit(most->y, unit));
}

std::string place_text(const Figure& figure, const OutcomePoint& point) {
  const std::string x = figure.categories.empty() ? with_unit(point.x, figure.x_unit)
                                                  : figure.categories.at(static_cast<std::size_t>(point.x));
  return fmt::format("{} = {}{}", figure.x_name, x, point.label.empty() ? "" : ", " + point.label);
}

// The limit in the middle: neither the trivial nor the dearest.
std::string describe_front(const Figure& figure, const FigurePanel& panel, const FigureFront& front) {
  const auto& choice = front.choices.at(front.choices.size() / 2);
  const FigurePoint& point = front.points.at(choice.point);
  return fmt::format("{}{} of {} settings on the front; {} of {} {} costs {}{}",
                     panel.fronts.size() > 1 ? front.data + ": " : "", front.points.size(), front.candidates,
                     panel.y_name, limit_text(panel), with_unit(choice.limit, panel.y_unit),
                     with_unit(point.x, figure.x_unit), point.label.empty() ? "" : " (" + point.label + ")");
}

std::string describe_fronts(const Figure& figure, const FigurePanel& panel) {
  constexpr std::size_t shown = 2;
  std::string text;
  for (std::size_t i = 0; i < std::min(shown, panel.fronts.size()); ++i)
    text += (i > 0 ? ". " : "") + describe_front(figure, panel, panel.fronts[i]);
  if (panel.fronts.size() > shown) text += fmt::format(". {} more inputs below", panel.fronts.size() - shown);
  return text;
}

std::string describe_sides(const FigurePanel& panel, const std::string& mark, const std::vector<OutcomePoint>& points) {
  std::vector<OutcomePoint> left, right;
  for (const OutcomePoint& p : points)
    if (p.mark) (p.x < *p.mark ? left : right).push_back(p);
  const auto side = [&](const char* where, const std::vector<OutcomePoint>& there) {
    if (there.empty()) return fmt::format("no setting {} {}", where, mark);
    const auto above = std::count_if(there.begin(), there.end(), [](const OutcomePoint& p) { return p.y > 0; });
    const std::string some =
        above > 0 && static_cast<std::size_t>(above) < there.size() ? fmt::format(", above 0 at {}", above) : "";
    return fmt::format("{} {} ({}) {}{}", where, mark, counted(there.size(), "setting"),
                       range_text(there, panel.y_unit), some);
  };
  return fmt::format("{}: {}; {}", panel.y_name, side("from", right), side("below", left));
}

std::string describe_range(const Figure& figure, const FigurePanel& panel, const std::vector<OutcomePoint>& points) {
  const auto [least, most] =
      std::minmax_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  if (number_text(least->y) == number_text(most->y))
    return fmt::format("{} is {} at all {} points", panel.y_name, with_unit(least->y, panel.y_unit), points.size());
  return fmt::format("{} from {} ({}) to {} ({})", panel.y_name, with_unit(least->y, panel.y_unit),
                     place_text(figure, *least), with_unit(most->y, panel.y_unit), place_text(figure, *most));
}

}  // namespace

std::string describe_outcome(const Figure& figure, const std::string& mark,
                             const std::vector<std::vector<OutcomePoint>>& panels) {
  std::string text;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const FigurePanel& panel = figure.panels[i];
    const bool marked =
        std::any_of(panels[i].begin(), panels[i].end(), [](const auto& p) { return p.mark.has_value(); });
    const bool fronts =
        std::any_of(panel.fronts.begin(), panel.fronts.end(), [](const auto& f) { return !f.choices.empty(); });
    text += text.empty() ? "" : ". ";
    if (panels[i].empty())
      text += fmt::format("No setting that verified has numbers for {}", panel.y_name);
    else if (fronts)
      text += describe_fronts(figure, panel);
    else if (marked && !mark.empty())
      text += describe_sides(panel, mark, panels[i]);
    else
      text += describe_range(figure, panel, panels[i]);
  }
  return text + ".";
}

}  // namespace lodestone
