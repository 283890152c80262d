// Temporary data on a disk, written and read at byte offsets, for work that is larger than memory.
//
// A file without a name disappears when the process ends, however it ends. A file with a name is kept, so that a later
// run can continue: this guards against a killed program, not against a power cut (nothing is forced to the medium).
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace lodestone {

// Every member throws FileError naming file and remedy when the file system refuses.
class ScratchFile {
 public:
  // Opens or creates `path`; its content is kept.
  [[nodiscard]] static std::unique_ptr<ScratchFile> named(const std::filesystem::path& path);
  // A new file without a name on the disk of `folder`.
  [[nodiscard]] static std::unique_ptr<ScratchFile> nameless(const std::filesystem::path& folder);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  // Any number of threads may use these at once, on disjoint ranges.
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;  // all of them, or it throws

  // Assigns a new range of this size to the caller; returns its offset.
  [[nodiscard]] std::uint64_t claim(std::uint64_t bytes) { return end_.fetch_add(bytes); }
  [[nodiscard]] std::uint64_t size() const { return end_; }  // end of the last range claimed
  // Discards everything after `size`.
  void truncate(std::uint64_t size);

  // False when another process holds it.
  [[nodiscard]] bool lock();

 private:
  ScratchFile(std::string name, int descriptor);
  [[noreturn]] void fail(const std::string& what) const;  // from errno

  std::string name_;
  int descriptor_;
  std::atomic<std::uint64_t> end_{0};
};

// Free bytes on the disk of this folder. Throws FileError when there is no such folder.
[[nodiscard]] std::uint64_t free_bytes(const std::filesystem::path& folder);

}  // namespace lodestone
