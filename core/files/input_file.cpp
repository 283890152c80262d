#include "core/files/input_file.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <functional>
#include <system_error>
#include <vector>

#include "core/base/error.h"
#include "core/files/checksum.h"

namespace lodestone {
namespace {

// All mapped files, under a lock that a signal handler may wait for: nobody touches mapped bytes while holding it.
std::atomic_flag mapped_locked;
std::vector<const MappedFile*> mapped;

class MappedLock {
 public:
  MappedLock() {
    while (mapped_locked.test_and_set(std::memory_order_acquire)) sched_yield();
  }
  ~MappedLock() { mapped_locked.clear(std::memory_order_release); }
  MappedLock(const MappedLock&) = delete;
  MappedLock& operator=(const MappedLock&) = delete;
};

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : name_(path.string()) {
  // Without O_NONBLOCK, opening a pipe without a writer would hang.
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0)
    throw FileError(describe(name_, "", std::string("cannot open: ") + std::strerror(errno),
                             errno == ENOENT ? "check the name and the folder" : ""));
  struct stat status {};
  if (fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
    close(descriptor_);
    throw FileError(describe(name_, "", "is not a regular file", "give a file on a disk, not a folder or a pipe"));
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

InputFile::~InputFile() { close(descriptor_); }

std::size_t InputFile::read_at(std::uint64_t offset, std::span<char> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw FileError(describe(name_, "byte " + std::to_string(offset + done),
                               std::string("cannot read: ") + std::strerror(errno)));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

std::uint64_t file_identity(const std::filesystem::path& path) {
  constexpr std::size_t samples = 64, sample_bytes = 4096;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    std::uint64_t sum = 0;
    for (const auto& entry : std::filesystem::directory_iterator(path)) sum += file_identity(entry.path());
    return sum;
  }
  const InputFile file(path);
  std::vector<std::uint64_t> sums{
      file.size(),
      static_cast<std::uint64_t>(std::filesystem::last_write_time(path, ignored).time_since_epoch().count())};
  std::vector<char> bytes(sample_bytes);
  for (std::size_t i = 0; i < samples; ++i) {
    const std::size_t got = file.read_at(file.size() / samples * i, bytes);
    sums.push_back(checksum(std::as_bytes(std::span(bytes).first(got))));
  }
  return checksum(std::as_bytes(std::span(sums)));
}

MappedFile::MappedFile(const std::filesystem::path& path) : name_(path.string()) {
  const InputFile file(path);
  if (file.size() == 0) return;
  const MappedLock lock;
  mapped.push_back(this);
  void* const address = mmap(nullptr, file.size(), PROT_READ, MAP_PRIVATE, file.descriptor_, 0);
  if (address == MAP_FAILED) {
    mapped.pop_back();
    throw FileError(describe(name_, "", std::string("cannot map into memory: ") + std::strerror(errno)));
  }
  bytes_ = {static_cast<const std::byte*>(address), file.size()};
}

MappedFile::~MappedFile() {
  if (bytes_.empty()) return;
  const MappedLock lock;
  std::erase(mapped, this);
  munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

const char* mapped_file_at(const void* address) noexcept {
  const MappedLock lock;
  for (const MappedFile* file : mapped)
    if (std::less_equal<>()(file->bytes_.data(), address) &&
        std::less<>()(address, static_cast<const void*>(file->bytes_.data() + file->bytes_.size())))
      return file->name_.c_str();
  return nullptr;
}

void MappedFile::forget(std::span<const std::byte> part) const {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = (reinterpret_cast<std::uintptr_t>(part.data()) + page - 1) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(part.data() + part.size()) / page * page;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
}

}  // namespace lodestone
