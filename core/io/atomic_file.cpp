#include "core/io/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "core/base/error.h"

namespace lodestone {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

const char* remedy_for(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return "create the folder first";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder you may write to";
    case EISDIR:
      return "name a file, not a folder";
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space or choose another disk";
    default:
      return "";
  }
}

// Unique among the files this process writes, and among processes.
std::filesystem::path temporary_beside(const std::filesystem::path& target) {
  static std::atomic<unsigned> counter{0};
  std::filesystem::path name = target;
  name += ".tmp." + std::to_string(getpid()) + "." + std::to_string(counter++);
  return name;
}

// Names of the temporaries that exist, for remove_temporaries(). Each is owned by its AtomicFile.
std::array<std::atomic<const char*>, 64> temporaries{};
static_assert(std::atomic<const char*>::is_always_lock_free, "a signal handler reads them");

void remember(const char* name) {
  for (auto& slot : temporaries) {
    const char* empty = nullptr;
    if (slot.compare_exchange_strong(empty, name)) return;
  }
}

void forget(const char* name) {
  for (auto& slot : temporaries) {
    const char* found = name;
    if (slot.compare_exchange_strong(found, nullptr)) return;
  }
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target)
    : target_(std::move(target)), buffer_(std::make_unique_for_overwrite<std::byte[]>(buffer_bytes)) {
  std::error_code ignored;
  final_ =
      std::filesystem::is_symlink(target_, ignored) ? std::filesystem::weakly_canonical(target_, ignored) : target_;
  if (final_.empty()) final_ = target_;
  const std::filesystem::file_status status = std::filesystem::status(final_, ignored);
  if (std::filesystem::is_directory(status)) {
    errno = EISDIR;
    fail("cannot write");
  }
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    descriptor_ = open(final_.c_str(), O_WRONLY | O_CLOEXEC);
    seekable_ = descriptor_ >= 0 && lseek(descriptor_, 0, SEEK_CUR) >= 0;
  } else {
    temporary_ = temporary_beside(final_);
    remember(temporary_.c_str());  // first: a signal between the two would leave the file
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  if (descriptor_ < 0) {
    const int error = errno;
    if (!temporary_.empty()) forget(temporary_.c_str());
    errno = error;
    fail("cannot create");
  }
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (buffered_ + bytes.size() > buffer_bytes) flush();
  if (bytes.size() > buffer_bytes) {
    write_through(position_, bytes);
  } else if (!bytes.empty()) {
    std::memcpy(buffer_.get() + buffered_, bytes.data(), bytes.size());
    buffered_ += bytes.size();
  }
  position_ += bytes.size();
}

void AtomicFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (!seekable_) {
    errno = ESPIPE;
    fail("cannot write at an offset");
  }
  write_through(offset, bytes);
}

void AtomicFile::flush() {
  write_through(position_ - buffered_, {buffer_.get(), buffered_});
  buffered_ = 0;
}

void AtomicFile::write_through(std::uint64_t offset, std::span<const std::byte> bytes) {
  assert(descriptor_ >= 0);
  while (!bytes.empty()) {
    const ssize_t written = seekable_ ? pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset))
                                      : ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot write");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void AtomicFile::commit() {
  flush();
  // Some file systems (NFS, quotas) report a full disk only when the file is closed.
  if (close(std::exchange(descriptor_, -1)) != 0) fail("cannot finish writing");
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), final_.c_str()) != 0) fail("cannot rename the finished file");
  forget(temporary_.c_str());
  temporary_.clear();
}

void AtomicFile::fail(const char* what) const {
  const int error = errno;
  throw FileError(describe(target_.string(), "", std::string(what) + ": " + std::strerror(error), remedy_for(error)));
}

void AtomicFile::discard() noexcept {
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
  if (temporary_.empty()) return;
  unlink(temporary_.c_str());
  forget(temporary_.c_str());
}

void remove_temporaries() noexcept {
  for (const auto& slot : temporaries)
    if (const char* name = slot) unlink(name);
}

}  // namespace lodestone
