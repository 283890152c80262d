#include "core/files/atomic_folder.h"

#include <unistd.h>

#include <algorithm>
#include <system_error>
#include <vector>

#include "core/base/error.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

std::string temporary_suffix() { return ".tmp." + std::to_string(getpid()); }

}  // namespace

AtomicFolder::AtomicFolder(const fs::path& target) : name_(target.string()) {
  std::error_code error;
  target_ = fs::weakly_canonical(fs::absolute(target, error), error);
  if (!target_.has_filename()) target_ = target_.parent_path();  // "tiles/" that is not there yet
  const fs::file_status status = fs::status(target_, error);
  exists_ = fs::exists(status);
  if (exists_ && !fs::is_directory(status)) fail("is a file", "name a folder");
  if (exists_ && !fs::is_empty(target_, error)) {
    if (error) fail("cannot be read: " + error.message(), "choose a folder you may write to");
    fail("is not empty", "name a new folder, or empty this one");
  }
  temporary_ = exists_ ? target_ / temporary_suffix() : fs::path(target_.string() + temporary_suffix());
  if (!fs::create_directory(temporary_, error)) {
    const std::string reason = error ? error.message() : "there is one under its temporary name";
    temporary_.clear();
    fail("cannot create the folder: " + reason, "name one in a folder you may write to");
  }
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void AtomicFolder::add_folder(const std::string& name) {
  std::error_code error;
  fs::create_directories(temporary_ / name, error);
  if (error) fail("cannot create the folder " + name + " in it: " + error.message(), "free some space");
}

void AtomicFolder::commit() {
  std::error_code error;
  if (exists_) {
    move_entries_up();
  } else if (fs::rename(temporary_, target_, error); error) {
    fail("cannot rename the finished folder: " + error.message(), "name a new folder");
  }
  temporary_.clear();
}

// Folders before files: what names the others (tileset.json) comes last.
void AtomicFolder::move_entries_up() {
  std::error_code error;
  std::vector<fs::directory_entry> entries{fs::directory_iterator(temporary_, error), fs::directory_iterator()};
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
  fs::remove(temporary_, error);
}

void AtomicFolder::fail(const std::string& what, const std::string& remedy) const {
  throw FileError(describe(name_, "", what, remedy));
}

}  // namespace lodestone
