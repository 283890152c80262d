// Output files that are either complete or not there.
//
// The bytes go to a temporary name beside the target, which commit() renames over it; whatever ends the writing earlier
// (an exception, a full disk) removes the temporary and leaves the target as it was. This guards against a failing
// program and a full disk; against a power cut only where sync() forces the bytes to the medium first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace lodestone {

// Every member throws FileError naming the target when the file system refuses. A target that exists and is no regular
// file (a pipe, /dev/null) is written to directly, without a temporary: renaming over it would destroy it. A symbolic
// link is followed, so that the link stays and what it points to is replaced.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  // Asks the file system for room for so many bytes, to be written by write_at(): a full disk is told before any work,
  // and several threads write without waiting for the file to grow. File systems that cannot are let be. All of the
  // bytes must then be written.
  void reserve(std::uint64_t bytes);

  // Appends. Small pieces are gathered into blocks of a mebibyte.
  void write(std::span<const std::byte> bytes);

  // Writes at a byte offset from the start, extending the file when needed. Any number of threads may do so at once, on
  // disjoint ranges; the position of write() does not move. Do not aim it at bytes that write() has yet to flush().
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);

  void flush();  // hands the gathered bytes to the file system
  void sync();   // and waits until they are on the medium; of regular files
  [[nodiscard]] std::uint64_t position() const { return position_; }  // bytes appended by write() so far

  // Makes the file appear under its name. At most once, and nothing is written afterwards.
  void commit();

 private:
  void write_through(std::uint64_t offset, std::span<const std::byte> bytes);
  [[noreturn]] void fail(const std::string& what) const;  // from errno
  void discard() noexcept;
  [[nodiscard]] bool rename_temporary();
  void enter_list();
  void leave_list();
  friend void remove_temporaries() noexcept;

  static AtomicFile* first_;
  AtomicFile *previous_ = nullptr, *next_ = nullptr;  // in the list of all that have a temporary

  std::filesystem::path target_;     // as given, for messages
  std::filesystem::path final_;      // with symbolic links resolved
  std::filesystem::path temporary_;  // empty when the target is written to directly
  int descriptor_ = -1;
  bool seekable_ = true;
  std::uint64_t position_ = 0;
  std::size_t buffered_ = 0;
  std::unique_ptr<std::byte[]> buffer_;
};

// Removes the temporaries of all AtomicFiles under way, for the handler of a signal that ends the process: safe to call
// there on any thread, while others are creating, finishing or giving up files. The process has to end then: signals
// are blocked on this thread, and every other one stops where it next makes, finishes or gives up a file.
void remove_temporaries() noexcept;

// Removes the temporaries of this target that killed processes have left. For who knows that no other machine writes
// it.
void remove_orphans(const std::filesystem::path& target);

}  // namespace lodestone
