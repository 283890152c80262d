#include "parallel/hierarchy/save_tiles.h"

#include <atomic>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/atomic_file.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/tiles/tileset_tree.h"

namespace lodestone {
namespace {

std::uint64_t write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
  return bytes.size();
}

// The image files of all levels, by path; the bytes are those of the hierarchy.
std::map<std::string, std::span<const char>> image_files(const Hierarchy& hierarchy) {
  std::map<std::string, std::span<const char>> files;
  const auto add = [&](std::uint32_t texture) {
    if (texture >= hierarchy.textures.size()) return;
    for (int level = 0; level <= hierarchy.finest(); ++level) {
      const TextureCopy* copy = texture_copy(hierarchy, texture, level);
      files[texture_path(hierarchy, texture, level)] = copy ? copy->bytes : hierarchy.textures[texture].bytes;
    }
  };
  for (const Material& material : hierarchy.materials) for_each_texture(material, add);
  return files;
}

class Saver {
 public:
  Saver(const Hierarchy& hierarchy, AtomicFolder& folder, Scheduler& scheduler, const SaveTilesConfig& config)
      : hierarchy_(hierarchy), folder_(folder), scheduler_(scheduler), config_(config) {}

  SavedTiles save() {
    for (int level = 0; level <= hierarchy_.finest(); ++level) folder_.add_folder(std::to_string(level));
    save_images();
    save_cells();
    save_tilesets();
    saved_.bytes += bytes_;
    return saved_;
  }

 private:
  void save_images() {
    const std::map<std::string, std::span<const char>> files = image_files(hierarchy_);
    if (!files.empty()) folder_.add_folder("textures");
    for (const auto& [path, bytes] : files) {
      stop_if_cancelled();
      bytes_ += write_file(folder_.path() / path, std::as_bytes(bytes));
    }
    saved_.textures = files.size();
  }

  void save_cells() {
    const TileErrors errors(hierarchy_);
    errors_.resize(hierarchy_.cells.size());
    scheduler_.for_chunks(hierarchy_.cells.size(), 1, [&](ChunkRange range) {
      stop_if_cancelled();
      const CellId cell(range.begin);
      errors_[cell] = errors.of(cell);
      if (!hierarchy_.cells[cell].triangles.empty()) save_cell(cell);
      report(++done_);
    });
    for (const Cell& cell : hierarchy_.cells) {
      saved_.tiles += !cell.triangles.empty();
      saved_.triangles += cell.triangles.size();
    }
  }

  void save_cell(CellId cell) {
    const int level = hierarchy_.level_of(cell);
    const auto uri = [&](std::uint32_t texture) { return "../" + texture_path(hierarchy_, texture, level); };
    const std::vector<std::byte> glb =
        encode_cell_glb(hierarchy_, cell, {.morph = config_.tileset.morph, .texture_uri = uri});
    bytes_ += write_file(folder_.path() / tile_path(hierarchy_, cell), glb);
  }

  void save_tilesets() {
    for (const TilesetFile& file : encode_tilesets(hierarchy_, errors_, config_.tileset)) {
      stop_if_cancelled();
      bytes_ += write_file(folder_.path() / file.path, std::as_bytes(std::span(file.json)));
      ++saved_.tilesets;
    }
  }

  void stop_if_cancelled() const {
    if (config_.cancel && *config_.cancel) throw Cancelled{};
  }

  void report(std::size_t done) {
    if (!config_.progress) return;
    if (const std::unique_lock lock(reporting_, std::try_to_lock); lock)
      config_.progress(static_cast<double>(done) / static_cast<double>(hierarchy_.cells.size()));
  }

  const Hierarchy& hierarchy_;
  AtomicFolder& folder_;
  Scheduler& scheduler_;
  const SaveTilesConfig& config_;
  std::vector<double> errors_;
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<std::size_t> done_{0};
  std::mutex reporting_;
  SavedTiles saved_;
};

}  // namespace

SavedTiles save_tiles(const Hierarchy& hierarchy, AtomicFolder& folder, Scheduler& scheduler,
                      const SaveTilesConfig& config) {
  return Saver(hierarchy, folder, scheduler, config).save();
}

}  // namespace lodestone
