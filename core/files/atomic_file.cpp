#include "core/files/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

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

}  // namespace

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
    descriptor_ = temporary_.create_file(final_);
  }
  if (descriptor_ < 0) fail("cannot create");
}

AtomicFile::AtomicFile(fs::path target, const fs::path& written)
    : target_(std::move(target)), final_(written), descriptor_(open(written.c_str(), O_WRONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) fail("cannot open the file that another process is writing as " + written.string());
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

void AtomicFile::reserve(std::uint64_t bytes) {
  if (temporary_.path().empty() || bytes == 0) return;
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
  if (!temporary_.path().empty() && fsync(descriptor_) != 0) fail("cannot force to the medium");
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
  if (temporary_.path().empty()) return;
  if (!temporary_.rename_to(final_)) fail("cannot rename the finished file");
}

void AtomicFile::fail(const std::string& what) const {
  const int error = errno;
  throw FileError(describe(target_.string(), "", what + ": " + std::strerror(error), remedy_for(error)));
}

}  // namespace lodestone
