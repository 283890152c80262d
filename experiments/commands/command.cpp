#include "experiments/commands/command.h"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/input_file.h"
#include "experiments/command_line/exit_status.h"

namespace lodestone {
namespace {

CancelFlag interrupted{false}, polled{false};
std::atomic<int> received{0};
std::atomic<const char*> line_when_interrupted{"lodestone: interrupted; no unfinished file was left\n"};
static_assert(std::atomic<const char*>::is_always_lock_free && CancelFlag::is_always_lock_free &&
                  std::atomic<int>::is_always_lock_free,
              "the signal handler may only touch lock-free atomics");

// Only what POSIX allows in a handler, here and below.
void say(std::string_view text) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
}

void on_interrupt(int signal) {
  received = signal;
  if (!interrupted.exchange(true) && polled) return;
  remove_temporaries();
  say(line_when_interrupted.load());
  std::_Exit(128 + signal);
}

// A mapped file that became shorter, or lies on a disk that fails. What else raises the signal is a mistake of the
// program's own, which ends as it would without this handler.
void on_bus_error(int signal, siginfo_t* info, void*) {
  const char* const file = mapped_file_at(info->si_addr);
  if (!file) {
    std::signal(signal, SIG_DFL);
    return;
  }
  remove_temporaries();
  say("lodestone: ");
  say(file);
  say(": became shorter, or its disk failed, while it was read; leave it as it is until the command has ended\n");
  std::_Exit(static_cast<int>(ExitStatus::file));
}

namespace fs = std::filesystem;

// Also for names that do not exist yet.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  if (fs::equivalent(a, b, ignored)) return true;
  return fs::weakly_canonical(a, ignored) == fs::weakly_canonical(b, ignored);
}

// Pipes and devices: not replaced but written to, and not to be opened twice.
bool is_stream(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

void check_output(const FileArgument& output) {
  if (is_stream(output.path)) return;
  remove_orphans(output.path);
  AtomicFile probe(output.path);  // never committed: the temporary goes, and a file of that name is kept
  if (!output.extension.empty() && fs::path(output.path).extension() != output.extension)
    throw UsageError(describe(output.path, "", output.option + " must name a " + output.extension + " file"));
}

void refuse_same(const FileArgument& a, const FileArgument& b) {
  if (is_stream(a.path) || !same_file(a.path, b.path)) return;
  throw UsageError(describe(a.path, "", "is given as " + a.option + " and as " + b.option,
                            "the one would destroy the other; choose two names"));
}

}  // namespace

std::unique_ptr<Scheduler> make_scheduler(const CommonOptions& common) { return make_tbb_scheduler(common.threads); }

std::vector<FileArgument> file_arguments(const std::string& option, const std::vector<std::string>& files) {
  std::vector<FileArgument> list;
  for (const std::string& file : files) list.push_back({option, file});
  return list;
}

void check_files(const CommonOptions& common, const std::vector<FileArgument>& inputs,
                 std::vector<FileArgument> outputs) {
  if (!common.json.empty() && common.json != "-") outputs.push_back({"--json", common.json});
  for (const auto* list : std::initializer_list<const std::vector<FileArgument>*>{&inputs, &outputs})
    for (const FileArgument& file : *list)
      if (file.path.empty()) throw UsageError(file.option + ": the file name is empty");
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    for (const FileArgument& input : inputs) refuse_same(input, *output);
    for (auto other = outputs.begin(); other != output; ++other) refuse_same(*other, *output);
  }
  for (const FileArgument& output : outputs) check_output(output);
}

const CancelFlag& interrupt_flag() {
  polled = true;
  return interrupted;
}

void set_interrupt_line(const char* line) { line_when_interrupted = line; }

const char* interrupt_line() { return line_when_interrupted; }

int interrupt_status() { return 128 + received; }

void allow_many_files() {
  constexpr rlim_t enough = 1 << 16;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= enough) return;
  limit.rlim_cur = std::min(limit.rlim_max, enough);
  (void)setrlimit(RLIMIT_NOFILE, &limit);
}

void install_signal_handlers() {
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the shell's limit is an error of the write that made it so
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  struct sigaction bus {};
  bus.sa_sigaction = on_bus_error;
  bus.sa_flags = SA_SIGINFO;
  sigaction(SIGBUS, &bus, nullptr);
}

void check_interrupt() {
  if (interrupted) throw Cancelled{};
}

void write_result(const CommonOptions& common, const Json& result) {
  if (common.json.empty()) return;
  // File names need not be UTF-8, JSON must.
  const std::string text = result.dump(2) + "\n";
  if (common.json == "-") {
    std::fputs(text.c_str(), stdout);
    return;
  }
  AtomicFile file(common.json);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

Json to_json(const StageTime& time) { return {{"seconds", time.seconds}, {"cpu_seconds", time.cpu_seconds}}; }

Json to_json(const Repairs& r) {
  return {{"polygons_triangulated", r.polygons_triangulated},
          {"faces_dropped", r.faces_dropped},
          {"non_finite_triangles", r.non_finite_triangles},
          {"welded_vertices", r.welded_vertices},
          {"degenerate_triangles", r.degenerate_triangles},
          {"duplicate_triangles", r.duplicate_triangles},
          {"unreferenced_vertices", r.unreferenced_vertices},
          {"void_posts", r.void_posts},
          {"filled_posts", r.filled_posts}};
}

void print_repairs(const Repairs& repairs) {
  const Json counts = to_json(repairs);
  for (const auto& [name, count] : counts.items())
    if (count.get<std::uint64_t>() > 0) fmt::print("repaired: {} {}\n", name, count.get<std::uint64_t>());
}

}  // namespace lodestone
