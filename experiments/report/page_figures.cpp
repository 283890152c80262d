#include <fmt/core.h>

#include "experiments/report/number_text.h"
#include "experiments/report/page_parts.h"

namespace lodestone {
namespace {

using Raw = Html::Raw;

std::string unit_text(const std::string& unit) { return unit.empty() ? "" : " " + unit; }

std::string heading_cell(const std::string& name, const std::string& unit, bool number = true) {
  return fmt::format("<th scope=\"col\"{}>{}{}</th>", number ? " class=\"n\"" : "", escape_html(name),
                     unit.empty() ? "" : fmt::format(" <small>{}</small>", escape_html(unit)));
}

std::string x_text(const Figure& figure, const FigurePoint& point) {
  return figure.categories.empty() ? number_text(point.x) : figure.categories.at(static_cast<std::size_t>(point.x));
}

std::string range_text(double value, double least, double most) {
  if (least == value && most == value) return "";
  return fmt::format(" <small>{} – {}</small>", number_text(least), number_text(most));
}

void add_choices(Html& page, const Figure& figure, const FigurePanel& panel) {
  open_table(page, fmt::format("Cheapest setting for a given {}", panel.y_name), "sort");
  page.add("<thead><tr><th scope=\"col\">input</th>{}{}{}<th scope=\"col\">setting</th></tr></thead>\n<tbody>\n",
           Raw{heading_cell(fmt::format("{} {}", panel.y_name, limit_text(panel)), panel.y_unit)},
           Raw{heading_cell(figure.x_name, figure.x_unit)}, Raw{heading_cell(panel.y_name, panel.y_unit)});
  for (const FigureFront& front : panel.fronts)
    for (const FigureFront::Choice& choice : front.choices) {
      const FigurePoint& p = front.points.at(choice.point);
      page.add(
          "<tr><th scope=\"row\">{}</th><td class=\"n\" data-v=\"{}\">{}</td><td class=\"n\" data-v=\"{}\">{}</td>"
          "<td class=\"n\" data-v=\"{}\">{}</td><td class=\"long\">{}</td></tr>\n",
          front.data, choice.limit, number_text(choice.limit), p.x, number_text(p.x), p.y, number_text(p.y), p.label);
    }
  page.raw("</tbody>");
  close_table(page);
}

void add_numbers(Html& page, const Figure& figure) {
  page.raw("<details><summary>The numbers of this figure</summary>\n");
  for (const FigurePanel& panel : figure.panels) {
    open_table(page, fmt::format("{} over {}", panel.y_name, figure.x_name), "sort");
    page.add("<thead><tr><th scope=\"col\">curve</th>{}{}<th scope=\"col\">setting</th></tr></thead>\n<tbody>\n",
             Raw{heading_cell(figure.x_name, figure.x_unit, figure.categories.empty())},
             Raw{heading_cell(panel.y_name, panel.y_unit)});
    for (const FigureSeries& series : panel.series)
      for (const FigurePoint& p : series.points)
        page.add(
            "<tr><th scope=\"row\">{}</th><td{}>{}</td><td class=\"n\" data-v=\"{}\">{}{}</td><td "
            "class=\"long\">{}</td></tr>\n",
            series.name.empty() ? panel.y_name : series.name,
            Raw{figure.categories.empty() ? fmt::format(" class=\"n\" data-v=\"{}\"", p.x) : std::string()},
            x_text(figure, p), p.y, number_text(p.y), Raw{range_text(p.y, p.y_least, p.y_most)}, p.label);
    page.raw("</tbody>");
    close_table(page);
  }
  page.raw("</details>\n");
}

std::size_t count_points(const Figure& figure) {
  std::size_t points = 0;
  for (const FigurePanel& panel : figure.panels)
    for (const FigureSeries& series : panel.series) points += series.points.size();
  return points;
}

// What somebody who does not see the plot is told: what is drawn, and what it shows.
std::string alternative(const Figure& figure) {
  std::string columns;
  for (const FigurePanel& panel : figure.panels)
    columns += (columns.empty() ? "" : "; ") + panel.y_name + unit_text(panel.y_unit);
  const char* kind = figure.kind == "bar" ? "Bars" : figure.kind == "scatter" ? "Points" : "Curves";
  return fmt::format("{} of {} over {}{}, {} points. {}", kind, columns, figure.x_name, unit_text(figure.x_unit),
                     count_points(figure), figure.outcome);
}

void add_figure(Html& page, const Figure& figure, const Plot* plot, const std::string& id, int level) {
  page.add("<figure class=\"plot\" id=\"{}\">\n", id);
  add_heading(page, level, figure.title);
  if (plot != nullptr && count_points(figure) > 0)
    page.add("<div role=\"img\" aria-label=\"{}\"><div class=\"wide\">{}</div><div class=\"narrow\">{}</div></div>\n",
             alternative(figure), Raw{plot->wide}, Raw{plot->narrow});
  page.add("<figcaption>{}", figure.outcome);
  for (const std::string& note : figure.notes) page.add(" <span class=\"aside\">{}.</span>", note);
  page.raw("</figcaption>\n");
  for (const FigurePanel& panel : figure.panels)
    if (!panel.fronts.empty()) add_choices(page, figure, panel);
  if (count_points(figure) > 0) add_numbers(page, figure);
  page.raw("</figure>\n");
}

}  // namespace

void add_figures(Html& page, const StudyReport& entry, const Plots& plots, std::size_t first_plot,
                 const SectionPlace& place) {
  add_heading(page, place.level, "Figures", place.prefix + "-figures");
  if (entry.figures.empty())
    page.raw("<p class=\"aside\">The sweep's file asks for no figure.</p>\n");
  else if (!plots.note.empty())
    page.add("<div class=\"note\" role=\"note\"><p>{}</p></div>\n", plots.note);
  for (std::size_t i = 0; i < entry.figures.size(); ++i)
    add_figure(page, entry.figures[i], plots.plots.empty() ? nullptr : &plots.plots.at(first_plot + i),
               fmt::format("{}-figure-{}", place.prefix, i + 1), place.level + 1);
}

}  // namespace lodestone
