#include "parallel/distributed/rank_input.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <optional>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "core/formats/mesh_reader.h"
#include "core/formats/tiles/tileset.h"
#include "core/mesh/raw_mesh.h"
#include "parallel/distributed/held_stream.h"
#include "parallel/mesh/joined_stream.h"
#include "parallel/mesh/load.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

// Known to all ranks of a part, whichever of them has it.
struct PartFigures {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t polygons_triangulated = 0, faces_dropped = 0, void_posts = 0, filled_posts = 0;
  Box3d box;
  Up up;
  SurfaceKinds kinds;
};

PartFigures figures_of(const RawMesh& mesh) {
  return {.vertices = mesh.positions.size(),
          .triangles = mesh.triangles.size(),
          .polygons_triangulated = mesh.polygons_triangulated,
          .faces_dropped = mesh.faces_dropped,
          .void_posts = mesh.void_posts,
          .filled_posts = mesh.filled_posts,
          .box = finite_box(mesh.positions),
          .up = mesh.up,
          .kinds = kinds_of(mesh)};
}

std::uint64_t shape_bytes(const RawMesh& mesh) {
  return sizeof(Vec3d) * mesh.positions.size() + sizeof(Triangle) * mesh.triangles.size();
}

// A file, or a tile of one: cut where the shares of ranks meet if it is read in pieces, and otherwise whole.
struct Part {
  std::size_t file = 0;
  std::optional<Tile> tile = {};
  std::uint64_t bytes = 0;
  std::unique_ptr<MeshStream> stream = {};  // if it is read in pieces
  PartFigures figures = {};
  RawMesh mesh = {};  // a whole part, at its rank
};

// The bytes of a folder are those of what is in it.
std::uint64_t bytes_of(const fs::path& path) {
  std::error_code failed;
  const std::uintmax_t bytes = fs::file_size(path, failed);
  if (!failed) return bytes;
  std::uint64_t sum = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, failed)) sum += bytes_of(entry.path());
  return sum;
}

class InputParts {
 public:
  InputParts(std::span<const fs::path> files, const ReadConfig& config, Ranks& ranks, Scheduler& scheduler)
      : files_(files), config_(config), ranks_(ranks), scheduler_(scheduler) {
    for (std::size_t file = 0; file < files.size(); ++file) list_parts(file);
    for (const Part& part : parts_) ends_.push_back(ends_.back() + std::max<std::uint64_t>(part.bytes, 1));
  }

  // The whole parts of this rank; then all know of all. With attributes no part is cut.
  void read() {
    require_agreement();
    read_wholes([](const Part& part) { return !part.stream; });
    for (const Part& part : parts_) kinds_.add(part.figures.kinds);
    const auto is_cut = [](const Part& part) { return part.stream != nullptr; };
    if (!kinds_.any() || std::ranges::none_of(parts_, is_cut)) return;
    read_wholes(is_cut);
    for (Part& part : parts_)
      if (std::exchange(part.stream, nullptr)) part.mesh.warnings.clear();  // all know them
  }

  [[nodiscard]] RankInput join() && {
    RankInput input;
    input.vertices = slices(&PartFigures::vertices);
    input.triangles = slices(&PartFigures::triangles);
    input.warnings = gather_warnings();
    for (const Part& part : parts_) {
      input.reading.polygons_triangulated += part.figures.polygons_triangulated;
      input.reading.faces_dropped += part.figures.faces_dropped;
      input.reading.void_posts += part.figures.void_posts;
      input.reading.filled_posts += part.figures.filled_posts;
    }
    if (kinds_.any())
      join_surface(input);
    else
      join_shape(input);
    return input;
  }

 private:
  // Those of this rank of the parts that `takes`.
  template <class Takes>
  void read_wholes(const Takes& takes) {
    std::vector<std::size_t> own;
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if (takes(parts_[p]) && share_of(middle(p)) == ranks_.rank()) own.push_back(p);
    std::vector<std::exception_ptr> errors(own.size());
    const auto read = [&](std::size_t i) {
      try {
        read_part(parts_[own[i]]);
      } catch (...) {
        errors[i] = std::current_exception();
      }
    };
    // Tiles side by side; a file is read by all threads itself.
    scheduler_.for_chunks(own.size(), 1, [&](ChunkRange range) {
      if (parts_[own[range.index]].tile) read(range.index);
    });
    for (std::size_t i = 0; i < own.size(); ++i)
      if (!parts_[own[i]].tile) read(i);
    for (const std::exception_ptr& error : errors)
      if (error) std::rethrow_exception(error);
    share_figures(own);
  }

  void join_shape(RankInput& input) {
    std::vector<std::unique_ptr<MeshStream>> streams;
    for (Part& part : parts_) {
      input.held_bytes += shape_bytes(part.mesh);
      if (!part.stream)
        part.stream = held(files_[part.file].string(), part.figures, std::move(part.mesh), source_of(part), {0, 0});
      streams.push_back(std::move(part.stream));
    }
    input.stream = join_streams(std::move(streams), name_of_files(files_));
  }

  // One mesh of the own parts, which follow each other.
  void join_surface(RankInput& input) {
    const std::string name = name_of_files(files_);
    RawMesh own;
    PartFigures all;
    all.up = parts_.front().figures.up;
    for (Part& part : parts_) {
      require_same_up(all.up, part.figures.up, files_[part.file].string());
      all.vertices += part.figures.vertices, all.triangles += part.figures.triangles;
      // Equal materials of a file remain what they are if it is the first one, and not of tiles.
      if (&part == &parts_.front() && !part.tile)
        own = std::move(part.mesh);
      else
        append_mesh(own, std::move(part.mesh), name);
    }
    input.surface = share_surface(own, kinds_, name, ranks_);
    input.held_bytes = shape_bytes(own) + surface_bytes(*input.surface);
    const std::uint64_t first = input.vertices.begin(ranks_.rank());
    for (Triangle& t : own.triangles)
      for (std::uint32_t& v : t.v) v += static_cast<std::uint32_t>(first);
    input.stream = held(name, all, std::move(own), {}, {first, input.triangles.begin(ranks_.rank())});
  }

  [[nodiscard]] fs::path source_of(const Part& part) const {
    return part.tile ? part.tile->file : mesh_path(files_[part.file]);
  }

  struct First {
    std::uint64_t vertex, triangle;
  };
  static std::unique_ptr<MeshStream> held(std::string name, const PartFigures& figures, RawMesh&& mesh, fs::path source,
                                          First first = {}) {
    return std::make_unique<HeldStream>(std::move(name),
                                        HeldFigures{figures.vertices, figures.triangles, figures.up, std::move(source)},
                                        HeldStream::Part<Vec3d>{first.vertex, std::move(mesh.positions)},
                                        HeldStream::Part<Triangle>{first.triangle, std::move(mesh.triangles)});
  }

  void list_parts(std::size_t file) {
    const fs::path path = mesh_path(files_[file]);
    std::error_code ignored;
    if (!fs::is_directory(path, ignored)) {
      if (std::unique_ptr<MeshStream> stream = open_mesh_stream(path, config_); stream && !stream->has_attributes()) {
        Part part{.file = file, .bytes = bytes_of(path)};
        part.figures.vertices = stream->vertex_count();
        part.figures.triangles = stream->triangle_count();
        warnings_.insert(warnings_.end(), stream->warnings().begin(), stream->warnings().end());
        part.stream = std::move(stream);
        parts_.push_back(std::move(part));
        return;
      }
      ByteReader head = open_mesh_file(path, config_);
      if (head.size() > 0 && mesh_format(path, head, config_) == MeshFormat::tileset) {
        TileList list = list_tiles(head);
        warnings_.insert(warnings_.end(), list.warnings.begin(), list.warnings.end());
        for (Tile& tile : list.tiles) {
          const std::uint64_t bytes = bytes_of(tile.file);
          parts_.push_back({.file = file, .tile = std::move(tile), .bytes = bytes});
        }
        if (list.tiles.empty()) require_triangles({}, files_[file].string());
        return;
      }
    }
    parts_.push_back({.file = file, .bytes = bytes_of(path)});
  }

  // Shares follow from what each rank sees of the files.
  void require_agreement() {
    std::vector<std::uint64_t> seen(ends_);
    for (const Part& part : parts_) {
      seen.push_back(part.figures.vertices);
      seen.push_back(part.figures.triangles);
    }
    const std::vector<std::uint64_t> all = ranks_.gather(checksum(std::as_bytes(std::span(seen))));
    if (std::ranges::adjacent_find(all, std::not_equal_to()) != all.end())
      throw InputError(describe(name_of_files(files_), "", "differs from rank to rank",
                                "give all machines the same files, under one name"));
  }

  void read_part(Part& part) {
    ReadConfig config = config_;
    config.progress = {};
    part.mesh = part.tile ? read_tile(*part.tile, config) : load_mesh(files_[part.file], scheduler_, config);
    part.figures = figures_of(part.mesh);
  }

  void share_figures(const std::vector<std::size_t>& own) {
    struct Known {
      std::uint64_t part;
      PartFigures figures;
    };
    std::vector<Known> known;
    for (const std::size_t p : own) known.push_back({p, parts_[p].figures});
    for (const std::vector<Known>& of_rank : ranks_.gather_lists(known))
      for (const Known& k : of_rank) parts_.at(k.part).figures = k.figures;
    for (auto first = parts_.begin(); first != parts_.end();) {
      const auto last = std::find_if(first, parts_.end(), [&](const Part& part) { return part.file != first->file; });
      if (first->tile) complete_tileset(std::span(first, last));
      first = last;
    }
  }

  // A tile has the up axis of the mesh that all of them are together.
  void complete_tileset(std::span<Part> tiles) const {
    Box3d box;
    std::uint64_t triangles = 0;
    for (const Part& tile : tiles) box.extend(tile.figures.box), triangles += tile.figures.triangles;
    if (triangles == 0) require_triangles({}, files_[tiles.front().file].string());
    const Up up = config_.up ? up_of(MeshFormat::tileset, config_) : up_of_tiles(box);
    for (Part& tile : tiles) tile.figures.up = up;
  }

  // Those of all ranks; each knows those of the parts that it has read.
  std::vector<std::string> gather_warnings() {
    std::vector<std::string> own;
    for (const Part& part : parts_) own.insert(own.end(), part.mesh.warnings.begin(), part.mesh.warnings.end());
    for (const std::vector<std::string>& of_rank : ranks_.gather_texts(own))
      warnings_.insert(warnings_.end(), of_rank.begin(), of_rank.end());
    return std::move(warnings_);
  }

  // The bytes of all parts, one after the other, are cut into equal shares. A part that is cut is so in proportion; a
  // whole one belongs where its middle lies, but the first to rank 0, to which all textures go.
  [[nodiscard]] std::uint64_t middle(std::size_t p) const {
    return p == 0 ? 0 : ends_[p] + (ends_[p + 1] - ends_[p]) / 2;
  }
  [[nodiscard]] std::uint64_t cut(int rank) const {
    return ends_.back() / static_cast<std::uint64_t>(ranks_.count()) * static_cast<std::uint64_t>(rank) +
           ends_.back() % static_cast<std::uint64_t>(ranks_.count()) * static_cast<std::uint64_t>(rank) /
               static_cast<std::uint64_t>(ranks_.count());
  }
  [[nodiscard]] int share_of(std::uint64_t byte) const {
    int first = 0, last = ranks_.count();
    while (last - first > 1) {
      const int half = (first + last) / 2;
      (cut(half) <= byte ? first : last) = half;
    }
    return first;
  }

  [[nodiscard]] Slices slices(std::uint64_t PartFigures::*count) const {
    std::vector<std::uint64_t> before{0};  // by part: items of those before it
    for (const Part& part : parts_) before.push_back(before.back() + part.figures.*count);
    const auto items_before = [&](std::uint64_t byte) {
      const auto p = static_cast<std::size_t>(std::ranges::upper_bound(ends_, byte) - ends_.begin()) - 1;
      if (p == parts_.size()) return before.back();
      const std::uint64_t items = parts_[p].figures.*count;
      if (!parts_[p].stream) return before[p] + (middle(p) < byte ? items : 0);
      const double share = static_cast<double>(byte - ends_[p]) / static_cast<double>(ends_[p + 1] - ends_[p]);
      return before[p] + std::min(items, static_cast<std::uint64_t>(share * static_cast<double>(items)));
    };
    std::vector<std::uint64_t> sizes;
    for (int r = 0; r < ranks_.count(); ++r) sizes.push_back(items_before(cut(r + 1)) - items_before(cut(r)));
    return Slices(sizes);
  }

  std::span<const fs::path> files_;
  const ReadConfig& config_;
  Ranks& ranks_;
  Scheduler& scheduler_;
  std::vector<Part> parts_;
  std::vector<std::uint64_t> ends_{0};  // bytes of the parts before each, and of all
  std::vector<std::string> warnings_;
  SurfaceKinds kinds_;  // of all parts
};

}  // namespace

RankInput shared_out(std::shared_ptr<const MeshStream> stream, int ranks) {
  RankInput input{std::move(stream), {}, {}};
  input.vertices = Slices(input.stream->vertex_count(), ranks);
  input.triangles = Slices(input.stream->triangle_count(), ranks);
  input.warnings = input.stream->warnings();
  return input;
}

RankInput open_rank_input(std::span<const fs::path> files, const ReadConfig& config, Ranks& ranks,
                          Scheduler& scheduler) {
  InputParts parts(files, config, ranks, scheduler);
  parts.read();
  return std::move(parts).join();
}

}  // namespace lodestone
