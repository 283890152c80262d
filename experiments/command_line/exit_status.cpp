#include "experiments/command_line/exit_status.h"

#include <filesystem>
#include <new>
#include <system_error>

namespace lodestone {
namespace {

template <class Kind>
bool is(const std::exception& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

}  // namespace

ExitStatus exit_status(const std::exception& error) {
  if (is<NegativeResult>(error)) return ExitStatus::negative;
  if (is<UsageError>(error)) return ExitStatus::usage;
  if (is<InputError>(error)) return ExitStatus::input;
  if (is<FileError>(error) || is<std::filesystem::filesystem_error>(error)) return ExitStatus::file;
  if (is<UnsupportedError>(error)) return ExitStatus::unsupported;
  if (is<ResourceError>(error) || is<std::bad_alloc>(error) || is<std::system_error>(error))
    return ExitStatus::resource;
  return ExitStatus::internal;
}

std::string exit_status_help() {
  return "Exit status:\n"
         "  0    success\n"
         "  1    the work is done, and the answer is no: verify found a fault, runs of a sweep failed or are missing\n"
         "  2    the command line is wrong\n"
         "  3    a file holds something wrong, or a value does not fit it\n"
         "  4    a file cannot be read or written\n"
         "  5    not supported by this program, or by this machine\n"
         "  6    not enough memory, or another limit was met\n"
         "  7    a mistake of the program itself\n"
         "  130  interrupted by Ctrl-C; 143: by SIGTERM\n";
}

}  // namespace lodestone
