// A disk that fails in the middle of work, for LD_PRELOAD: the reads (writes) at offsets succeed for so many bytes in
// all and fail from then on, with the error of a broken medium (a full disk). DISK_READS and DISK_WRITES are numbers of
// bytes; what is not set never fails. DISK_ENDS cuts all files short instead, as if they were shortened meanwhile, and
// DISK_CUTS those that are mapped, to so many bytes. DISK_BREAKS gives writes, too, the error of a broken medium.
// DISK_PIECES moves at most so many bytes at a time. DISK_TEXTS, DISK_CLOSES, DISK_RENAMES and DISK_SYNCS are numbers of
// calls: so many reads of files in the working folder from their beginning on, closes of those that were written, renames
// and fsyncs succeed, and none after them.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace {

long long left_of(const char* variable) {
  const char* text = std::getenv(variable);
  return text ? std::atoll(text) : (1LL << 62);
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

size_t piece_of(size_t count) {
  static const long long most = left_of("DISK_PIECES");
  return std::min(count, static_cast<size_t>(most));
}

// True if `bytes` more may pass.
bool passes(std::atomic<long long>& left, size_t bytes) { return (left -= static_cast<long long>(bytes)) >= 0; }

// The open file; empty if it is not below the working folder, as libraries and what they map are not.
std::filesystem::path file_here(int descriptor) {
  std::error_code ignored;
  const auto file = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor), ignored);
  return file.string().starts_with(std::filesystem::current_path(ignored).string() + "/") ? file : "";
}

}  // namespace

extern "C" ssize_t pread64(int descriptor, void* bytes, size_t count, off64_t offset) {
  static auto* const real = next<ssize_t(int, void*, size_t, off64_t)>("pread64");
  static std::atomic<long long> left{left_of("DISK_READS")};
  static const bool ends = std::getenv("DISK_ENDS") != nullptr;
  if (passes(left, count)) return real(descriptor, bytes, piece_of(count), offset);
  if (ends) return 0;
  errno = EIO;
  return -1;
}
extern "C" ssize_t pread(int descriptor, void* bytes, size_t count, off_t offset) {
  return pread64(descriptor, bytes, count, offset);
}

extern "C" ssize_t read(int descriptor, void* bytes, size_t count) {
  static auto* const real = next<ssize_t(int, void*, size_t)>("read");
  static std::atomic<long long> left{left_of("DISK_TEXTS")};
  static const bool fails = std::getenv("DISK_TEXTS") != nullptr;
  if (!fails || file_here(descriptor).empty() || passes(left, 1)) return real(descriptor, bytes, count);
  errno = EIO;
  return -1;
}

extern "C" ssize_t pwrite64(int descriptor, const void* bytes, size_t count, off64_t offset) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64");
  static std::atomic<long long> left{left_of("DISK_WRITES")};
  static const bool breaks = std::getenv("DISK_BREAKS") != nullptr;
  if (passes(left, count)) return real(descriptor, bytes, piece_of(count), offset);
  errno = breaks ? EIO : ENOSPC;
  return -1;
}
extern "C" ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t offset) {
  return pwrite64(descriptor, bytes, count, offset);
}

extern "C" void* mmap(void* at, size_t bytes, int protection, int flags, int descriptor, off_t offset) noexcept {
  static auto* const real = next<void*(void*, size_t, int, int, int, off_t)>("mmap");
  static const char* const cut = std::getenv("DISK_CUTS");
  void* const mapped = real(at, bytes, protection, flags, descriptor, offset);
  std::error_code ignored;
  if (const auto file = cut && descriptor >= 0 ? file_here(descriptor) : ""; !file.empty())
    std::filesystem::resize_file(file, std::atoll(cut), ignored);
  return mapped;
}

// The file is closed all the same, as it is where the disk is remote.
extern "C" int close(int descriptor) {
  static auto* const real = next<int(int)>("close");
  static std::atomic<long long> left{left_of("DISK_CLOSES")};
  static const bool fails = std::getenv("DISK_CLOSES") != nullptr;
  const bool written = fails && (fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY && !file_here(descriptor).empty();
  const int result = real(descriptor);
  if (!written || passes(left, 1)) return result;
  errno = EIO;
  return -1;
}

extern "C" int rename(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("rename");
  static std::atomic<long long> left{left_of("DISK_RENAMES")};
  if (passes(left, 1)) return real(from, to);
  errno = EIO;
  return -1;
}

extern "C" int fsync(int descriptor) {
  static auto* const real = next<int(int)>("fsync");
  static std::atomic<long long> left{left_of("DISK_SYNCS")};
  if (passes(left, 1)) return real(descriptor);
  errno = EIO;
  return -1;
}
