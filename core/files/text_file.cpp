#include "core/files/text_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include "core/base/error.h"

namespace lodestone {

std::string read_text(const std::filesystem::path& path) {
  const auto fail = [&path](const char* what) {
    const int error = errno;
    throw FileError(describe(path.string(), "", what + std::string(": ") + std::strerror(error)));
  };
  class Descriptor {
   public:
    explicit Descriptor(const char* name) : number(open(name, O_RDONLY | O_CLOEXEC)) {}
    ~Descriptor() {
      if (number >= 0) close(number);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    const int number;
  };
  const Descriptor file(path.c_str());
  if (file.number < 0) fail("cannot be opened for reading");
  std::string text;
  for (std::size_t size = 0;;) {
    text.resize(std::max<std::size_t>(4096, 2 * size));
    const ssize_t got = read(file.number, text.data() + size, text.size() - size);
    if (got < 0 && errno != EINTR) fail("cannot be read");
    if (got > 0) size += static_cast<std::size_t>(got);
    text.resize(size);
    if (got == 0) return text;
  }
}

}  // namespace lodestone
