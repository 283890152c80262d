// An output folder that is either complete or absent.
#pragma once

#include <filesystem>
#include <string>

#include "core/files/temporaries.h"

namespace lodestone {

// Files are written into path(), a temporary folder, which commit() renames to the target; if writing
// ends earlier, the temporary is removed. A target that exists has to be an empty folder: then the temporary is created
// inside it, and commit() moves its entries up, so that a mount point, a link or the working folder may be the target.
//
// Throws FileError naming the target when it cannot be created, is not a folder or is not empty. What a killed
// process has left is removed by the next one with this target.
class AtomicFolder {
 public:
  explicit AtomicFolder(const std::filesystem::path& target);
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return temporary_.path(); }
  // Creates a folder below path().
  void add_folder(const std::string& name);
  // Makes everything appear under the target. Called at most once, with no writes after it.
  void commit();

 private:
  void move_entries_up();
  [[noreturn]] void fail(const std::string& what, const std::string& remedy) const;

  std::string name_;  // as given, for messages
  std::filesystem::path target_;
  Temporary temporary_;
  bool exists_ = false;
};

}  // namespace lodestone
