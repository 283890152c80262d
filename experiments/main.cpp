// The `lodestone` command: build, look into, prove and draw hierarchical levels of detail.
//
// Exit status: 0 on success, 1 with one line on standard error for whatever went wrong, 128 + signal when interrupted.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "experiments/command_line/version.h"
#include "experiments/commands/command.h"
#include "experiments/commit.h"

namespace lodestone {
namespace {

// Names of files and messages of libraries may hold line ends; an error has one line.
void print_error(std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
  fmt::print(stderr, "lodestone: {}\n", message);
}

std::vector<std::string> names_in(const CLI::App& app, bool options) {
  std::vector<std::string> names;
  if (options)
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  else
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

// An unknown word is reported before a missing one: `lodestone biuld` is not a call without a subcommand.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const auto given = app.get_subcommands();
  const std::string command = given.empty() ? "lodestone" : "lodestone " + given.front()->get_name();
  const std::vector<std::string> unknown = app.remaining(true);
  std::string what = error.what(), meant;
  if (!unknown.empty()) {
    const bool is_option = unknown.front().starts_with('-');
    const char* kind = is_option ? "option" : given.empty() ? "subcommand" : "argument";
    what = fmt::format("unknown {} '{}'", kind, unknown.front());
    if (given.empty() || is_option)
      meant = did_you_mean(unknown.front(), names_in(given.empty() ? app : *given.front(), is_option));
  }
  return fmt::format("{}; see {} --help{}", what, command, meant);
}

int run(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    // Results that did not reach a full disk are an error.
    if (std::fflush(stdout) != 0) throw FileError(std::string("cannot write to standard output: ") + strerror(errno));
    return 0;
  } catch (const CLI::Success& e) {  // --help, --version
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    print_error(usage_error(app, e));
  } catch (const Cancelled&) {
    fmt::print(stderr, "{}", interrupt_line());
    return interrupt_status();
  } catch (const std::bad_alloc&) {
    print_error("out of memory; close other programs or use a smaller input");
  } catch (const std::exception& e) {
    print_error(e.what());
  }
  return 1;
}

}  // namespace
}  // namespace lodestone

int main(int argc, char** argv) {
  using namespace lodestone;
  set_program_commit(commit_text);
  CLI::App app{"Lodestone: level of detail of large triangle surfaces, without cracks or pops", "lodestone"};
  app.set_version_flag("--version", std::string(program_version()));
  app.require_subcommand(1);
  add_generate(app);
  add_build(app);
  add_info(app);
  add_verify(app);
  add_compare(app);
  add_render(app);
  add_export(app);
  add_view(app);
  add_reconstruct(app);
  add_progressive(app);
  add_spherical(app);
  add_lod(app);
  add_page(app);
  add_report(app);
  add_sweep(app);
  add_merge(app);
  add_experiments(app);
  install_signal_handlers();
  return run(app, argc, argv);
}
