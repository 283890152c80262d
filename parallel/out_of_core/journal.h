// A record on disk of what an out-of-core build has done so far, so that an interrupted one can be continued.
//
// A file of records, each with its length and checksum. One that was cut off or damaged, and all after it, count as
// not done. A record is written after everything that it describes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <type_traits>
#include <vector>

#include "core/base/error.h"
#include "core/files/scratch_file.h"

namespace lodestone {

class Journal {
 public:
  enum class Kind : std::uint32_t { begin, spilled, block };

  // Opens or creates the file and calls take(kind, bytes) for every valid record, as long as that returns true; what
  // follows is discarded. Throws ResourceError when another process uses the file.
  Journal(const std::filesystem::path& path, const std::function<bool(Kind, std::span<const std::byte>)>& take);

  // From any thread, at any time.
  void append(Kind kind, std::span<const std::byte> bytes);

 private:
  std::unique_ptr<ScratchFile> file_;
  std::mutex writing_;
};

// Plain data to bytes and back.
class ByteWriter {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(std::as_bytes(std::span(&value, 1)));
  }
  template <class T>
  void put_vector(const std::vector<T>& items) {
    put(static_cast<std::uint64_t>(items.size()));
    append(std::as_bytes(std::span<const T>(items)));
  }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  void append(std::span<const std::byte> bytes);
  std::vector<std::byte> bytes_;
};

// For bytes of a ByteWriter with the same calls in the same order. Throws Error where they end too early.
class ByteSource {
 public:
  explicit ByteSource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  [[nodiscard]] std::span<const std::byte> left() const { return bytes_; }
  void take(std::span<std::byte> to);
  template <class T>
  void get(T& value) {
    take(std::as_writable_bytes(std::span(&value, 1)));
  }
  template <class T>
  void get_vector(std::vector<T>& items) {
    std::uint64_t size = 0;
    get(size);
    if (size > bytes_.size() / sizeof(T)) throw Error("a record ends too early");
    items.resize(size);
    take(std::as_writable_bytes(std::span(items)));
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace lodestone
