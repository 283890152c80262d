#include "experiments/sweep/files.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/text_file.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw FileError(describe(path.string(), "", what + ": " + std::strerror(errno)));
}

// A rename is on the medium when the folder is. File systems that cannot are let be.
void sync_folder(const fs::path& folder) {
  const int descriptor = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  (void)fsync(descriptor);
  close(descriptor);
}

int open_lock(const fs::path& path) {
  const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(path, "cannot be opened");
  return descriptor;
}

// False when somebody else has it.
bool lock_now(int descriptor, const fs::path& path) {
  while (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return false;
    if (errno == EINTR) continue;
    const int error = errno;
    close(descriptor);
    errno = error;
    fail(path, "cannot be locked");
  }
  return true;
}

}  // namespace

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw FileError(describe(folder.string(), "", "cannot be created: " + error.message()));
}

void write_aside(const fs::path& target, std::string_view text) {
  AtomicFile file(target);
  file.write(std::as_bytes(std::span(text)));
  file.commit();
}

void write_durably(const fs::path& target, std::string_view text) {
  AtomicFile file(target);
  file.write(std::as_bytes(std::span(text)));
  file.sync();
  file.commit();
  sync_folder(target.parent_path());
}

Json json_or_null(const std::string& text) {
  try {
    return Json::parse(text);
  } catch (const JsonError&) {
    return nullptr;
  }
}

Json read_json(const fs::path& path) { return json_or_null(read_if_there(path)); }

std::string read_if_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) ? read_text(path) : std::string();
}

void remove_temporaries_in(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().filename().string().find(".tmp.") != std::string::npos) fs::remove_all(entry.path(), ignored);
}

FileLock::FileLock(const fs::path& path, const CancelFlag* cancel) : descriptor_(open_lock(path)) {
  while (!lock_now(descriptor_, path)) {
    if (cancel && *cancel) {
      close(descriptor_);
      throw Cancelled{};
    }
    poll(nullptr, 0, 50);
  }
}

FileLock FileLock::try_lock(const fs::path& path) {
  FileLock lock;
  const int descriptor = open_lock(path);
  if (lock_now(descriptor, path))
    lock.descriptor_ = descriptor;
  else
    close(descriptor);
  return lock;
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

FileLock::FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

}  // namespace lodestone
