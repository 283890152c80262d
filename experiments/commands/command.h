// Common parts of the subcommands: names of files, interruption, results as JSON.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/files/json.h"
#include "core/mesh/indexed_mesh.h"
#include "experiments/command_line/options.h"
#include "parallel/scheduler/clock.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

[[nodiscard]] std::unique_ptr<Scheduler> make_scheduler(const CommonOptions& common);

struct FileArgument {
  std::string option;          // as the user knows it: "IN", "--output"
  std::string path;            // empty: given as an empty word
  std::string extension = {};  // that an output must have, with its dot; empty: any
};

// The files given for one option.
[[nodiscard]] std::vector<FileArgument> file_arguments(const std::string& option,
                                                       const std::vector<std::string>& files);

// Looks at the file names of a command line, the file of --json included, before any work: a typing error costs a line,
// not a night or a model. Throws UsageError when a name is empty or has another extension than asked for, or when an
// output would replace an input or another output; FileError when an output cannot be created. Leaves no trace in any
// folder. Inputs are not opened. Pipes and devices may be outputs under any name.
void check_files(const CommonOptions& common, const std::vector<FileArgument>& inputs,
                 std::vector<FileArgument> outputs = {});

// Raises the number of files that may be open as far as the system allows: a model may lie in thousands.
void allow_many_files();

// Ctrl-C and SIGTERM end the process at once, with one line, a status of 128 + signal and no temporary left. A command
// that has more to clean up, or ends more tidily, takes the flag and looks at it often: then the first signal only sets
// it, and the second one ends the process.
// A write beyond the shell's limit of file sizes becomes an error of that write; a mapped file that becomes shorter
// while it is read ends the process with a line that names it and ExitStatus::file.
void install_signal_handlers();
[[nodiscard]] const CancelFlag& interrupt_flag();
// Throws Cancelled when the flag is set.
void check_interrupt();
// The line, with its end, that is printed when the command is interrupted; a literal.
void set_interrupt_line(const char* line);
[[nodiscard]] const char* interrupt_line();
// 128 + signal, once the flag is set.
[[nodiscard]] int interrupt_status();

// Writes the file of --json, aside and renamed; "-" prints.
void write_result(const CommonOptions& common, const Json& result);

[[nodiscard]] Json to_json(const StageTime& time);
[[nodiscard]] Json to_json(const Repairs& repairs);
void print_repairs(const Repairs& repairs);  // a line for each kind that there was

void add_generate(CommandTable& commands);
void add_build(CommandTable& commands);
void add_info(CommandTable& commands);
void add_verify(CommandTable& commands);
void add_compare(CommandTable& commands);
void add_render(CommandTable& commands);
void add_export(CommandTable& commands);
void add_view(CommandTable& commands);
void add_reconstruct(CommandTable& commands);
void add_progressive(CommandTable& commands);
void add_spherical(CommandTable& commands);
void add_lod(CommandTable& commands);
void add_page(CommandTable& commands);
void add_report(CommandTable& commands);
void add_sweep(CommandTable& commands);  // and the subcommand of its children, which is hidden
void add_merge(CommandTable& commands);
void add_experiments(CommandTable& commands);
// They describe all subcommands of the table when they are called; it must outlive that.
void add_completion(CommandTable& commands);
void add_manual(CommandTable& commands);

}  // namespace lodestone
