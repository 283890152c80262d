// What the subcommands have in common: shared options, progress, interruption, results as JSON.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/mesh/indexed_mesh.h"
#include "experiments/commands/files.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

struct CommonOptions {
  std::string json;  // file for machine-readable results; empty: none; "-": standard output
  int threads = 0;   // 0: all that the machine has
  bool quiet = false;
};

// A subcommand of `app` that runs `body` when it is given on the command line. --json, --threads and --quiet are added.
CLI::App& add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::string& examples, const std::shared_ptr<CommonOptions>& common);

[[nodiscard]] std::unique_ptr<Scheduler> make_scheduler(const CommonOptions& common);

// check_files() with the file of --json among the outputs.
void check_files(const CommonOptions& common, const std::vector<FileArgument>& inputs,
                 std::vector<FileArgument> outputs = {});

// Ctrl-C and SIGTERM end the process at once, with one line, a status of 128 + signal and no temporary left. A command
// that has more to clean up, or ends more tidily, takes the flag and looks at it often: then the first signal only sets
// it, and the second one ends the process.
// A write beyond the shell's limit of file sizes becomes an error of that write.
void install_interrupt_handler();
[[nodiscard]] const CancelFlag& interrupt_flag();
// Throws Cancelled when the flag is set.
void check_interrupt();
// What is printed when the command was interrupted, a line with its end; a literal.
void set_interrupt_line(const char* line);
[[nodiscard]] const char* interrupt_line();
// 128 + signal, once the flag is set.
[[nodiscard]] int interrupt_status();

// Written aside and renamed; "-" prints.
void write_json(const CommonOptions& common, const nlohmann::json& result);

[[nodiscard]] nlohmann::json to_json(const StageTime& time);
[[nodiscard]] nlohmann::json to_json(const Repairs& repairs);
void print_repairs(const Repairs& repairs);  // a line for each kind that there was

void add_generate(CLI::App& app);
void add_build(CLI::App& app);
void add_info(CLI::App& app);
void add_verify(CLI::App& app);
void add_compare(CLI::App& app);
void add_render(CLI::App& app);
void add_export(CLI::App& app);
void add_view(CLI::App& app);
void add_reconstruct(CLI::App& app);
void add_progressive(CLI::App& app);
void add_lod(CLI::App& app);
void add_page(CLI::App& app);
void add_report(CLI::App& app);
void add_sweep(CLI::App& app);  // and the subcommand of its children, which no help mentions
void add_experiments(CLI::App& app);

}  // namespace lodestone
