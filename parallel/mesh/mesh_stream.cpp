#include "parallel/mesh/mesh_stream.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <system_error>
#include <vector>

#include "core/base/error.h"
#include "core/files/checksum.h"
#include "core/files/input_file.h"
#include "core/formats/mesh_file.h"
#include "core/formats/plain/stl.h"
#include "core/formats/ply/ply_header.h"
#include "core/formats/ply/ply_layout.h"

namespace lodestone {
namespace {

constexpr std::size_t most_stride = 1 << 12;  // longer records are not a common layout

// A run of records of fixed size in a file.
struct Records {
  std::uint64_t offset = 0, count = 0;
  std::size_t stride = 0;
};

bool readable(const Records& records, const InputFile& file) {
  return records.stride > 0 && records.stride <= most_stride && records.offset <= file.size() &&
         records.count <= (file.size() - records.offset) / records.stride;
}

class FileStream : public MeshStream {
 public:
  explicit FileStream(const std::filesystem::path& path) : file_(path), path_(path) {}
  [[nodiscard]] const std::string& name() const override { return file_.name(); }

  [[nodiscard]] std::uint64_t identity() const override {
    constexpr std::size_t samples = 64, sample_bytes = 4096;
    std::error_code ignored;
    std::vector<std::uint64_t> sums{
        file_.size(),
        static_cast<std::uint64_t>(std::filesystem::last_write_time(path_, ignored).time_since_epoch().count())};
    std::vector<char> bytes(sample_bytes);
    for (std::size_t i = 0; i < samples; ++i) {
      const std::size_t got = file_.read_at(file_.size() / samples * i, bytes);
      sums.push_back(checksum(std::as_bytes(std::span(bytes).first(got))));
    }
    return checksum(std::as_bytes(std::span(sums)));
  }

 protected:
  [[nodiscard]] const InputFile& file() const { return file_; }
  // The bytes of records [first, first + count).
  [[nodiscard]] std::vector<char> read(const Records& records, std::uint64_t first, std::size_t count) const {
    std::vector<char> bytes(count * records.stride);
    const std::uint64_t offset = records.offset + first * records.stride;
    const std::size_t got = file_.read_at(offset, bytes);
    if (got < bytes.size())
      throw InputError(describe(name(), "byte " + std::to_string(offset + got),
                                "the file ends here, and was longer when it was opened",
                                "leave it as it is until the build is done"));
    return bytes;
  }

 private:
  InputFile file_;
  std::filesystem::path path_;
};

class PlyStream final : public FileStream {
 public:
  PlyStream(const std::filesystem::path& path, const PlyFixedLayout& layout)
      : FileStream(path),
        layout_(layout),
        vertex_records_{layout.vertex_offset, layout.vertex_count, layout.vertices.stride},
        triangle_records_{layout.triangle_offset, layout.triangle_count, layout.triangles.stride} {
    vertices_ = layout.vertex_count;
    triangles_ = layout.triangle_count;
  }
  [[nodiscard]] bool complete() const {
    return readable(vertex_records_, file()) && readable(triangle_records_, file());
  }

  void read_vertices(std::uint64_t first, std::span<Vec3d> out) const override {
    decode_vertices(layout_.vertices, read(vertex_records_, first, out.size()), out);
  }
  void read_triangles(std::uint64_t first, std::span<Triangle> out) const override {
    const std::vector<char> bytes = read(triangle_records_, first, out.size());
    const std::size_t sound = decode_triangles(layout_.triangles, bytes, static_cast<std::uint32_t>(vertices_), out);
    if (sound < out.size())
      throw InputError(describe(name(), "face " + std::to_string(first + sound),
                                "is not a triangle, or has an index out of range",
                                "make triangles of all faces, or build without --memory-limit"));
  }

 private:
  PlyFixedLayout layout_;
  Records vertex_records_, triangle_records_;
};

// Three vertices for each facet.
class StlStream final : public FileStream {
 public:
  StlStream(const std::filesystem::path& path, std::uint64_t facets)
      : FileStream(path), records_{stl_header_bytes, facets, stl_facet_bytes} {
    vertices_ = 3 * facets;
    triangles_ = facets;
  }
  [[nodiscard]] bool complete() const {
    return readable(records_, file()) && vertices_ <= std::numeric_limits<std::uint32_t>::max();
  }

  void read_vertices(std::uint64_t first, std::span<Vec3d> out) const override {
    if (out.empty()) return;
    const std::uint64_t facet = first / 3, end = (first + out.size() + 2) / 3;
    const auto facets = static_cast<std::size_t>(end - facet);
    std::vector<Vec3d> corners(3 * facets);
    decode_stl_corners(read(records_, facet, facets), corners);
    std::copy_n(corners.begin() + static_cast<std::ptrdiff_t>(first % 3), out.size(), out.begin());
  }
  void read_triangles(std::uint64_t first, std::span<Triangle> out) const override { number_corners(out, 3 * first); }

 private:
  Records records_;
};

template <class Stream, class... Arguments>
std::unique_ptr<MeshStream> if_complete(const std::filesystem::path& path, const Arguments&... arguments) {
  auto stream = std::make_unique<Stream>(path, arguments...);
  return stream->complete() && stream->triangle_count() > 0 ? std::move(stream) : nullptr;
}

}  // namespace

std::unique_ptr<MeshStream> open_mesh_stream(const std::filesystem::path& given, const ReadConfig& config) {
  const std::filesystem::path path = mesh_path(given);
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return nullptr;
  ByteReader head(path);
  if (head.size() == 0) return nullptr;
  switch (mesh_format(path, head, config)) {
    case MeshFormat::ply: {
      const PlyHeader header = read_ply_header(head);
      if (config.attributes && (header.has_textured_faces() || !header.textures.empty())) return nullptr;
      const std::optional<PlyFixedLayout> layout = fixed_layout(header);
      if (!layout || (config.attributes && !layout->attributes.empty())) return nullptr;
      return if_complete<PlyStream>(path, *layout);
    }
    case MeshFormat::stl: {
      const std::string_view bytes = head.window(stl_header_bytes);
      if (bytes.size() < stl_header_bytes || !is_binary_stl(bytes, head.size())) return nullptr;
      return if_complete<StlStream>(path, declared_stl_facets(bytes));
    }
    default:
      return nullptr;
  }
}

}  // namespace lodestone
