// The subcommands and their options as tables, from which the parser, the help, the completion of shells and the manual
// pages are made. The parser itself (CLI11) is named in parser.cpp alone.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace lodestone {

// An amount of memory, as "2GiB" or "1500MB"; 0: not given.
struct Bytes {
  std::uint64_t count = 0;
};

// The variable that takes the value of an option. A bool is a flag; an optional one is empty unless the option is
// given.
using OptionValue =
    std::variant<bool*, int*, float*, double*, std::uint32_t*, std::uint64_t*, std::string*, Bytes*,
                 std::vector<std::string>*, std::optional<int>*, std::optional<float>*, std::optional<double>*,
                 std::optional<std::uint32_t>*, std::optional<std::uint64_t>*, std::optional<std::string>*>;

struct ValueRange {
  double least = 0, most = std::numeric_limits<double>::infinity();
};

struct OptionSpec {
  // "FILE" (an argument without a name before it), "--json", "-o,--output", or "!--no-parts" (a flag that sets false).
  std::string name;
  OptionValue value;
  std::string help{};
  std::optional<ValueRange> range{};
  std::vector<std::string> choices{}, excludes{}, needs{};  // options that are named are declared before this one
  std::string type{};                                       // of the value, for the help; empty: its usual name
  bool required = false;

  OptionSpec must() && { return required = true, std::move(*this); }
  OptionSpec between(double least, double most) && { return range = {least, most}, std::move(*this); }
  OptionSpec at_least(double least) && { return range = ValueRange{least}, std::move(*this); }
  OptionSpec one_of(std::vector<std::string> texts) && { return choices = std::move(texts), std::move(*this); }
  OptionSpec not_with(std::vector<std::string> names) && { return excludes = std::move(names), std::move(*this); }
  OptionSpec only_with(std::vector<std::string> names) && { return needs = std::move(names), std::move(*this); }
  OptionSpec of_type(std::string text) && { return type = std::move(text), std::move(*this); }
};
using OptionTable = std::vector<OptionSpec>;

struct CommonOptions {
  std::string json;  // file for machine-readable results; empty: none; "-": standard output
  int threads = 0;   // 0: all that the machine has
  bool quiet = false;

  // True if the command may print on standard output.
  [[nodiscard]] bool prints() const { return !quiet && json != "-"; }
};

struct CommandInfo {
  std::string name, description, examples;
  std::string threads_help = "Number of threads; 0 takes all of the machine";
};

struct Command {
  CommandInfo info;
  OptionTable options;  // the common ones first
  std::function<void()> run;
  bool hidden = false;  // no help mentions it
};
using CommandTable = std::vector<Command>;

// Adds a subcommand with --json, --threads, --quiet and the options of the table; `run` is called when it is given on
// the command line. What `common` and the table point to lives as long as `run`.
void add_command(CommandTable& commands, const CommandInfo& info, CommonOptions& common, OptionTable table,
                 std::function<void()> run);

// A subcommand whose options live in a struct: `declare` makes the table of their addresses. To be called with the
// struct's name, which tells the functions of several commands apart.
template <class Options>
void define_command(CommandTable& commands, const CommandInfo& info,
                    OptionTable (*declare)(std::type_identity_t<Options>&),
                    void (*run)(const std::type_identity_t<Options>&, const CommonOptions&)) {
  struct Both {
    Options own;
    CommonOptions common;
  };
  const auto both = std::make_shared<Both>();
  add_command(commands, info, both->common, declare(both->own), [both, run] { run(both->own, both->common); });
}

// The line that describes the program in its help and its manual.
[[nodiscard]] const std::string& program_description();

}  // namespace lodestone
