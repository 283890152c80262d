// lodestone report: one HTML file of what sweeps have found, made by the Python package lodestone_report (python/).
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "core/base/error.h"
#include "experiments/command_line/data_folder.h"
#include "experiments/commands/command.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

struct ReportOptions {
  std::vector<std::string> folders;
  std::string output, csv;
  int pictures = 16;
};

// The folder of the package: beside the installed program, or else in the sources that it was built from.
fs::path find_package() {
  if (const auto folder = find_data_folder(LODESTONE_PYTHON_INSTALLED, LODESTONE_PYTHON_SOURCE, "lodestone_report"))
    return *folder;
  throw FileError(describe(LODESTONE_PYTHON_SOURCE, "", "no Python package lodestone_report",
                           "install Lodestone again, with its folder share/lodestone/python"));
}

// Replaces this process, which holds nothing that has to be cleaned up; returns only if there is no such interpreter.
void execute(const std::string& interpreter, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {interpreter, "-B", "-m", "lodestone_report"});
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  execvp(interpreter.c_str(), pointers.data());
}

std::vector<std::string> python_arguments(const ReportOptions& options, const CommonOptions& common) {
  std::vector<std::string> arguments{"--output=" + options.output, "--pictures=" + std::to_string(options.pictures)};
  if (!options.csv.empty()) arguments.push_back("--csv=" + options.csv);
  if (!common.json.empty()) arguments.push_back("--json=" + common.json);
  if (common.quiet) arguments.emplace_back("--quiet");
  arguments.emplace_back("--");
  arguments.insert(arguments.end(), options.folders.begin(), options.folders.end());
  return arguments;
}

// Runs the package in $LODESTONE_PYTHON, or else in python3 of the path or of the system. The package itself goes on in
// the system's Python where the first lacks a module.
void run(const ReportOptions& options, const CommonOptions& common) {
  std::vector<FileArgument> outputs{{"--output", options.output, ".html"}};
  if (!options.csv.empty()) outputs.push_back({"--csv", options.csv, ".csv"});
  check_files(common, {}, outputs);
  const char* more = std::getenv("PYTHONPATH");
  const std::string path = find_package().string() + (more != nullptr ? std::string(":") + more : "");
  setenv("PYTHONPATH", path.c_str(), 1);
  setenv("PYTHONSAFEPATH", "1", 1);  // modules of the current folder are none of the report's
  const std::vector<std::string> arguments = python_arguments(options, common);
  const char* chosen = std::getenv("LODESTONE_PYTHON");
  execute(chosen != nullptr ? chosen : "python3", arguments);
  if (chosen == nullptr) execute("/usr/bin/python3", arguments);
  throw UnsupportedError(
      describe(chosen != nullptr ? chosen : "python3", "",
               std::string("the report needs Python, which cannot be started: ") + std::strerror(errno),
               "apt-get install python3 python3-jinja2 python3-matplotlib (scripts/setup report does)"));
}

OptionTable declare(ReportOptions& o) {
  return {OptionSpec{"DIR", &o.folders, "Directories that `lodestone sweep` wrote to; finished or not"}.must(),
          OptionSpec{"-o,--output", &o.output,
                     "The page, FILE.html; each figure is written as SVG, PDF and CSV to FILE_figures, too"}
              .must(),
          {"--csv", &o.csv, "Also write every row, with parameters and data, as FILE.csv"},
          OptionSpec{"--pictures", &o.pictures, "MiB of the runs' pictures that the page may hold; 0: none"}.between(
              0, 1024)};
}

}  // namespace

void add_report(CommandTable& commands) {
  define_command<ReportOptions>(
      commands,
      {"report", "Write what sweeps have found as one web page that opens from disk",
       "  lodestone report ablation -o ablation.html\n"
       "  lodestone report scaling accuracy -o report.html --csv rows.csv --json report.json\n"
       "  lodestone report ablation -o small.html --pictures 0\n"},
      declare, run);
}

}  // namespace lodestone
