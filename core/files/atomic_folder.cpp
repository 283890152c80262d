#include "core/files/atomic_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include "core/base/error.h"

namespace lodestone {

namespace fs = std::filesystem;

AtomicFolder::AtomicFolder(const fs::path& target) : name_(target.string()) {
  std::error_code error;
  target_ = fs::weakly_canonical(fs::absolute(target, error), error);
  if (!target_.has_filename()) target_ = target_.parent_path();  // "tiles/" that does not exist yet
  const fs::file_status status = fs::status(target_, error);
  exists_ = fs::exists(status);
  if (exists_ && !fs::is_directory(status)) fail("is a file", "name a folder");
  const fs::path inside = target_ / "";
  remove_orphans(target_);
  if (exists_) remove_orphans(inside);
  if (exists_ && !fs::is_empty(target_, error)) {
    if (error) fail("cannot be read: " + error.message(), "choose a folder you may write to");
    fail("is not empty", "name a new folder, or empty this one");
  }
  if (!temporary_.create_folder(exists_ ? inside : target_))
    fail(std::string("cannot create the folder: ") + std::strerror(errno), "name one in a folder you may write to");
}

void AtomicFolder::add_folder(const std::string& name) {
  std::error_code error;
  fs::create_directories(path() / name, error);
  if (error) fail("cannot create the folder " + name + " inside it: " + error.message(), "free some space");
}

void AtomicFolder::commit() {
  if (exists_)
    move_entries_up();
  else if (!temporary_.rename_to(target_))
    fail(std::string("cannot rename the finished folder: ") + std::strerror(errno), "name a new folder");
}

// Folders before files: the file that names the others (tileset.json) comes last.
void AtomicFolder::move_entries_up() {
  std::error_code error;
  std::vector<fs::directory_entry> entries{fs::directory_iterator(path(), error), fs::directory_iterator()};
  std::stable_partition(entries.begin(), entries.end(), [](const auto& entry) { return entry.is_directory(); });
  std::vector<fs::path> moved;
  for (const fs::directory_entry& entry : entries) {
    const fs::path to = target_ / entry.path().filename();
    if (fs::rename(entry.path(), to, error); error) {
      std::error_code ignored;
      for (const fs::path& path : moved) fs::remove_all(path, ignored);
      fail("cannot move the finished files: " + error.message(), "name a new folder");
    }
    moved.push_back(to);
  }
  temporary_.remove();
}

void AtomicFolder::fail(const std::string& what, const std::string& remedy) const {
  throw FileError(describe(name_, "", what, remedy));
}

}  // namespace lodestone
