#include "core/files/byte_reader.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "core/base/error.h"

namespace lodestone {

ByteReader::ByteReader(const std::filesystem::path& path) : ByteReader(path, path.parent_path()) {}

ByteReader::ByteReader(const std::filesystem::path& path, std::optional<std::filesystem::path> limit,
                       std::function<void(double)> progress)
    : name_(path.string()),
      folder_({path.parent_path(), std::move(limit)}),
      file_(std::in_place, path),
      buffer_(std::make_unique_for_overwrite<char[]>(max_window)),
      progress_(std::move(progress)) {
  size_ = file_->size();
  data_ = buffer_.get();
}

ByteReader::ByteReader(std::span<const char> bytes, std::string name, std::optional<CompanionFolder> folder)
    : name_(std::move(name)),
      folder_(std::move(folder)),
      size_(bytes.size()),
      filled_(bytes.size()),
      data_(bytes.data()) {}

void ByteReader::skip(std::uint64_t count) {
  count = std::min(count, remaining());
  if (count <= filled_ - position_) {
    position_ += static_cast<std::size_t>(count);
  } else {
    base_ = offset() + count;
    position_ = filled_ = 0;
  }
}

void ByteReader::refill([[maybe_unused]] std::size_t least) {
  assert(least <= max_window);
  if (!file_) return;
  filled_ -= position_;
  std::memmove(buffer_.get(), buffer_.get() + position_, filled_);
  base_ += std::exchange(position_, 0);
  const std::uint64_t left = size_ - (base_ + filled_);
  const std::size_t wanted = static_cast<std::size_t>(std::min<std::uint64_t>(left, max_window - filled_));
  const std::size_t got = file_->read_at(base_ + filled_, {buffer_.get() + filled_, wanted});
  filled_ += got;
  // The file has been shortened while it was read.
  if (got < wanted) size_ = base_ + filled_;
  if (progress_ && got > 0) progress_(static_cast<double>(base_ + filled_) / static_cast<double>(size_));
}

std::vector<char> read_all(ByteReader& input) {
  std::vector<char> bytes;
  bytes.reserve(input.remaining());
  for (std::string_view part = input.window(1); !part.empty(); part = input.window(1)) {
    bytes.insert(bytes.end(), part.begin(), part.end());
    input.advance(part.size());
  }
  return bytes;
}

}  // namespace lodestone
