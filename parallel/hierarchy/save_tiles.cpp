#include "parallel/hierarchy/save_tiles.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/formats/common/float_range.h"
#include "core/hierarchy/model/find_signatures.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/model/material_of.h"
#include "core/hierarchy/tiles/tileset_tree.h"
#include "core/texture/thumbnail.h"
#include "parallel/hierarchy/decoded_images.h"

namespace lodestone {
namespace {

std::uint64_t write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
  return bytes.size();
}

// Room for decoded images that go into atlases.
constexpr std::size_t most_decoded_bytes = std::size_t{256} << 20;

class Saver {
 public:
  Saver(const Hierarchy& hierarchy, AtomicFolder& folder, Scheduler& scheduler, const SaveTilesConfig& config)
      : hierarchy_(hierarchy), folder_(folder), scheduler_(scheduler), config_(config), tileset_(config.tileset) {
    if (tileset_.morph) signatures_ = signatures_of(hierarchy);
    tileset_.signatures = signatures_.get();
  }

  SavedTiles save() {
    require_range();
    for (int level = 0; level <= hierarchy_.finest(); ++level) folder_.add_folder(std::to_string(level));
    save_cells();
    save_images();
    save_tilesets();
    saved_.bytes += bytes_;
    return saved_;
  }

 private:
  void require_range() const {
    const Box3f& box = hierarchy_.cells.front().bounds;
    require_gltf_range({hierarchy_.transform.to_model(box.lo), hierarchy_.transform.to_model(box.hi)}, "tiles",
                       "scale the model");
  }
  // Those that tiles link, of all levels; the bytes are those of the hierarchy.
  void save_images() {
    if (!linked_.empty()) folder_.add_folder("textures");
    for (const auto& [path, image] : linked_) {
      stop_if_cancelled();
      const auto [texture, level] = image;
      const TextureCopy* copy = texture_copy(hierarchy_, texture, level);
      const std::span<const char> bytes = copy ? copy->bytes : hierarchy_.textures[texture].bytes;
      bytes_ += write_file(folder_.path() / path, std::as_bytes(bytes));
    }
    saved_.textures = linked_.size() + atlas_images_;
    saved_.atlases = atlases_;
    saved_.draws = draws_;
    if (repeating_ > 0)
      saved_.warnings.push_back(std::to_string(repeating_) +
                                " tiles keep materials of their own whose textures repeat " +
                                "more than twice on a chart");
    if (config_.tileset.morph) save_thumbnails();
  }

  // Writes those of base colours and light, which the page draws.
  void save_thumbnails() {
    std::set<std::uint32_t> linked;
    for (const auto& [path, image] : linked_) linked.insert(image.first);
    std::erase_if(linked, [&](std::uint32_t texture) {
      return std::ranges::none_of(hierarchy_.materials, [texture](const Material& m) {
        return m.texture == texture || m.emissive_map.texture == texture;
      });
    });
    const std::vector<std::uint32_t> numbers(linked.begin(), linked.end());
    std::vector<Texture> made(numbers.size());
    scheduler_.for_chunks(numbers.size(), 1, [&](ChunkRange range) {
      try {
        made[range.begin] = thumbnail_of(hierarchy_.textures[numbers[range.begin]], PixelMeaning::colours);
      } catch (const InputError&) {  // tiles link images as they are
      } catch (const UnsupportedError&) {
      }
    });
    for (std::size_t k = 0; k < made.size(); ++k) {
      if (made[k].bytes.empty() || made[k].bytes.size() >= hierarchy_.textures[numbers[k]].bytes.size()) continue;
      const std::string thumbnail = "textures/" + std::to_string(numbers[k]) + "_thumbnail.webp";
      bytes_ += write_file(folder_.path() / thumbnail, std::as_bytes(std::span(made[k].bytes)));
      tileset_.thumbnails[numbers[k]] = thumbnail;
    }
  }

  void save_cells() {
    const TileErrors errors(hierarchy_);
    errors_.resize(hierarchy_.cells.size());
    if (config_.tileset.morph) tileset_.images.resize(hierarchy_.cells.size());
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
    const TileAtlas atlas = atlas_of(cell, level);
    const auto link = [&](std::uint32_t texture) {
      const std::string path = texture_path(hierarchy_, texture, level);
      const std::scoped_lock lock(linking_);
      linked_.emplace(path, std::pair(texture, level));
      return "../" + path;
    };
    const auto own = [&](std::size_t image) {
      return std::filesystem::path(atlas_path(hierarchy_, cell, atlas, image)).filename().string();
    };
    if (config_.tileset.morph) tileset_.images[cell] = shown_images(hierarchy_, cell, atlas);
    const std::vector<std::byte> glb = encode_cell_glb(hierarchy_, cell,
                                                       {.morph = config_.tileset.morph,
                                                        .signatures = tileset_.signatures,
                                                        .texture_uri = link,
                                                        .atlas = &atlas,
                                                        .atlas_uri = own});
    bytes_ += write_file(folder_.path() / tile_path(hierarchy_, cell), glb);
    for (std::size_t k = 0; k < atlas.images.size(); ++k)
      bytes_ += write_file(folder_.path() / atlas_path(hierarchy_, cell, atlas, k),
                           std::as_bytes(std::span(atlas.images[k].bytes)));
    atlases_ += !atlas.materials.empty();
    atlas_images_ += atlas.images.size();
    repeating_ += atlas.repeating > 0;
    draws_ += draws_of(hierarchy_.cells[cell], atlas);
  }

  [[nodiscard]] TileAtlas atlas_of(CellId cell, int level) {
    return make_tile_atlas(hierarchy_, cell,
                           {.pixels = [this, level](std::uint32_t texture) { return decoded_.get(texture, level); },
                            .morph = config_.tileset.morph});
  }

  // The parts of different materials.
  [[nodiscard]] std::size_t draws_of(const Cell& cell, const TileAtlas& atlas) const {
    std::set<std::pair<bool, std::uint32_t>> drawn;
    for (const Triangle& t : cell.triangles) {
      const std::uint32_t material = material_of(hierarchy_, cell, t.v[0]);
      const auto replacing = atlas.replacing(material);
      drawn.emplace(replacing.has_value(), replacing.value_or(material));
    }
    return drawn.size();
  }

  void save_tilesets() {
    if (signatures_) {
      const std::string text = encode_signatures(hierarchy_, *signatures_);
      bytes_ += write_file(folder_.path() / signatures_path, std::as_bytes(std::span(text)));
    }
    for (const TilesetFile& file : encode_tilesets(hierarchy_, errors_, tileset_)) {
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
  TilesetConfig tileset_;
  std::shared_ptr<const Signatures> signatures_;
  std::vector<double> errors_;
  DecodedImages decoded_{hierarchy_, most_decoded_bytes};
  std::mutex linking_;
  std::map<std::string, std::pair<std::uint32_t, int>> linked_;  // texture and level, by path
  std::atomic<std::uint64_t> bytes_{0}, atlases_{0}, atlas_images_{0}, repeating_{0}, draws_{0};
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
