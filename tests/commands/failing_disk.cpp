// A disk that fails in the middle of work, for LD_PRELOAD: the reads (writes) at offsets succeed for so many bytes in
// all and fail from then on, with the error of a broken medium (a full disk). DISK_READS and DISK_WRITES are numbers of
// bytes; what is not set never fails. DISK_ENDS cuts all files short instead, as if they were shortened meanwhile.
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

namespace {

long long left_of(const char* variable) {
  const char* text = std::getenv(variable);
  return text ? std::atoll(text) : (1LL << 62);
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// True if `bytes` more may pass.
bool passes(std::atomic<long long>& left, size_t bytes) { return (left -= static_cast<long long>(bytes)) >= 0; }

}  // namespace

extern "C" ssize_t pread64(int descriptor, void* bytes, size_t count, off64_t offset) {
  static auto* const real = next<ssize_t(int, void*, size_t, off64_t)>("pread64");
  static std::atomic<long long> left{left_of("DISK_READS")};
  static const bool ends = std::getenv("DISK_ENDS") != nullptr;
  if (passes(left, count)) return real(descriptor, bytes, count, offset);
  if (ends) return 0;
  errno = EIO;
  return -1;
}
extern "C" ssize_t pread(int descriptor, void* bytes, size_t count, off_t offset) {
  return pread64(descriptor, bytes, count, offset);
}

extern "C" ssize_t pwrite64(int descriptor, const void* bytes, size_t count, off64_t offset) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off64_t)>("pwrite64");
  static std::atomic<long long> left{left_of("DISK_WRITES")};
  if (passes(left, count)) return real(descriptor, bytes, count, offset);
  errno = ENOSPC;
  return -1;
}
extern "C" ssize_t pwrite(int descriptor, const void* bytes, size_t count, off_t offset) {
  return pwrite64(descriptor, bytes, count, offset);
}
