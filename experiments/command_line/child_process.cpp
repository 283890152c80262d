#include "experiments/command_line/child_process.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "core/base/error.h"
#include "experiments/command_line/exit_status.h"

namespace lodestone {
namespace {

// Holds SIGINT and SIGTERM back for as long as it lives. A process forked meanwhile starts with them held back, too, so
// that this process's handlers never run in a copy of it.
class SignalsHeld {
 public:
  SignalsHeld() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, &before_);
  }
  ~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

  // In the child: the system's default for them, and no longer held back.
  void release_by_default() const {
    ::signal(SIGINT, SIG_DFL);
    ::signal(SIGTERM, SIG_DFL);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

 private:
  sigset_t before_{};
};

// A command as execve() takes it, made before fork().
class Executable {
 public:
  explicit Executable(ChildCommand&& command)
      : program_(command.program.empty() ? "/proc/self/exe" : command.program.string()),
        arguments_(std::move(command.arguments)) {
    arguments_.insert(arguments_.begin(), command.program.empty() ? "lodestone" : program_);
    for (char** variable = environ; *variable != nullptr; ++variable) environment_.emplace_back(*variable);
    for (std::string& assignment : command.environment)
      if (std::getenv(assignment.substr(0, assignment.find('=')).c_str()) == nullptr)
        environment_.push_back(std::move(assignment));
    argument_pointers_ = pointers(arguments_), environment_pointers_ = pointers(environment_);
  }
  void execute() const { execve(program_.c_str(), argument_pointers_.data(), environment_pointers_.data()); }

 private:
  static std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> list;
    for (std::string& text : texts) list.push_back(text.data());
    list.push_back(nullptr);
    return list;
  }

  std::string program_;
  std::vector<std::string> arguments_, environment_;
  std::vector<char*> argument_pointers_, environment_pointers_;
};

// Descriptors of the child; below 0: none.
struct ChildFiles {
  int log = -1;
  std::array<int, 2> kept{-1, -1};  // open in the program, too
};

// After fork(), in the child: only what may be called there.
[[noreturn]] void become(const Executable& executable, const ChildFiles& files, pid_t parent, const SignalsHeld& held) {
  held.release_by_default();
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // it has ended in between
  const int null = open("/dev/null", O_RDONLY);
  dup2(null, STDIN_FILENO);
  dup2(files.log, STDOUT_FILENO);
  dup2(files.log, STDERR_FILENO);
  for (const int file : files.kept)
    if (file >= 0) fcntl(file, F_SETFD, 0);
  executable.execute();
  _exit(127);
}

}  // namespace

bool ChildEnd::succeeded() const { return WIFEXITED(status) && WEXITSTATUS(status) == 0; }

bool ChildEnd::failed() const {
  return WIFEXITED(status) && WEXITSTATUS(status) >= static_cast<int>(ExitStatus::negative) &&
         WEXITSTATUS(status) <= static_cast<int>(ExitStatus::internal);
}

bool ChildEnd::interrupted() const {
  const auto is_interrupt = [](int number) { return number == SIGINT || number == SIGTERM; };
  if (WIFSIGNALED(status)) return is_interrupt(WTERMSIG(status));
  return WIFEXITED(status) && is_interrupt(WEXITSTATUS(status) - 128);
}

std::string ChildEnd::reason() const {
  if (WIFSIGNALED(status)) return fmt::format("ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("ended with status {}", WEXITSTATUS(status));
}

ChildProcess::ChildProcess(ChildCommand command, const std::filesystem::path& log, int inherited) {
  const int output = open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (output < 0) throw FileError(describe(log.string(), "", std::string("cannot be written: ") + strerror(errno)));
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    close(output);
    throw ResourceError(std::string("no pipe to a run: ") + strerror(errno));
  }
  const bool reports = command.program.empty();
  if (reports) command.arguments.insert(command.arguments.end(), {"--report", std::to_string(ends[1])});
  const Executable executable(std::move(command));
  const pid_t parent = getpid();
  int error = 0;
  {
    const SignalsHeld held;
    process_ = fork();
    if (process_ == 0) become(executable, {output, {reports ? ends[1] : -1, inherited}}, parent, held);
    error = errno;
  }
  close(output);
  close(ends[1]);
  report_ = ends[0];
  fcntl(report_, F_SETFL, O_NONBLOCK);
  if (process_ < 0) {
    close(report_);
    throw ResourceError(std::string("no process for a run: ") + strerror(error));
  }
}

ChildProcess::~ChildProcess() {
  if (process_ > 0) {
    kill(process_, SIGKILL);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  if (report_ >= 0) close(report_);
}

double ChildProcess::share() {
  char bytes[512];
  for (ssize_t count; (count = read(report_, bytes, sizeof bytes)) > 0;)
    pending_.append(bytes, static_cast<std::size_t>(count));
  const std::size_t end = pending_.rfind('\n');
  if (end == std::string::npos) return share_;
  const std::size_t begin = end == 0 ? std::string::npos : pending_.rfind('\n', end - 1);
  share_ = std::clamp(std::strtod(pending_.c_str() + (begin == std::string::npos ? 0 : begin + 1), nullptr), 0.0, 1.0);
  pending_.erase(0, end + 1);
  return share_;
}

std::optional<ChildEnd> ChildProcess::poll_end() {
  if (process_ < 0) return ChildEnd{};  // and was waited for
  ChildEnd end;
  rusage usage{};
  if (wait4(process_, &end.status, WNOHANG, &usage) != process_) return {};
  process_ = -1;
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  end.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  return end;
}

void ChildProcess::signal(int number) const {
  if (process_ > 0) kill(process_, number);
}

}  // namespace lodestone
