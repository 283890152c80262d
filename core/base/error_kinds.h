// Errors from the outside world, by kind. The message is one line a user can act on: what file, what place, what is
// wrong, what to do about it. Mistakes of the program itself are assertions, never these.
#pragma once

#include <stdexcept>
#include <string>

namespace lodestone {

class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The content of what was given is wrong: malformed mesh, index out of range, contradictory parameters.
class InputError : public Error {
 public:
  using Error::Error;
};

// The file system said no: missing, unreadable, unwritable, full.
class FileError : public Error {
 public:
  using Error::Error;
};

// Well-formed, but beyond what this program does: unknown format, newer version, no OpenGL 4.5 here.
class UnsupportedError : public Error {
 public:
  using Error::Error;
};

// A limit was met: memory, index width, threads.
class ResourceError : public Error {
 public:
  using Error::Error;
};

}  // namespace lodestone
