// lodestone completion: what bash, zsh and fish complete, from the tables of the subcommands.
#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "experiments/command_line/option_text.h"
#include "experiments/commands/command.h"

namespace lodestone {
namespace {

const std::string program_flags = "--help --version";

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::vector<const Command*> shown(const CommandTable& commands) {
  std::vector<const Command*> list;
  for (const Command& command : commands)
    if (!command.hidden) list.push_back(&command);
  return list;
}

std::string names_of(const CommandTable& commands) {
  std::vector<std::string> names;
  for (const Command* command : shown(commands)) names.push_back(command->info.name);
  return joined(names);
}

// The text within single quotes of a POSIX shell, with a backslash before each of the characters `special`.
std::string in_quotes(std::string_view text, std::string_view special = "") {
  std::string result = "'";
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) result += '\\';
    result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return result + "'";
}

// The first part of its help.
std::string brief(const OptionSpec& option) {
  return option.help.substr(0, std::min(option.help.find("; "), option.help.find(". ")));
}

// Its first part as _arguments of zsh takes it.
std::string bracketed(const OptionSpec& option) {
  std::string text = "[";
  for (const char c : brief(option)) text += c == '[' || c == ']' ? std::string("\\") + c : std::string(1, c);
  return text + "]";
}

// ---- bash: words by subcommand, and by the option before the word; where nothing is known, files.

std::string bash_command(const Command& command) {
  const std::string& name = command.info.name;
  std::string cases, arguments;
  std::vector<std::string> flags{"--help"}, followed;
  for (const OptionSpec& option : command.options) {
    if (is_argument(option)) arguments.append(arguments.empty() ? "" : " ").append(joined(option.choices));
    for (const std::string& flag : flags_of(option)) {
      if (flag.starts_with("--")) flags.push_back(flag);
      if (value_text(option).empty()) continue;
      if (option.choices.empty())
        followed.push_back(name + ":" + flag);
      else
        cases += fmt::format("    {}:{}) words={} ;;\n", name, flag, in_quotes(joined(option.choices)));
    }
  }
  std::string no_words;
  for (const std::string& key : followed) no_words += (no_words.empty() ? "" : " | ") + key;
  if (!no_words.empty()) cases += fmt::format("    {}) ;;\n", no_words);
  return cases + fmt::format("    {}:*) if [[ $word == -* ]]; then words={}; else words={}; fi ;;\n", name,
                             in_quotes(joined(flags)), in_quotes(arguments));
}

std::string bash(const CommandTable& commands) {
  std::string text = fmt::format(
      "# Completion of lodestone in bash, written by `lodestone completion bash`.\n"
      "_lodestone() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} words=''\n"
      "  # An equals sign is a word of its own.\n"
      "  [[ $word != = ]] || word=''\n"
      "  [[ $before != = ]] || before=${{COMP_WORDS[COMP_CWORD - 2]}}\n"
      "  COMPREPLY=()\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    words={}\n"
      "  else\n"
      "    case ${{COMP_WORDS[1]}}:$before in\n",
      in_quotes(names_of(commands) + " " + program_flags));
  for (const Command* command : shown(commands)) text += bash_command(*command);
  return text +
         "    esac\n"
         "  fi\n"
         "  [[ -z $words ]] || mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
         "}\n"
         "complete -o bashdefault -o default -F _lodestone lodestone\n";
}

// ---- zsh: the arguments of _arguments.

std::string zsh_action(const OptionSpec& option) {
  return option.choices.empty() ? "_files" : fmt::format("({})", joined(option.choices));
}

std::string zsh_option(const OptionSpec& option) {
  const std::string value = value_text(option).empty() ? "" : ":value:" + zsh_action(option);
  if (is_argument(option)) return "    " + in_quotes("*:" + option.name + ":" + zsh_action(option)) + " \\\n";
  const std::vector<std::string> flags = flags_of(option);
  std::string lines;
  for (const std::string& flag : flags)
    lines +=
        fmt::format("    {} \\\n", in_quotes(fmt::format("({}){}{}{}", joined(flags), flag, bracketed(option), value)));
  return lines;
}

std::string zsh(const CommandTable& commands) {
  std::string text =
      "#compdef lodestone\n"
      "# Completion of lodestone in zsh, written by `lodestone completion zsh`.\n"
      "_lodestone() {\n"
      "  local -a commands=(\n";
  for (const Command* command : shown(commands))
    text += "    " + in_quotes(command->info.name + ":" + command->info.description) + "\n";
  text +=
      "  )\n"
      "  if ((CURRENT == 2)); then\n"
      "    _describe -t commands subcommand commands\n"
      "    return\n"
      "  fi\n"
      "  shift words\n"
      "  ((CURRENT--))\n"
      "  case $words[1] in\n";
  for (const Command* command : shown(commands)) {
    text += "  " + command->info.name + ")\n    _arguments -s -S : \\\n";
    for (const OptionSpec& option : command->options) text += zsh_option(option);
    text += "    '(-h --help)'{-h,--help}'[Print the help]' ;;\n";
  }
  return text +
         "  esac\n"
         "}\n"
         "_lodestone \"$@\"\n";
}

// ---- fish: a line for each option of each subcommand.

std::string fish_option(const Command& command, const OptionSpec& option) {
  std::string line = "complete -c lodestone -n '__fish_seen_subcommand_from " + command.info.name + "'";
  for (const std::string& flag : flags_of(option))
    line += flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
  if (!option.choices.empty())
    line += " -x -a " + in_quotes(joined(option.choices), "\\");
  else if (!value_text(option).empty())
    line += is_argument(option) ? " -F" : " -r -F";
  return line + (is_argument(option) ? "" : " -d " + in_quotes(brief(option), "\\")) + "\n";
}

std::string fish(const CommandTable& commands) {
  std::string text =
      "# Completion of lodestone in fish, written by `lodestone completion fish`.\n"
      "complete -c lodestone -n __fish_use_subcommand -f\n"
      "complete -c lodestone -n __fish_use_subcommand -l version -d 'Print the version'\n"
      "complete -c lodestone -s h -l help -d 'Print the help'\n";
  for (const Command* command : shown(commands)) {
    text += fmt::format("complete -c lodestone -n __fish_use_subcommand -a {} -d {}\n", command->info.name,
                        in_quotes(command->info.description, "\\"));
    for (const OptionSpec& option : command->options) text += fish_option(*command, option);
  }
  return text;
}

}  // namespace

void add_completion(CommandTable& commands) {
  const auto shell = std::make_shared<std::string>();
  commands.push_back(
      {{"completion", "Print the completion of a shell",
        "  source <(lodestone completion bash)\n"
        "  lodestone completion fish > ~/.config/fish/completions/lodestone.fish\n"},
       {OptionSpec{"SHELL", shell.get(), "The shell"}.must().one_of({"bash", "zsh", "fish"})},
       [shell, &commands] {
         const std::string text = *shell == "bash" ? bash(commands) : *shell == "zsh" ? zsh(commands) : fish(commands);
         fmt::print("{}", text);
       }});
}

}  // namespace lodestone
