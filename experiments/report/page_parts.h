// The parts of the report's page, a function each; they append to the page.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "experiments/report/html.h"
#include "experiments/report/report.h"

namespace lodestone {

// What headings and anchors of a study are made with.
struct SectionPlace {
  std::string prefix;  // of ids: "s1"
  int level = 2;       // of the study's sections' headings: <h2> ...
};

void add_heading(Html& page, int level, const std::string& text, const std::string& id = {});
// <table> in a box that scrolls by itself; close it with close_table(). The caption also names the box.
void open_table(Html& page, const std::string& caption, const char* classes = "");
void close_table(Html& page);

// Figure by figure: plot, what it shows, the cheapest settings where there is a front, and its numbers.
void add_figures(Html& page, const StudyReport& entry, const Plots& plots, std::size_t first_plot,
                 const SectionPlace& place);
// Settings of each sweep, aggregated; what is the same everywhere is said once above.
void add_setting_tables(Html& page, const StudyReport& entry, const SectionPlace& place);
// Runs that are left out or incomplete, and why; the rows that did not verify.
void add_problems(Html& page, const StudyReport& entry, const SectionPlace& place);
void add_manifest(Html& page, const StudyReport& entry, const SectionPlace& place);

// What is still to be had of the bytes for pictures, and what has been left out.
struct PictureBudget {
  std::uint64_t bytes = 0;
  std::size_t left_out = 0;
  std::set<std::string> seen;  // runs may be of several sweeps
};
void add_pictures(Html& page, const StudyReport& entry, PictureBudget& budget, const SectionPlace& place);

}  // namespace lodestone
