#include "core/files/temporaries.h"

#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr const char* mark = ".tmp.";

// Unique among the temporaries of this process, but not among those that others have left: numbers of processes return.
fs::path name_beside(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  fs::path name = target;
  name += mark + std::to_string(getpid()) + "." + std::to_string(counter++);
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

// True if it is locked, or cannot be on this file system; false if another process removes it as an orphan.
bool lock(int descriptor) {
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;
  struct stat status {};
  return fstat(descriptor, &status) != 0 || status.st_nlink > 0;
}

// ---- removal, by system calls alone: memory may have run out, or a signal may have interrupted an allocation ----

void remove_entry(int folder, const char* name) noexcept;

void remove_contents(int folder) noexcept {
  alignas(dirent64) char entries[4096];
  bool removed = true;
  while (std::exchange(removed, false)) {  // removing entries may move those that were not listed yet
    lseek(folder, 0, SEEK_SET);
    for (long bytes; (bytes = syscall(SYS_getdents64, folder, entries, sizeof(entries))) > 0;)
      for (long at = 0; at < bytes;) {
        const auto* entry = reinterpret_cast<const dirent64*>(entries + at);
        at += entry->d_reclen;
        if (std::strcmp(entry->d_name, ".") == 0 || std::strcmp(entry->d_name, "..") == 0) continue;
        remove_entry(folder, entry->d_name);
        removed = removed || faccessat(folder, entry->d_name, F_OK, AT_SYMLINK_NOFOLLOW) != 0;
      }
  }
}

void remove_entry(int folder, const char* name) noexcept {
  if (unlinkat(folder, name, 0) == 0 || (errno != EISDIR && errno != EPERM)) return;
  const int inner = openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (inner < 0) return;
  remove_contents(inner);
  close(inner);
  unlinkat(folder, name, AT_REMOVEDIR);
}

}  // namespace

// Head of the list, linked through previous_ and next_.
Temporary* Temporary::first_ = nullptr;

// With the list locked.
void Temporary::enter(fs::path&& name, int lock) {
  path_ = std::move(name);
  lock_ = lock;
  next_ = std::exchange(first_, this);
  if (next_) next_->previous_ = this;
}

int Temporary::create_file(const fs::path& target) {
  for (;;) {
    fs::path name = name_beside(target);
    const ListLock guard;
    const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0 && errno == EEXIST) continue;
    if (file < 0) return -1;
    const bool ours = lock(file);
    const int held = ours ? fcntl(file, F_DUPFD_CLOEXEC, 0) : -1;
    if (held >= 0) {
      enter(std::move(name), held);
      return file;
    }
    const int error = errno;
    if (ours) unlink(name.c_str());
    close(file);
    errno = error;
    if (ours) return -1;
  }
}

bool Temporary::create_folder(const fs::path& target) {
  for (;;) {
    fs::path name = name_beside(target);
    const ListLock guard;
    if (mkdir(name.c_str(), 0777) != 0) {
      if (errno == EEXIST) continue;
      return false;
    }
    const int folder = open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0 && errno != ENOENT) {
      const int error = errno;
      rmdir(name.c_str());
      errno = error;
      return false;
    }
    if (folder >= 0 && lock(folder)) {
      enter(std::move(name), folder);
      return true;
    }
    if (folder >= 0) close(folder);
  }
}

// With the list locked.
void Temporary::forget() {
  (previous_ ? previous_->next_ : first_) = next_;
  if (next_) next_->previous_ = previous_;
  if (lock_ >= 0) close(std::exchange(lock_, -1));
  path_.clear();
}

bool Temporary::rename_to(const fs::path& target) {
  const ListLock guard;
  if (std::rename(path_.c_str(), target.c_str()) != 0) return false;
  forget();
  return true;
}

void Temporary::remove() noexcept {
  if (path_.empty()) return;
  const ListLock guard;
  remove_entry(AT_FDCWD, path_.c_str());
  forget();
}

void remove_temporaries() noexcept {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);  // a second handler on this thread would wait for the first one
  lock_list();
  for (const Temporary* one = Temporary::first_; one; one = one->next_) remove_entry(AT_FDCWD, one->path_.c_str());
}

void remove_orphans(const fs::path& target) {
  const fs::path folder = target.parent_path().empty() ? "." : target.parent_path();
  remove_orphans(folder, [name = target.filename().string()](std::string_view file) { return file == name; });
}

void remove_orphans(const fs::path& folder, const std::function<bool(std::string_view)>& is_target) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t end = name.rfind(mark);
    if (end == std::string::npos ||
        name.find_first_not_of("0123456789.", end + std::strlen(mark)) != std::string::npos ||
        !is_target(std::string_view(name).substr(0, end)))
      continue;
    const int way = entry.is_directory(ignored) ? O_RDONLY | O_DIRECTORY : O_RDWR | O_NONBLOCK;
    const int descriptor = open(entry.path().c_str(), way | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor < 0) continue;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) remove_entry(AT_FDCWD, entry.path().c_str());
    close(descriptor);
  }
}

}  // namespace lodestone
