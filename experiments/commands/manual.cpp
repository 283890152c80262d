// lodestone manual: a page for the program and one for each subcommand, in the language of man.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <sstream>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "experiments/command_line/exit_status.h"
#include "experiments/command_line/option_text.h"
#include "experiments/command_line/version.h"
#include "experiments/commands/command.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// Text as it is: no character of it is a command. A hyphen is the one that users type.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n')) result += "\\&";
      result += c;
    }
  }
  return result;
}

std::string bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + escaped(text) + "\\fR"; }

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string head(const std::string& page, const std::string& what) {
  return fmt::format(".TH {} 1 \"\" \"Lodestone {}\" \"Lodestone\"\n.SH NAME\n{} \\- {}\n", upper(page),
                     program_version(), escaped(page), escaped(what));
}

// Lines of the help that are kept as they are.
std::string literal(const std::string& lines) {
  std::string text = ".nf\n";
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);)
    text += escaped(line.substr(std::min(line.find_first_not_of(' '), line.size()))) + "\n";
  return text + ".fi\n";
}

std::string term(const OptionSpec& option) {
  std::string text;
  for (const std::string& flag : flags_of(option)) text += (text.empty() ? "" : ", ") + bold(flag);
  if (is_argument(option)) text = italic(option.name);
  const std::string value = is_argument(option) ? "" : value_text(option);
  if (!value.empty()) text.append(" ").append(italic(value));
  return text;
}

std::string entry(const OptionSpec& option) {
  std::string text = option.help;
  if (const std::string value = default_text(option); !value.empty()) text += ". Default: " + value;
  if (option.range && option.range->most < std::numeric_limits<double>::infinity())
    text += fmt::format(". From {:g} to {:g}", option.range->least, option.range->most);
  if (!option.needs.empty()) text += ". Needs " + option.needs.front();
  for (const std::string& other : option.excludes) text += ". Not with " + other;
  return fmt::format(".TP\n{}\n{}\n", term(option), escaped(text));
}

std::string entries(const Command& command, bool arguments) {
  std::string text;
  for (const OptionSpec& option : command.options)
    if (is_argument(option) == arguments) text += entry(option);
  return text;
}

std::string synopsis(const Command& command) {
  std::string text = bold("lodestone " + command.info.name) + " [" + italic("OPTIONS") + "]";
  for (const OptionSpec& option : command.options) {
    if (!is_argument(option)) continue;
    const bool many = std::holds_alternative<std::vector<std::string>*>(option.value);
    text += fmt::format(fmt::runtime(option.required ? " {}{}" : " [{}{}]"), italic(option.name), many ? " ..." : "");
  }
  return text + "\n";
}

std::string status_section() {
  const std::string help = exit_status_help();
  return ".SH EXIT STATUS\n" + literal(help.substr(help.find('\n') + 1));
}

std::string page_of(const Command& command) {
  const std::string arguments = entries(command, true);
  return head("lodestone-" + command.info.name, command.info.description) + ".SH SYNOPSIS\n" + synopsis(command) +
         (arguments.empty() ? "" : ".SH ARGUMENTS\n" + arguments) + ".SH OPTIONS\n" + entries(command, false) +
         ".TP\n" + bold("-h") + ", " + bold("--help") + "\nPrint the help\n" + ".SH EXAMPLES\n" +
         literal(command.info.examples) + status_section() + ".SH SEE ALSO\n.BR lodestone (1)\n";
}

std::string page_of_program(const CommandTable& commands) {
  const std::string& description = program_description();
  std::string text = head("lodestone", description.substr(description.find(": ") + 2)) + ".SH SYNOPSIS\n" +
                     bold("lodestone") + " " + italic("SUBCOMMAND") + " [" + italic("OPTIONS") + "] ...\n" +
                     ".SH SUBCOMMANDS\n";
  for (const Command& command : commands)
    if (!command.hidden)
      text += ".TP\n.BR lodestone\\-" + command.info.name + " (1)\n" + escaped(command.info.description) + "\n";
  return text + status_section();
}

void write_page(const fs::path& folder, const std::string& name, const std::string& text) {
  AtomicFile file(folder / (name + ".1"));
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

void write_pages(const fs::path& folder, const CommandTable& commands) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw FileError(describe(folder.string(), "", "cannot create the folder: " + error.message()));
  write_page(folder, "lodestone", page_of_program(commands));
  for (const Command& command : commands)
    if (!command.hidden) write_page(folder, "lodestone-" + command.info.name, page_of(command));
}

}  // namespace

void add_manual(CommandTable& commands) {
  const auto folder = std::make_shared<std::string>();
  commands.push_back({{"manual", "Write the manual, a page for each subcommand, in the language of man",
                       "  lodestone manual -o pages && man pages/lodestone-build.1\n"},
                      {OptionSpec{"-o,--output", folder.get(), "Folder for the pages; made if it is not there"}.must()},
                      [folder, &commands] { write_pages(*folder, commands); }});
}

}  // namespace lodestone
