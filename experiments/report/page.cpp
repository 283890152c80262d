#include "experiments/report/page.h"

#include <fmt/core.h>

#include "experiments/report/assets.h"
#include "experiments/report/number_text.h"
#include "experiments/report/page_parts.h"

namespace lodestone {
namespace {

using Raw = Html::Raw;
using nlohmann::json;

std::string plain(std::size_t count) { return number_text(static_cast<double>(count)); }

std::string title_of(const Report& report) {
  return report.studies.size() == 1 ? report.studies.front().study.title : "Lodestone report";
}

// A script element ends at the first "</", whatever the string around it.
std::string script_safe(const json& value) {
  std::string safe;
  for (const char c : value.dump(-1, ' ', false, json::error_handler_t::replace))
    safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return safe;
}

void add_tile(Html& page, const char* kind, std::size_t count, const char* what) {
  page.add("<li class=\"{}\"><strong>{}</strong> {}</li>\n", count > 0 ? kind : "none", plain(count), what);
}

void add_top(Html& page, const Report& report) {
  const RunCounts counts = report.counts();
  page.raw("<header>\n<p class=\"kicker\">Lodestone report</p>\n");
  page.add("<h1>{}</h1>\n", title_of(report));
  if (report.studies.size() == 1 && !report.studies.front().study.question.empty())
    page.add("<p class=\"question\">{}</p>\n", report.studies.front().study.question);
  page.raw("<ul class=\"tiles\" aria-label=\"Runs\">\n");
  add_tile(page, "", counts.runs, counts.runs == 1 ? "run" : "runs");
  add_tile(page, "good", counts.reported(), "verified");
  add_tile(page, "bad", counts.unverified, "not verified");
  add_tile(page, "bad", counts.failed, "failed");
  add_tile(page, "open", counts.missing, "missing");
  page.raw(
      "</ul>\n<p class=\"downloads\" hidden><button type=\"button\" data-save=\"csv\">Save all rows as CSV</button>\n"
      "<button type=\"button\" data-save=\"json\">Save everything as JSON</button></p>\n</header>\n");
}

void add_state_cell(Html& page, std::size_t count, bool bad) {
  page.add("<td class=\"n{}\">{}</td>", bad && count > 0 ? " warn" : "", plain(count));
}

void add_sweeps(Html& page, const StudyReport& entry) {
  open_table(page, "Runs by sweep");
  page.raw(
      "<thead><tr><th scope=\"col\">sweep</th><th scope=\"col\">experiment</th><th scope=\"col\">asks</th>"
      "<th scope=\"col\" class=\"n\">runs</th><th scope=\"col\" class=\"n\">verified</th>"
      "<th scope=\"col\" class=\"n\">not verified</th><th scope=\"col\" class=\"n\">failed</th>"
      "<th scope=\"col\" class=\"n\">missing</th><th scope=\"col\" "
      "class=\"n\">repetitions</th></tr></thead>\n<tbody>\n");
  for (const SweepRecord& sweep : entry.study.sweeps) {
    const RunCounts counts = count_runs(sweep);
    page.add(
        "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"long\">{}</td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td>",
        sweep.name, sweep.experiment, sweep.question, plain(counts.runs), plain(counts.reported()));
    add_state_cell(page, counts.unverified, true);
    add_state_cell(page, counts.failed, true);
    add_state_cell(page, counts.missing, true);
    page.add("<td class=\"n\">{}</td></tr>\n", sweep.repetitions);
  }
  page.raw("</tbody>");
  close_table(page);
}

void add_summary(Html& page, const StudyReport& entry, const SectionPlace& place) {
  add_heading(page, place.level, "Summary", place.prefix + "-summary");
  if (!entry.oddities.empty()) {
    page.raw("<div class=\"note\" role=\"note\"><p>To know when reading this:</p>\n<ul>\n");
    for (const std::string& oddity : entry.oddities) page.add("<li>{}</li>\n", oddity);
    page.raw("</ul></div>\n");
  }
  if (!entry.figures.empty()) {
    page.raw("<dl class=\"outcomes\">\n");
    for (std::size_t i = 0; i < entry.figures.size(); ++i)
      page.add("<div><dt><a href=\"#{}-figure-{}\">{}</a></dt><dd>{}</dd></div>\n", place.prefix, i + 1,
               entry.figures[i].title, entry.figures[i].outcome);
    page.raw("</dl>\n");
  }
  add_sweeps(page, entry);
}

void add_links(Html& page, const StudyReport& entry, const SectionPlace& place) {
  page.add("<nav aria-label=\"Parts of {}\"><ul>\n", entry.study.title);
  for (const char* part : {"Summary", "Figures", "Tables", "Pictures", "Problems", "Manifest"}) {
    std::string anchor = part;
    anchor.front() = static_cast<char>(anchor.front() - 'A' + 'a');
    page.add("<li><a href=\"#{}-{}\">{}</a></li>\n", place.prefix, anchor, part);
  }
  page.raw("</ul></nav>\n");
}

void add_study(Html& page, const Report& report, std::size_t index, std::size_t first_plot, PictureBudget& budget) {
  const StudyReport& entry = report.studies[index];
  const bool alone = report.studies.size() == 1;
  const SectionPlace place{fmt::format("s{}", index + 1), alone ? 2 : 3};
  page.add("<section class=\"study\" id=\"{}\">\n", place.prefix);
  if (!alone) {
    add_heading(page, 2, entry.study.title);
    if (!entry.study.question.empty()) page.add("<p class=\"question\">{}</p>\n", entry.study.question);
  }
  add_links(page, entry, place);
  add_summary(page, entry, place);
  add_figures(page, entry, report.plots, first_plot, place);
  add_setting_tables(page, entry, place);
  add_pictures(page, entry, budget, place);
  add_problems(page, entry, place);
  add_manifest(page, entry, place);
  page.raw("</section>\n");
}

void add_data(Html& page, const Report& report) {
  page.add("<script type=\"application/json\" id=\"data-json\">{}</script>\n", Raw{script_safe(to_json(report))});
  page.add("<script type=\"application/json\" id=\"data-csv\">{}</script>\n", Raw{script_safe(to_csv(report))});
}

}  // namespace

void add_heading(Html& page, int level, const std::string& text, const std::string& id) {
  if (id.empty())
    page.add("<h{0}>{1}</h{0}>\n", level, text);
  else
    page.add("<h{0} id=\"{2}\">{1}</h{0}>\n", level, text, id);
}

void open_table(Html& page, const std::string& caption, const char* classes) {
  page.add(
      "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{0}\"><table class=\"{1}\">"
      "<caption>{0}</caption>\n",
      caption, classes);
}

void close_table(Html& page) { page.raw("</table></div>\n"); }

std::string make_page(const Report& report, const PageConfig& config) {
  Html page;
  page.raw(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n");
  page.add("<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n", title_of(report),
           Raw{std::string(report_style())});
  add_top(page, report);
  if (report.studies.size() > 1) {
    page.raw("<nav aria-label=\"Studies\"><ul>\n");
    for (std::size_t i = 0; i < report.studies.size(); ++i)
      page.add("<li><a href=\"#s{}\">{}</a></li>\n", i + 1, report.studies[i].study.title);
    page.raw("</ul></nav>\n");
  }
  PictureBudget budget;
  budget.bytes = config.picture_bytes;
  std::size_t first_plot = 0;
  for (std::size_t i = 0; i < report.studies.size(); ++i) {
    add_study(page, report, i, first_plot, budget);
    first_plot += report.studies[i].figures.size();
  }
  page.raw("</main>\n");
  add_data(page, report);
  page.add("<script>\n{}</script>\n</body>\n</html>\n", Raw{std::string(report_script())});
  return page.text();
}

}  // namespace lodestone
