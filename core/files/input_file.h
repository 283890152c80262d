// Input files read at byte offsets: no shared position, so that any number of threads may read one file at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace lodestone {

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

  // Fills `bytes` from `offset` on and returns how many there were: fewer than asked at the end of the file only.
  // Throws FileError when the disk fails. Safe to call from several threads.
  std::size_t read_at(std::uint64_t offset, std::span<char> bytes) const;

 private:
  std::string name_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace lodestone
