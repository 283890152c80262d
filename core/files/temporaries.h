// Temporary files and folders: each lies beside its target until it is renamed to it.
//
// A temporary is listed, so that a handler of signals can remove it, and locked (flock), so that others see that its
// writer is alive.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace lodestone {

class Temporary {
 public:
  Temporary() = default;
  ~Temporary() { remove(); }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  // Create an empty one, named after `target` with a suffix that nobody uses. Called at most once.
  // A file: returns a descriptor that writes, which the caller closes; -1 with errno.
  [[nodiscard]] int create_file(const std::filesystem::path& target);
  // A folder: returns false with errno.
  [[nodiscard]] bool create_folder(const std::filesystem::path& target);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }  // empty: there is none
  // It is no longer temporary then. Returns false with errno.
  [[nodiscard]] bool rename_to(const std::filesystem::path& target);
  // With all that a folder holds. Allocates nothing.
  void remove() noexcept;

 private:
  void enter(std::filesystem::path&& name, int lock);
  void forget();
  friend void remove_temporaries() noexcept;

  static Temporary* first_;
  Temporary *previous_ = nullptr, *next_ = nullptr;  // in the list
  std::filesystem::path path_;
  int lock_ = -1;  // the descriptor that holds it
};

// Removes all temporaries of this process, for the handler of a signal that ends it: safe to call there on any thread,
// while others create, rename or remove some; allocates nothing. The process has to end after it: signals are blocked
// on this thread, and every other thread stops when it next does one of these.
void remove_temporaries() noexcept;

// Removes the temporaries of this target, a file or a folder, that killed processes have left: those that nobody has
// locked. Where the file system has no locks, none are removed.
void remove_orphans(const std::filesystem::path& target);
// The same for several files of a folder: `is_target` takes their names.
void remove_orphans(const std::filesystem::path& folder, const std::function<bool(std::string_view)>& is_target);

}  // namespace lodestone
