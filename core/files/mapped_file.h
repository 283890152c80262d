// A file's bytes as read-only memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace lodestone {

class MappedFile {
 public:
  // Throws FileError when the file is missing, unreadable or not a regular file. An empty file gives no bytes.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  // Page-aligned. The file must not be shortened while it is in use.
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

  // Lets the memory behind the whole pages of `part` go; they are read again when touched.
  void forget(std::span<const std::byte> part) const;

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace lodestone
