// Output files that are either complete or absent.
//
// The bytes go to a temporary name beside the target, which commit() renames over it; if writing ends earlier (an
// exception, a full disk), the temporary is removed and the target is left as it was. This guards against a failing
// program and a full disk; against a power cut only if sync() forces the bytes to the medium first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "core/files/temporaries.h"

namespace lodestone {

// Every member throws FileError naming the target when the file system refuses. A target that exists and is not a
// regular file (a pipe, /dev/null) is written to directly, without a temporary: renaming over it would destroy it. A
// symbolic link is followed, so that the link is kept and its target is replaced.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path target);
  // A file that another process is writing under `written`, its written_path(): for write_at(), and for commit(), which
  // leaves it to that process to make it appear.
  AtomicFile(std::filesystem::path target, const std::filesystem::path& written);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  // Name under which the bytes are written.
  [[nodiscard]] const std::filesystem::path& written_path() const {
    return temporary_.path().empty() ? final_ : temporary_.path();
  }

  // Reserves space for bytes that write_at() will write: a full disk is reported before any work, and several threads
  // write without waiting for the file to grow. Does nothing on file systems that cannot reserve. All of the bytes must
  // then be written.
  void reserve(std::uint64_t bytes);

  // Appends. Small pieces are gathered into blocks of a mebibyte.
  void write(std::span<const std::byte> bytes);

  // Writes at a byte offset from the start, extending the file when needed. Any number of threads may do so at once, on
  // disjoint ranges; the position of write() does not move. The range must not overlap bytes that write() has yet to
  // flush().
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);

  void flush();  // hands the gathered bytes to the file system
  void sync();   // and waits until they are on the medium; of regular files
  [[nodiscard]] std::uint64_t position() const { return position_; }  // bytes appended by write() so far

  // Makes the file appear under its name. Called at most once, with no writes after it.
  void commit();

 private:
  void write_through(std::uint64_t offset, std::span<const std::byte> bytes);
  [[noreturn]] void fail(const std::string& what) const;  // from errno

  std::filesystem::path target_;  // as given, for messages
  std::filesystem::path final_;   // with symbolic links resolved
  Temporary temporary_;           // none when the target is written to directly
  int descriptor_ = -1;
  bool seekable_ = true;
  std::uint64_t position_ = 0;
  std::size_t buffered_ = 0;
  std::unique_ptr<std::byte[]> buffer_;
};

}  // namespace lodestone
