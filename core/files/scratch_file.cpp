#include "core/files/scratch_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "core/base/error.h"

namespace lodestone {
namespace {

const char* scratch_remedy(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return "create the folder for temporary files first";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder for temporary files that you may write to (--scratch)";
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space there, or put the temporary files on another disk (--scratch)";
    default:
      return "";
  }
}

[[noreturn]] void fail_with(const std::string& name, const std::string& what, int error) {
  throw FileError(describe(name, "", what + ": " + std::strerror(error), scratch_remedy(error)));
}

// Not all file systems support files without a name.
int open_nameless(const std::filesystem::path& folder) {
  const int descriptor = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return descriptor;
  std::string name = (folder / "lodestone.XXXXXX").string();
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

}  // namespace

ScratchFile::ScratchFile(std::string name, int descriptor) : name_(std::move(name)), descriptor_(descriptor) {
  if (descriptor_ < 0) fail("cannot create temporary files");
  struct stat status {};
  if (fstat(descriptor_, &status) == 0) end_ = static_cast<std::uint64_t>(status.st_size);
}

ScratchFile::~ScratchFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::unique_ptr<ScratchFile> ScratchFile::named(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  return std::unique_ptr<ScratchFile>(new ScratchFile(path.string(), descriptor));
}

std::unique_ptr<ScratchFile> ScratchFile::nameless(const std::filesystem::path& folder) {
  return std::unique_ptr<ScratchFile>(new ScratchFile(folder.string(), open_nameless(folder)));
}

void ScratchFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot write temporary data");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
}

void ScratchFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got = pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("cannot read temporary data");
    if (got == 0) throw FileError(describe(name_, "", "temporary data is missing", "build again without --resume"));
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
}

void ScratchFile::truncate(std::uint64_t size) {
  if (ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail("cannot shorten");
  end_ = size;
}

bool ScratchFile::lock() {
  while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return false;
    if (errno != EINTR) return true;  // a file system without locks
  }
  return true;
}

void ScratchFile::fail(const std::string& what) const { fail_with(name_, what, errno); }

std::uint64_t free_bytes(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  if (error) fail_with(folder.string(), "cannot put temporary files there", error.value());
  return space.available;
}

}  // namespace lodestone
