#include "core/files/atomic_file.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>
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

// The temporaries that exist, for remove_temporaries(). A thread holds the lock while it makes, renames or removes one,
// with all signals blocked: so a handler never interrupts the holder, may wait for it, and finds the list in step with
// the folder. A handler that ends the process never gives the lock back, and nothing changes behind it.
std::atomic_flag list_locked;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler takes the lock");

void lock_list() {
  while (list_locked.test_and_set(std::memory_order_acquire)) poll(nullptr, 0, 1);
}

class ListLock {
 public:
  ListLock() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
    lock_list();
  }
  ~ListLock() {
    const int error = errno;  // that of the call the lock was held for
    list_locked.clear(std::memory_order_release);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    errno = error;
  }
  ListLock(const ListLock&) = delete;
  ListLock& operator=(const ListLock&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

// The files that have a temporary, linked through previous_ and next_.
AtomicFile* AtomicFile::first_ = nullptr;

void AtomicFile::enter_list() {
  next_ = std::exchange(first_, this);
  if (next_) next_->previous_ = this;
}

void AtomicFile::leave_list() {
  (previous_ ? previous_->next_ : first_) = next_;
  if (next_) next_->previous_ = previous_;
}

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
    const ListLock lock;
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) enter_list();
  }
  if (descriptor_ < 0) fail("cannot create");
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::reserve(std::uint64_t bytes) {
  if (temporary_.empty() || bytes == 0) return;
  while (fallocate(descriptor_, 0, 0, static_cast<off_t>(bytes)) != 0) {
    if (errno == EINTR) continue;
    if (errno == EOPNOTSUPP || errno == ENOSYS) return;
    fail("cannot reserve " + std::to_string(bytes) + " bytes");
  }
}

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

void AtomicFile::sync() {
  flush();
  if (!temporary_.empty() && fsync(descriptor_) != 0) fail("cannot force to the medium");
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
  if (!rename_temporary()) fail("cannot rename the finished file");
  temporary_.clear();
}

bool AtomicFile::rename_temporary() {
  const ListLock lock;
  if (std::rename(temporary_.c_str(), final_.c_str()) != 0) return false;
  leave_list();
  return true;
}

void AtomicFile::fail(const std::string& what) const {
  const int error = errno;
  throw FileError(describe(target_.string(), "", what + ": " + std::strerror(error), remedy_for(error)));
}

void AtomicFile::discard() noexcept {
  if (descriptor_ >= 0) close(std::exchange(descriptor_, -1));
  if (temporary_.empty()) return;
  const ListLock lock;
  unlink(temporary_.c_str());
  leave_list();
}

void remove_temporaries() noexcept {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);  // a second handler on this thread would wait for the first one
  lock_list();
  for (const AtomicFile* file = AtomicFile::first_; file; file = file->next_) unlink(file->temporary_.c_str());
}

void remove_orphans(const std::filesystem::path& target) {
  const std::string prefix = target.filename().string() + ".tmp.";
  std::error_code ignored;
  const std::filesystem::path folder = target.parent_path().empty() ? "." : target.parent_path();
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const long process = std::strtol(name.c_str() + prefix.size(), nullptr, 10);
    if (process > 0 && kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH)
      std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace lodestone
