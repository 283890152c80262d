#include "experiments/commands/options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <type_traits>

#include "experiments/command_line/sizes.h"

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
  option->required(spec.required);
  for (const std::string& name : spec.excludes) option->excludes(command.get_option(name));
  for (const std::string& name : spec.needs) option->needs(command.get_option(name));
}

}  // namespace

void add_command(CLI::App& app, const CommandInfo& info, CommonOptions& common, const OptionTable& table,
                 std::function<void()> run) {
  CLI::App& command = *app.add_subcommand(info.name, info.description);
  command.footer("Examples:\n" + info.examples);
  for (const OptionSpec& spec :
       OptionTable{{"--json", &common.json, "Write results as JSON to this file (- for standard output)"},
                   OptionSpec{"--threads", &common.threads, info.threads_help}.between(0, 1024),
                   {"--quiet", &common.quiet, "Print errors only, no progress and no summary"}})
    add_option(command, spec);
  for (const OptionSpec& spec : table) add_option(command, spec);
  command.callback(std::move(run));
}

void add_hidden_command(CLI::App& app, const std::string& name, const OptionTable& table, std::function<void()> run) {
  CLI::App& command = *app.add_subcommand(name)->group("");
  for (const OptionSpec& spec : table) add_option(command, spec);
  command.callback(std::move(run));
}

}  // namespace lodestone
