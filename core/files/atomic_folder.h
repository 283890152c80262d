// Output folders that are either complete or not there.
#pragma once

#include <filesystem>
#include <string>

namespace lodestone {

// Files are written into path(), a temporary folder, which commit() renames to the target; whatever ends the writing
// earlier removes it. A target that is there has to be an empty folder: then the temporary lies in it, and commit()
// moves its entries up, so that a mount point, a link or the working folder may be the target, too.
//
// Throws FileError naming the target when it cannot be made, is no folder or is not empty. A process that is killed
// leaves the temporary: those who write folders end on a flag (Ctrl-C), not in a signal handler.
class AtomicFolder {
 public:
  explicit AtomicFolder(const std::filesystem::path& target);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }
  // Creates a folder below path().
  void add_folder(const std::string& name);
  // Makes everything appear under the target. At most once, and nothing is written afterwards.
  void commit();

 private:
  void move_entries_up();
  [[noreturn]] void fail(const std::string& what, const std::string& remedy) const;

  std::string name_;  // as given, for messages
  std::filesystem::path target_, temporary_;
  bool exists_ = false;
};

}  // namespace lodestone
