// A child process: this program with other arguments, or another one.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lodestone {

// How a process ended, and what it took.
struct ChildEnd {
  int status = 0;  // as of waitpid()
  double cpu_seconds = 0;
  [[nodiscard]] bool succeeded() const;
  [[nodiscard]] bool failed() const;         // with the status of an error, and one line that says why
  [[nodiscard]] bool interrupted() const;    // by SIGINT or SIGTERM, on its own or in good order
  [[nodiscard]] std::string reason() const;  // "ended by signal 11 (Segmentation fault)"
};

struct ChildCommand {
  std::vector<std::string> arguments;         // after the program's name
  std::filesystem::path program = {};         // empty: this one, which is told by `--report N` where to report
  std::vector<std::string> environment = {};  // "NAME=value", where this process has no such variable
};

class ChildProcess {
 public:
  // Standard output and error are appended to `log`, and the `inherited` descriptor, if there is one, stays open in the
  // child. The child ends when this process does, however that ends. Throws ResourceError when no process can be
  // started, FileError when the log cannot be written.
  ChildProcess(ChildCommand command, const std::filesystem::path& log, int inherited = -1);
  ~ChildProcess();  // ends it
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Readable when the child has reported, or ended; of another program, when it has begun.
  [[nodiscard]] int report() const { return report_; }
  [[nodiscard]] double share();                      // the last that it reported, in [0, 1]
  [[nodiscard]] std::optional<ChildEnd> poll_end();  // does not wait
  void signal(int number) const;

 private:
  pid_t process_ = -1;  // -1: has ended and been waited for
  int report_ = -1;
  std::string pending_;
  double share_ = 0;
};

}  // namespace lodestone
