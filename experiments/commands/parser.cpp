#include "experiments/commands/parser.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <type_traits>

#include "core/base/error.h"
#include "core/base/known_names.h"
#include "core/files/temporaries.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/command_line/sizes.h"
#include "experiments/command_line/version.h"
#include "experiments/commands/command.h"

namespace lodestone {
namespace {

template <class Value>
struct Traits {
  static constexpr bool optional = false, natural = std::is_unsigned_v<Value>;
};
template <class Value>
struct Traits<std::optional<Value>> {
  static constexpr bool optional = true, natural = std::is_unsigned_v<Value>;
};

// Adds the option by the type of its value; defaults are shown but for optional values.
struct Adder {
  CLI::App& command;
  const OptionSpec& spec;

  CLI::Option* operator()(bool* value) const { return command.add_flag(spec.name, *value, spec.help); }
  CLI::Option* operator()(Bytes* value) const {
    const std::string name = spec.name;
    return command
        .add_option_function<std::string>(
            name, [value, name](const std::string& text) { value->count = parse_bytes(name, text); }, spec.help)
        ->type_name("SIZE");
  }
  template <class Value>
  CLI::Option* operator()(Value* value) const {
    CLI::Option* const option = command.add_option(spec.name, *value, spec.help);
    if constexpr (Traits<Value>::natural) option->check(CLI::NonNegativeNumber);
    if constexpr (!Traits<Value>::optional && !std::is_same_v<Value, std::vector<std::string>>)
      option->capture_default_str();
    return option;
  }
};

void add_option(CLI::App& command, const OptionSpec& spec) {
  CLI::Option* const option = std::visit(Adder{command, spec}, spec.value);
  if (spec.range && std::isinf(spec.range->most))
    option->check(spec.range->least > 0 ? CLI::PositiveNumber : CLI::NonNegativeNumber);
  else if (spec.range)
    option->check(CLI::Range(spec.range->least, spec.range->most));
  if (!spec.choices.empty()) option->check(CLI::IsMember(spec.choices));
  if (!spec.type.empty()) option->type_name(spec.type);
  if (spec.name.starts_with('-') && std::holds_alternative<std::vector<std::string>*>(spec.value))
    option->allow_extra_args(false);  // one each time that it is given: what follows may be an argument
  option->required(spec.required);
  for (const std::string& name : spec.excludes) option->excludes(command.get_option(name));
  for (const std::string& name : spec.needs) option->needs(command.get_option(name));
}

void add_commands(CLI::App& app, const CommandTable& commands) {
  for (const Command& command : commands) {
    CLI::App& parser = *app.add_subcommand(command.info.name, command.info.description);
    if (command.hidden) parser.group("");
    if (!command.info.examples.empty()) parser.footer("Examples:\n" + command.info.examples);
    for (const OptionSpec& spec : command.options) add_option(parser, spec);
    parser.callback(command.run);
  }
}

// Names of files and messages of libraries may hold line ends; an error has one line.
void print_error(const ProgramVoice& voice, std::string message) {
  if (voice.silent) return;
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
  fmt::print(stderr, "{}: {}\n", voice.name, message);
}

// Allocates nothing.
void print_out_of_memory() noexcept {
  std::fputs("lodestone: out of memory; close other programs or use a smaller input\n", stderr);
}

std::atomic<bool> memory_ran_out{false};

[[noreturn]] void on_no_memory() {
  memory_ran_out = true;
  throw std::bad_alloc();
}

// Memory that runs out in a function that may not throw ends the process with the same line and status as elsewhere.
// The standard library ends it without saying why where that happens inside of a directory_iterator.
[[noreturn]] void on_terminate() {
  bool for_memory = !std::current_exception() && memory_ran_out;
  try {
    if (std::current_exception()) throw;
  } catch (const std::bad_alloc&) {
    for_memory = true;
  } catch (...) {
  }
  if (!for_memory) std::abort();
  remove_temporaries();
  print_out_of_memory();
  std::_Exit(static_cast<int>(ExitStatus::resource));
}

std::vector<std::string> names_in(const CLI::App& app, bool options) {
  std::vector<std::string> names;
  if (options)
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  else
    for (const CLI::App* command : app.get_subcommands({}))
      if (!command->get_group().empty()) names.push_back(command->get_name());
  return names;
}

// An unknown word is reported before a missing one: `lodestone biuld` is not a call without a subcommand.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const auto given = app.get_subcommands();
  const std::string command = given.empty() ? app.get_name() : app.get_name() + " " + given.front()->get_name();
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

}  // namespace

int run_command_line(const CommandTable& commands, int argc, char** argv, const ProgramVoice& voice) {
  CLI::App app{program_description(), voice.name};
  app.set_version_flag("--version", std::string(program_version()));
  app.require_subcommand(1);
  app.footer(exit_status_help());
  add_commands(app, commands);
  try {
    app.parse(argc, argv);
    // Results that did not reach a full disk are an error.
    if (std::fflush(stdout) != 0) throw FileError(std::string("cannot write to standard output: ") + strerror(errno));
    return 0;
  } catch (const CLI::Success& e) {  // --help, --version
    return voice.silent ? 0 : app.exit(e);
  } catch (const CLI::ParseError& e) {
    print_error(voice, usage_error(app, e));
    return static_cast<int>(ExitStatus::usage);
  } catch (const Cancelled&) {
    fmt::print(stderr, "{}", interrupt_line());
    return interrupt_status();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    print_error(voice, e.what());
    return static_cast<int>(exit_status(e));
  }
}

int guard_memory(int (*run)(int, char**), int argc, char** argv) {
  std::set_terminate(on_terminate);
  std::set_new_handler(on_no_memory);
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {  // also while an error was being described
    print_out_of_memory();
    return static_cast<int>(ExitStatus::resource);
  }
}

}  // namespace lodestone
