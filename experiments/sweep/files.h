// The files of a sweep's directory: whole or not there, forced to the medium, shared between processes by locks.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/files/json.h"
#include "parallel/scheduler/scheduler.h"

namespace lodestone {

// All throw FileError when the file system refuses.
void make_folder(const std::filesystem::path& folder);
void write_aside(const std::filesystem::path& target, std::string_view text);
// The same, and a power cut right afterwards leaves the file as it is then.
void write_durably(const std::filesystem::path& target, std::string_view text);
// Null for a text that is not JSON.
[[nodiscard]] Json json_or_null(const std::string& text);
// Null when the file is missing or is not JSON.
[[nodiscard]] Json read_json(const std::filesystem::path& path);
// Empty when the file is missing.
[[nodiscard]] std::string read_if_there(const std::filesystem::path& path);

// Removes unfinished files that killed processes have left. The caller holds the lock of the folder.
void remove_temporaries_in(const std::filesystem::path& folder);

// An exclusive lock (flock) on a file that is made for it and kept. It ends with the last process that has the
// descriptor: a child that has inherited it keeps others off for as long as it lives.
class FileLock {
 public:
  // Waits for it. Throws Cancelled when the flag is set meanwhile.
  explicit FileLock(const std::filesystem::path& path, const CancelFlag* cancel = nullptr);
  // Holds it or does not, see held().
  static FileLock try_lock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&&) = delete;

  [[nodiscard]] bool held() const { return descriptor_ >= 0; }
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  FileLock() = default;
  int descriptor_ = -1;
};

}  // namespace lodestone
