// Input files: read at byte offsets, or mapped as read-only memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace lodestone {

// Has no shared position, so that any number of threads may read one file at once.
class InputFile {
 public:
  // Throws FileError when the file is missing, unreadable or not a regular file (its size has to be known, because the
  // counts that mesh files declare are checked against it before memory is allocated).
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }  // bytes, when it was opened

  // Fills `bytes` from `offset` on and returns the number of bytes read: fewer than asked at the end of the file only.
  // Throws FileError when the disk fails. Safe to call from several threads.
  std::size_t read_at(std::uint64_t offset, std::span<char> bytes) const;

 private:
  friend class MappedFile;
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

// Equal for a file that has not changed, by its size, its time and samples of its bytes, and for a folder of such
// files. Throws as InputFile does.
[[nodiscard]] std::uint64_t file_identity(const std::filesystem::path& path);

class MappedFile {
 public:
  // Throws FileError as InputFile does. An empty file gives no bytes.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  // Page-aligned. Touching a page that the file no longer has, or that the disk cannot read, raises SIGBUS.
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

  // Releases the memory of the whole pages of `part`; they are read again when touched.
  void forget(std::span<const std::byte> part) const;

 private:
  friend const char* mapped_file_at(const void* address) noexcept;
  std::string name_;
  std::span<const std::byte> bytes_;
};

// Name of the file whose mapped bytes hold this address, null if none do. For the handler of SIGBUS: safe to call there
// on the thread that touched them, while others map and release files.
[[nodiscard]] const char* mapped_file_at(const void* address) noexcept;

}  // namespace lodestone
