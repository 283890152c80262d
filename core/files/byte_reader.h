// Sequential reading of a file, or of bytes in memory, through a window of bounded size.
//
// All readers of mesh files use it, so that none holds a file and its mesh in memory at once, and each is a pure
// function of bytes, which tests and fuzz harnesses supply.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/input_file.h"

namespace lodestone {

// A folder in which a file looks for the files that it names: names are relative to `path`.
struct CompanionFolder {
  std::filesystem::path path;
  // Files outside of this folder, also by a symbolic link, are not read; nothing: files anywhere are.
  std::optional<std::filesystem::path> limit;
};

class ByteReader {
 public:
  static constexpr std::size_t max_window = std::size_t{1} << 20;

  // Throw FileError. The files that this one names must be in its folder, or in `limit`. `progress` gets the share of
  // the file that has been read, in (0, 1], whenever more of it is: about once a mebibyte; what it throws ends the
  // reading.
  explicit ByteReader(const std::filesystem::path& path);
  ByteReader(const std::filesystem::path& path, std::optional<std::filesystem::path> limit,
             std::function<void(double share)> progress = {});
  // The bytes must outlive the reader; the name stands for the file in messages.
  ByteReader(std::span<const char> bytes, std::string name, std::optional<CompanionFolder> folder = {});

  [[nodiscard]] const std::string& name() const { return name_; }
  // The folder of the files that this one names; empty for bytes in memory, which have no such files.
  [[nodiscard]] const std::optional<CompanionFolder>& folder() const { return folder_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t offset() const { return base_ + position_; }
  [[nodiscard]] std::uint64_t remaining() const { return size_ - offset(); }

  // The buffered bytes from the current offset on: at least `least` of them (at most max_window), fewer only at the end
  // of the input. Valid until the next call. Throws FileError when the disk fails.
  [[nodiscard]] std::string_view window(std::size_t least) {
    if (filled_ - position_ < least) refill(least);
    return {data_ + position_, filled_ - position_};
  }
  // Advances by at most the size of the last window.
  void advance(std::size_t count) { position_ += count; }
  // Advances by any distance, at most to the end.
  void skip(std::uint64_t count);

 private:
  void refill(std::size_t least);

  std::string name_;
  std::optional<CompanionFolder> folder_;
  std::uint64_t size_ = 0;
  std::uint64_t base_ = 0;                 // offset of data_[0] in the input
  std::size_t position_ = 0, filled_ = 0;  // in data_
  const char* data_ = nullptr;
  std::optional<InputFile> file_;  // empty when the bytes are in memory
  std::unique_ptr<char[]> buffer_;
  std::function<void(double)> progress_;
};

// The rest of the input.
[[nodiscard]] std::vector<char> read_all(ByteReader& input);

}  // namespace lodestone
