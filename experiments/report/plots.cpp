#include "experiments/report/plots.h"

#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "core/base/error.h"
#include "experiments/report/assets.h"

extern "C" char** environ;

namespace lodestone {
namespace {

using nlohmann::json;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

[[noreturn]] void fail() { throw FileError(std::string("temporary files for the plots: ") + std::strerror(errno)); }

File make_file(const std::string& content = {}) {
  File file(std::tmpfile());
  if (!file || std::fwrite(content.data(), 1, content.size(), file.get()) != content.size() ||
      std::fflush(file.get()) != 0)
    fail();
  std::rewind(file.get());
  return file;
}

std::string content_of(std::FILE* file) {
  std::rewind(file);
  std::string content;
  char block[65536];
  for (std::size_t n = 0; (n = std::fread(block, 1, sizeof(block), file)) > 0;) content.append(block, n);
  return content;
}

struct ScriptResult {
  int status = 127;  // 127: there is no such interpreter
  std::string output, errors;
};

ScriptResult run_script(const std::string& interpreter, const std::string& input) {
  const File in = make_file(input), out = make_file(), errors = make_file();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, fileno(in.get()), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(out.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(errors.get()), STDERR_FILENO);
  std::string words[] = {interpreter, "-B", "-c", std::string(plot_script())};
  char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  pid_t child = 0;
  const int failed = posix_spawnp(&child, interpreter.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  ScriptResult result;
  if (failed != 0) return result;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.output = content_of(out.get());
  result.errors = content_of(errors.get());
  return result;
}

std::string last_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

Plots read_plots(const ScriptResult& result, const std::string& interpreter, std::size_t figures) {
  if (result.status != 0)
    return {{}, fmt::format("{} could not draw the plots: {}", interpreter, last_line(result.errors))};
  const json list = json::parse(result.output, nullptr, false);
  if (!list.is_array() || list.size() != figures) return {{}, interpreter + " could not draw the plots: no room?"};
  Plots plots;
  for (const json& plot : list) plots.plots.push_back({plot.value("wide", ""), plot.value("narrow", "")});
  return plots;
}

}  // namespace

Plots draw_plots(const std::vector<Figure>& figures) {
  if (figures.empty()) return {};
  json list = json::array();
  for (const Figure& figure : figures) list.push_back(to_json(figure));
  const std::string input = list.dump(-1, ' ', true, json::error_handler_t::replace);
  constexpr int without_matplotlib = 3, no_interpreter = 127;
  const char* given = std::getenv("LODESTONE_PYTHON");
  const std::vector<std::string> interpreters =
      given != nullptr ? std::vector<std::string>{given} : std::vector<std::string>{"python3", "/usr/bin/python3"};
  for (const std::string& interpreter : interpreters) {
    const ScriptResult result = run_script(interpreter, input);
    if (result.status != without_matplotlib && result.status != no_interpreter)
      return read_plots(result, interpreter, figures.size());
  }
  return {{}, "without plots: there is no python3 with matplotlib (scripts/setup installs python3-matplotlib)"};
}

}  // namespace lodestone
