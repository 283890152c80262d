// The exit status of the command by the kind of what went wrong, for scripts.
#pragma once

#include <exception>
#include <string>

#include "core/base/error.h"

namespace lodestone {

// Interrupted commands end with 128 + signal.
enum class ExitStatus : int {
  success = 0,
  negative = 1,     // the work is done, and the answer is no
  usage = 2,        // the command line
  input = 3,        // the content of a file
  file = 4,         // reading or writing one
  unsupported = 5,  // what this program, or this machine, does not do
  resource = 6,     // memory or another limit
  internal = 7      // a mistake of the program itself
};

// A command has done its work, and its answer is no: a hierarchy that does not verify, runs of a sweep that failed.
class NegativeResult : public Error {
 public:
  using Error::Error;
};

// Options that are unknown, malformed or contradict one another, whatever the files hold.
class UsageError : public InputError {
 public:
  using InputError::InputError;
};

[[nodiscard]] ExitStatus exit_status(const std::exception& error);

// The list above for --help, a line for each status.
[[nodiscard]] std::string exit_status_help();

}  // namespace lodestone
