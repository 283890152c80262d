#include "core/files/atomic_file.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

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

std::string temporary_suffix() { return ".tmp." + std::to_string(getpid()); }

// Unique among the files of this process, and among processes.
fs::path temporary_beside(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  fs::path name = target;
  name += temporary_suffix() + "." + std::to_string(counter++);
  return name;
}

// Lock of the list of temporaries, for remove_temporaries(). A thread holds it while it creates, renames or removes
// one, with all signals blocked: a handler never interrupts the holder, may wait for it, and finds that the list agrees
// with the folder. A handler that ends the process never releases the lock, and nothing changes after it.
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
    const int error = errno;  // that of the guarded call
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

// Head of the list of files that have a temporary, linked through previous_ and next_.
AtomicFile* AtomicFile::first_ = nullptr;

void AtomicFile::enter_list() {
  next_ = std::exchange(first_, this);
  if (next_) next_->previous_ = this;
}

void AtomicFile::leave_list() {
  (previous_ ? previous_->next_ : first_) = next_;
  if (next_) next_->previous_ = previous_;
}

AtomicFile::AtomicFile(fs::path target)
    : target_(std::move(target)), buffer_(std::make_unique_for_overwrite<std::byte[]>(buffer_bytes)) {
  std::error_code ignored;
  final_ = fs::is_symlink(target_, ignored) ? fs::weakly_canonical(target_, ignored) : target_;
  if (final_.empty()) final_ = target_;
  const fs::file_status status = fs::status(final_, ignored);
  if (fs::is_directory(status)) {
    errno = EISDIR;
    fail("cannot write");
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
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

void remove_orphans(const fs::path& target) {
  const std::string prefix = target.filename().string() + ".tmp.";
  std::error_code ignored;
  const fs::path folder = target.parent_path().empty() ? "." : target.parent_path();
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) continue;
    const long process = std::strtol(name.c_str() + prefix.size(), nullptr, 10);
    if (process > 0 && kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH) fs::remove(entry.path(), ignored);
  }
}

AtomicFolder::AtomicFolder(const fs::path& target) : name_(target.string()) {
  std::error_code error;
  target_ = fs::weakly_canonical(fs::absolute(target, error), error);
  if (!target_.has_filename()) target_ = target_.parent_path();  // "tiles/" that does not exist yet
  const fs::file_status status = fs::status(target_, error);
  exists_ = fs::exists(status);
  if (exists_ && !fs::is_directory(status)) fail("is a file", "name a folder");
  if (exists_ && !fs::is_empty(target_, error)) {
    if (error) fail("cannot be read: " + error.message(), "choose a folder you may write to");
    fail("is not empty", "name a new folder, or empty this one");
  }
  temporary_ = exists_ ? target_ / temporary_suffix() : fs::path(target_.string() + temporary_suffix());
  if (!fs::create_directory(temporary_, error)) {
    const std::string reason = error ? error.message() : "its temporary name is taken";
    temporary_.clear();
    fail("cannot create the folder: " + reason, "name one in a folder you may write to");
  }
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void AtomicFolder::add_folder(const std::string& name) {
  std::error_code error;
  fs::create_directories(temporary_ / name, error);
  if (error) fail("cannot create the folder " + name + " inside it: " + error.message(), "free some space");
}

void AtomicFolder::commit() {
  std::error_code error;
  if (exists_) {
    move_entries_up();
  } else if (fs::rename(temporary_, target_, error); error) {
    fail("cannot rename the finished folder: " + error.message(), "name a new folder");
  }
  temporary_.clear();
}

// Folders before files: the file that names the others (tileset.json) comes last.
void AtomicFolder::move_entries_up() {
  std::error_code error;
  std::vector<fs::directory_entry> entries{fs::directory_iterator(temporary_, error), fs::directory_iterator()};
  std::stable_partition(entries.begin(), entries.end(), [](const auto& entry) { return entry.is_directory(); });
  std::vector<fs::path> moved;
  for (const fs::directory_entry& entry : entries) {
    const fs::path to = target_ / entry.path().filename();
    if (fs::rename(entry.path(), to, error); error) {
      std::error_code ignored;
      for (const fs::path& path : moved) fs::remove_all(path, ignored);
      fail("cannot move the finished files: " + error.message(), "name a new folder");
    }
    moved.push_back(to);
  }
  fs::remove(temporary_, error);
}

void AtomicFolder::fail(const std::string& what, const std::string& remedy) const {
  throw FileError(describe(name_, "", what, remedy));
}

}  // namespace lodestone
