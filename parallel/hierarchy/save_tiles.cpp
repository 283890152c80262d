#include "parallel/hierarchy/save_tiles.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/json.h"
#include "core/formats/common/float_range.h"
#include "core/hierarchy/model/find_signatures.h"
#include "core/hierarchy/model/level_mesh.h"
#include "core/hierarchy/model/material_of.h"
#include "core/texture/thumbnail.h"
#include "parallel/hierarchy/decoded_images.h"

namespace lodestone {
namespace {

// Room for decoded images that go into atlases.
constexpr std::size_t most_decoded_bytes = std::size_t{256} << 20;

// Counted while tiles are written.
enum Count : std::size_t { bytes, atlases, atlas_images, repeating, draws, tiles, triangles, count_kinds };

}  // namespace

class TileWriter::Parts {
 public:
  Parts(const Hierarchy& hierarchy, std::filesystem::path folder, Scheduler& scheduler, SaveTilesConfig config)
      : hierarchy_(hierarchy),
        folder_(std::move(folder)),
        scheduler_(scheduler),
        config_(std::move(config)),
        tile_errors_(hierarchy),
        errors_(hierarchy.cells.size()) {
    const Box3f& box = hierarchy_.cells.front().bounds;
    require_gltf_range({hierarchy_.transform.to_model(box.lo), hierarchy_.transform.to_model(box.hi)}, "tiles",
                       "scale the model");
    if (config_.tileset.morph) {
      signatures_ = signatures_of(hierarchy);
      config_.tileset.contents.resize(hierarchy_.cells.size());
    }
    config_.tileset.signatures = signatures_.get();
  }

  void write_tiles(std::span<const CellId> cells) {
    cells_.assign(cells.begin(), cells.end());
    std::atomic<std::size_t> done{0};
    scheduler_.for_chunks(cells_.size(), 1, [&](ChunkRange range) {
      stop_if_cancelled();
      const CellId cell = cells_[range.begin];
      errors_[cell] = tile_errors_.of(cell);
      if (!hierarchy_.cells[cell].triangles.empty()) write_tile(cell);
      report(static_cast<double>(++done) / static_cast<double>(cells_.size()));
    });
  }

  [[nodiscard]] std::string tell() const {
    Json told{{"cells", Json::array()}, {"linked", Json::array()}, {"counts", Json::array()}};
    for (const CellId cell : cells_) {
      Json of_cell{std::uint32_t{cell}, errors_[cell]};
      if (config_.tileset.morph) {
        of_cell.push_back(config_.tileset.contents[cell].vertices);
        for (const TileImage& image : config_.tileset.contents[cell].images)
          of_cell.push_back({image.path, image.texels, image.texture});
      }
      told["cells"].push_back(std::move(of_cell));
    }
    for (const auto& [path, image] : linked_) told["linked"].push_back({path, image.first, image.second});
    for (const auto& count : counts_) told["counts"].push_back(count.load());
    return told.dump();
  }

  void hear(const std::string& told) {
    const auto wrong = [](const std::exception& error) {
      return Error(std::string("what another process tells of its tiles cannot be read: ") + error.what());
    };
    try {
      const Json part = Json::parse(told);
      for (const Json& of_cell : part["cells"]) {
        const auto cell = of_cell[0].get<std::size_t>();
        errors_.at(cell) = of_cell[1].get<double>();
        if (!config_.tileset.morph) continue;
        TileContent& content = config_.tileset.contents[cell];
        content.vertices = of_cell[2].get<std::uint32_t>();
        for (std::size_t i = 3; i < of_cell.size(); ++i)
          content.images.push_back(
              {of_cell[i][0].string(), of_cell[i][1].get<double>(), of_cell[i][2].get<std::uint32_t>()});
      }
      for (const Json& image : part["linked"])
        linked_.emplace(image[0].string(), std::pair(image[1].get<std::uint32_t>(), image[2].get<int>()));
      for (std::size_t k = 0; k < count_kinds; ++k) counts_[k] += part["counts"][k].get<std::uint64_t>();
    } catch (const JsonError& error) {
      throw wrong(error);
    } catch (const std::out_of_range& error) {
      throw wrong(error);
    }
  }

  SavedTiles write_rest(AtomicFolder& folder) {
    if (!linked_.empty()) folder.add_folder("textures");
    write_images();
    if (config_.tileset.morph) write_thumbnails();
    SavedTiles saved;
    saved.tilesets = write_tilesets();
    saved.tiles = counts_[tiles];
    saved.textures = linked_.size() + counts_[atlas_images];
    saved.triangles = counts_[triangles];
    saved.draws = counts_[draws];
    saved.atlases = counts_[atlases];
    saved.bytes = counts_[bytes];
    if (counts_[repeating] > 0)
      saved.warnings.push_back(std::to_string(counts_[repeating]) +
                               " tiles keep materials of their own whose textures repeat more than twice on a chart");
    return saved;
  }

 private:
  void write_tile(CellId cell) {
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
    if (config_.tileset.morph) config_.tileset.contents[cell] = tile_content(hierarchy_, cell, atlas);
    const std::vector<std::byte> glb = encode_cell_glb(hierarchy_, cell,
                                                       {.morph = config_.tileset.morph,
                                                        .signatures = config_.tileset.signatures,
                                                        .texture_uri = link,
                                                        .atlas = &atlas,
                                                        .atlas_uri = own});
    write_file(tile_path(hierarchy_, cell), glb);
    for (std::size_t k = 0; k < atlas.images.size(); ++k)
      write_file(atlas_path(hierarchy_, cell, atlas, k), std::as_bytes(std::span(atlas.images[k].bytes)));
    counts_[tiles] += 1;
    counts_[triangles] += hierarchy_.cells[cell].triangles.size();
    counts_[atlases] += !atlas.materials.empty();
    counts_[atlas_images] += atlas.images.size();
    counts_[repeating] += atlas.repeating > 0;
    counts_[draws] += draws_of(hierarchy_.cells[cell], atlas);
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

  // Those that tiles link, of all levels; the bytes are those of the hierarchy.
  void write_images() {
    for (const auto& [path, image] : linked_) {
      stop_if_cancelled();
      const auto [texture, level] = image;
      const TextureCopy* copy = texture_copy(hierarchy_, texture, level);
      const std::span<const char> content = copy ? copy->bytes : hierarchy_.textures[texture].bytes;
      write_file(path, std::as_bytes(content));
    }
  }

  // Only base colours and light, which the page draws, have thumbnails.
  void write_thumbnails() {
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
      write_file(thumbnail, std::as_bytes(std::span(made[k].bytes)));
      config_.tileset.thumbnails[numbers[k]] = thumbnail;
    }
  }

  // Returns their number.
  std::uint64_t write_tilesets() {
    if (signatures_) {
      const std::string text = encode_signatures(hierarchy_, *signatures_);
      write_file(signatures_path, std::as_bytes(std::span(text)));
    }
    const std::vector<TilesetFile> files = encode_tilesets(hierarchy_, errors_, config_.tileset);
    for (const TilesetFile& file : files) {
      stop_if_cancelled();
      write_file(file.path, std::as_bytes(std::span(file.json)));
    }
    return files.size();
  }

  // `path`: from the folder.
  void write_file(const std::string& path, std::span<const std::byte> content) {
    AtomicFile file(folder_ / path);
    file.write(content);
    file.commit();
    counts_[bytes] += content.size();
  }

  void stop_if_cancelled() const {
    if (config_.cancel && *config_.cancel) throw Cancelled{};
  }

  void report(double share) {
    if (!config_.progress) return;
    if (const std::unique_lock lock(reporting_, std::try_to_lock); lock) config_.progress(share);
  }

  const Hierarchy& hierarchy_;
  std::filesystem::path folder_;
  Scheduler& scheduler_;
  SaveTilesConfig config_;
  std::shared_ptr<const Signatures> signatures_;
  TileErrors tile_errors_;
  DecodedImages decoded_{hierarchy_, most_decoded_bytes};
  std::vector<CellId> cells_;   // that have been written here
  std::vector<double> errors_;  // by cell of the hierarchy
  std::mutex linking_;
  std::map<std::string, std::pair<std::uint32_t, int>> linked_;  // texture and level, by path
  std::array<std::atomic<std::uint64_t>, count_kinds> counts_{};
  std::mutex reporting_;
};

TileWriter::TileWriter(const Hierarchy& hierarchy, std::filesystem::path folder, Scheduler& scheduler,
                       SaveTilesConfig config)
    : parts_(std::make_unique<Parts>(hierarchy, std::move(folder), scheduler, std::move(config))) {}
TileWriter::~TileWriter() = default;
void TileWriter::write_tiles(std::span<const CellId> cells) { parts_->write_tiles(cells); }
std::string TileWriter::tell() const { return parts_->tell(); }
void TileWriter::hear(const std::string& told) { parts_->hear(told); }
SavedTiles TileWriter::write_rest(AtomicFolder& folder) { return parts_->write_rest(folder); }

void add_level_folders(const Hierarchy& hierarchy, AtomicFolder& folder) {
  for (int level = 0; level <= hierarchy.finest(); ++level) folder.add_folder(std::to_string(level));
}

SavedTiles save_tiles(const Hierarchy& hierarchy, AtomicFolder& folder, Scheduler& scheduler,
                      const SaveTilesConfig& config) {
  TileWriter writer(hierarchy, folder.path(), scheduler, config);
  add_level_folders(hierarchy, folder);
  std::vector<CellId> all(hierarchy.cells.size());
  std::iota(all.begin(), all.end(), CellId(0));
  writer.write_tiles(all);
  return writer.write_rest(folder);
}

}  // namespace lodestone
