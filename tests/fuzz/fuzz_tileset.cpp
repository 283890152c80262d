// Trees of tilesets: the parts of the input, cut at zeros, are tileset.json, 1.json and 2.json of a folder that also
// has a link out of it. Any tiles that are found lie in the folder.
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "core/base/error.h"
#include "core/formats/tiles/tileset.h"
#include "tests/fuzz/json_mutator.h"

namespace {
namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("lodestone-fuzz." + std::to_string(getpid()));
  Folder() {
    fs::create_directories(path);
    std::ofstream(path / "a.glb") << "not read here";
    std::error_code ignored;
    fs::create_symlink("/etc", path / "out", ignored);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};
}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  return lodestone::mutate_json(data, size, max_size, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  for (const char* name : {"tileset.json", "1.json", "2.json"}) {
    const std::string_view part = rest.substr(0, rest.find('\0'));
    std::ofstream(folder.path / name, std::ios::binary) << part;
    rest.remove_prefix(std::min(rest.size(), part.size() + 1));
  }
  try {
    lodestone::ByteReader input(folder.path / "tileset.json");
    const std::string root = fs::canonical(folder.path).string() + '/';
    for (const lodestone::Tile& tile : lodestone::list_tiles(input).tiles)
      if (!fs::weakly_canonical(tile.file).string().starts_with(root)) std::abort();
  } catch (const lodestone::Error&) {
  }
  return 0;
}
