// lodestone report: one HTML file of what sweeps have found.
#include <fmt/core.h>

#include <span>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "experiments/command_line/progress.h"
#include "experiments/commands/command.h"
#include "experiments/report/page.h"

namespace lodestone {
namespace {

struct ReportOptions {
  std::vector<std::string> folders;
  std::string output, csv;
  int pictures = 16;
};

void write_text(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

// The report tells why nothing is reported; whoever waits for figures learns it here.
void require_rows(const Report& report, const std::string& output) {
  const RunCounts counts = report.counts();
  if (counts.reported() > 0) return;
  throw InputError(fmt::format(
      "{}: written, but no run has rows that verified: of {} runs, {} did not verify, {} failed, {} are not yet run",
      output, counts.runs, counts.unverified, counts.failed, counts.missing));
}

void print_summary(const Report& report, const ReportOptions& options) {
  for (const StudyReport& entry : report.studies) {
    const RunCounts& counts = entry.counts;
    fmt::print("{}: {} runs, {} verified, {} not verified, {} failed, {} missing\n", entry.study.title, counts.runs,
               counts.reported(), counts.unverified, counts.failed, counts.missing);
    for (const std::string& oddity : entry.oddities) fmt::print("note: {}\n", oddity);
    for (const Figure& figure : entry.figures) fmt::print("  {}: {}\n", figure.title, figure.outcome);
  }
  if (!report.plots.note.empty()) fmt::print("note: {}\n", report.plots.note);
  fmt::print("{}: opens in any browser, from disk\n", options.output);
}

void run(const ReportOptions& options, const CommonOptions& common) {
  std::vector<FileArgument> outputs{{"--output", options.output, ".html"}};
  if (!options.csv.empty()) outputs.push_back({"--csv", options.csv, ".csv"});
  check_files(common, {}, outputs);
  Progress progress("drawing", common.quiet);
  progress.phase("drawing");
  const Report report = make_report({options.folders.begin(), options.folders.end()});
  PageConfig config;
  config.picture_bytes = static_cast<std::uint64_t>(options.pictures) << 20;
  write_text(options.output, make_page(report, config));
  if (!options.csv.empty()) write_text(options.csv, to_csv(report));
  write_json(common, to_json(report));
  progress.clear();
  require_rows(report, options.output);
  if (!common.quiet && common.json != "-") print_summary(report, options);
}

}  // namespace

void add_report(CLI::App& app) {
  const auto common = std::make_shared<CommonOptions>();
  const auto options = std::make_shared<ReportOptions>();
  CLI::App& command =
      add_command(app, "report", "Write what sweeps have found as one web page that opens from disk",
                  "  lodestone report ablation -o ablation.html\n"
                  "  lodestone report scaling accuracy -o report.html --csv rows.csv --json report.json\n"
                  "  lodestone report ablation -o small.html --pictures 0\n",
                  common);
  command.add_option("DIR", options->folders, "Directories that `lodestone sweep` wrote to; finished or not")
      ->required();
  command.add_option("-o,--output", options->output, "The page, FILE.html")->required();
  command.add_option("--csv", options->csv, "Also write every row, with parameters and data, as FILE.csv");
  command.add_option("--pictures", options->pictures, "MiB of the runs' pictures that the page may hold; 0: none")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command.callback([options, common] { run(*options, *common); });
}

}  // namespace lodestone
