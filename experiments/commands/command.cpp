#include "experiments/commands/command.h"

#include <sys/resource.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "core/io/atomic_file.h"

namespace lodestone {
namespace {

CancelFlag interrupted{false};
static_assert(CancelFlag::is_always_lock_free, "the signal handler may only touch lock-free atomics");

void on_interrupt(int signal) {
  if (interrupted.exchange(true)) std::_Exit(128 + signal);
}

}  // namespace

CLI::App& add_command(CLI::App& app, const std::string& name, const std::string& description,
                      const std::string& examples, const std::shared_ptr<CommonOptions>& common) {
  CLI::App& command = *app.add_subcommand(name, description);
  command.footer("Examples:\n" + examples);
  command.add_option("--json", common->json, "Write results as JSON to this file (- for standard output)");
  command.add_option("--threads", common->threads, "Number of threads; 0 takes all of the machine")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command.add_flag("--quiet", common->quiet, "No progress and no summary, errors only");
  return command;
}

std::unique_ptr<Scheduler> make_scheduler(const CommonOptions& common) { return make_tbb_scheduler(common.threads); }

const CancelFlag& interrupt_flag() { return interrupted; }

void install_interrupt_handler() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

void check_interrupt() {
  if (interrupted) throw Cancelled{};
}

void write_json(const CommonOptions& common, const nlohmann::json& result) {
  if (common.json.empty()) return;
  const std::string text = result.dump(2) + "\n";
  if (common.json == "-") {
    std::fputs(text.c_str(), stdout);
    return;
  }
  AtomicFile file(common.json);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

nlohmann::json to_json(const StageTime& time) { return {{"seconds", time.seconds}, {"cpu_seconds", time.cpu_seconds}}; }

std::uint64_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace lodestone
