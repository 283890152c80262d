#include "parallel/mesh/mesh_stream.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <system_error>
#include <vector>

#include "core/base/error.h"
#include "core/files/input_file.h"
#include "core/formats/mesh_reader.h"
#include "core/formats/plain/stl.h"
#include "core/formats/ply/ply_header.h"
#include "core/formats/ply/ply_layout.h"

namespace lodestone {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

// A run of records of fixed size in a file.
struct Records {
  std::uint64_t offset = 0, count = 0;
  std::size_t stride = 0;
};

// True if the file holds them and a buffer holds one: checked before memory is allocated for them.
bool readable(const Records& records, const InputFile& file) {
  return records.stride > 0 && records.stride <= buffer_bytes && records.offset <= file.size() &&
         records.count <= (file.size() - records.offset) / records.stride;
}

class FileStream : public MeshStream {
 public:
  FileStream(const std::filesystem::path& path, Up up) : file_(path), path_(path) { up_ = up; }
  [[nodiscard]] const std::string& name() const override { return file_.name(); }

  [[nodiscard]] std::uint64_t identity() const override { return file_identity(path_); }

 protected:
  [[nodiscard]] const InputFile& file() const { return file_; }
  // Calls decode(bytes, done, now) for records [first, first + count), as many at a time as a buffer holds.
  template <class Decode>
  void read(const Records& records, std::uint64_t first, std::size_t count, const Decode& decode) const {
    const std::size_t at_once = std::min(count, buffer_bytes / records.stride);
    const auto buffer = std::make_unique_for_overwrite<char[]>(at_once * records.stride);
    for (std::size_t done = 0; done < count;) {
      const std::size_t now = std::min(count - done, at_once);
      const std::span<char> bytes(buffer.get(), now * records.stride);
      const std::uint64_t offset = records.offset + (first + done) * records.stride;
      const std::size_t got = file_.read_at(offset, bytes);
      if (got < bytes.size())
        throw InputError(describe(name(), "byte " + std::to_string(offset + got),
                                  "the file ends here, and was longer when it was opened",
                                  "leave it as it is until the build is done"));
      decode(std::span<const char>(bytes), done, now);
      done += now;
    }
  }

 private:
  InputFile file_;
  std::filesystem::path path_;
};

class PlyStream final : public FileStream {
 public:
  PlyStream(const std::filesystem::path& path, Up up, const PlyHeader& header, const PlyFixedLayout& layout,
            const ReadConfig& config)
      : FileStream(path, up),
        layout_(layout),
        vertex_records_{layout.vertex_offset, layout.vertex_count, layout.vertices.stride},
        triangle_records_{layout.triangle_offset, layout.triangle_count, layout.triangles.stride} {
    vertices_ = layout.vertex_count;
    triangles_ = layout.triangle_count;
    has_attributes_ = config.attributes && !layout.attributes.empty();
    if (complete()) add_ply_warnings(header, name(), config.attributes, file().size() - layout.end, warnings_);
  }
  // Other faces than triangles show when they are read: mostly at the first.
  [[nodiscard]] bool complete() const {
    return readable(vertex_records_, file()) && readable(triangle_records_, file()) && layout_.end <= file().size() &&
           begins_with_triangle();
  }

  void read_vertices(std::uint64_t first, std::span<Vec3d> out, RawWedges* wedges) const override {
    read(vertex_records_, first, out.size(), [&](auto bytes, std::size_t done, std::size_t now) {
      decode_vertices(layout_.vertices, bytes, out.subspan(done, now));
      if (wedges && has_attributes_) decode_attributes(layout_.attributes, bytes, first + done, now, *wedges);
    });
  }
  void read_triangles(std::uint64_t first, std::span<Triangle> out) const override {
    read(triangle_records_, first, out.size(), [&](auto bytes, std::size_t done, std::size_t now) {
      const std::size_t sound =
          decode_triangles(layout_.triangles, bytes, static_cast<std::uint32_t>(vertices_), out.subspan(done, now));
      if (sound < now)
        throw InputError(describe(name(), "face " + std::to_string(first + done + sound),
                                  "is not a triangle, or has an index out of range",
                                  "make triangles of all faces, or use lodestone build without --memory-limit"));
    });
  }
  [[nodiscard]] RawWedges wedges() const override {
    RawWedges wedges;
    if (has_attributes_) resize_attributes(layout_.attributes, vertices_, wedges);
    return wedges;
  }

 private:
  [[nodiscard]] bool begins_with_triangle() const {
    std::vector<char> face(layout_.triangles.stride);
    Triangle first;
    return triangle_records_.count == 0 ||
           (file().read_at(triangle_records_.offset, face) == face.size() &&
            decode_triangles(layout_.triangles, face, static_cast<std::uint32_t>(vertices_), std::span(&first, 1)) ==
                1);
  }

  PlyFixedLayout layout_;
  Records vertex_records_, triangle_records_;
};

// Three vertices for each facet.
class StlStream final : public FileStream {
 public:
  StlStream(const std::filesystem::path& path, Up up, std::uint64_t facets)
      : FileStream(path, up), records_{stl_header_bytes, facets, stl_facet_bytes} {
    vertices_ = 3 * facets;
    triangles_ = facets;
  }
  [[nodiscard]] bool complete() const {
    return readable(records_, file()) && vertices_ <= std::numeric_limits<std::uint32_t>::max();
  }

  void read_vertices(std::uint64_t first, std::span<Vec3d> out, RawWedges* /*wedges*/) const override {
    if (out.empty()) return;
    const std::uint64_t facet = first / 3, end = (first + out.size() + 2) / 3;
    const auto facets = static_cast<std::size_t>(end - facet);
    std::vector<Vec3d> whole(3 * facets == out.size() ? 0 : 3 * facets);  // where a facet is cut
    const std::span<Vec3d> corners = whole.empty() ? out : whole;
    read(records_, facet, facets, [&](auto bytes, std::size_t done, std::size_t now) {
      decode_stl_corners(bytes, corners.subspan(3 * done, 3 * now));
    });
    if (!whole.empty()) std::copy_n(whole.begin() + static_cast<std::ptrdiff_t>(first % 3), out.size(), out.begin());
  }
  void read_triangles(std::uint64_t first, std::span<Triangle> out) const override { number_corners(out, 3 * first); }

 private:
  Records records_;
};

template <class Stream, class... Arguments>
std::unique_ptr<MeshStream> if_complete(const std::filesystem::path& path, Up up, const Arguments&... arguments) {
  auto stream = std::make_unique<Stream>(path, up, arguments...);
  return stream->complete() && stream->triangle_count() > 0 ? std::move(stream) : nullptr;
}

}  // namespace

std::unique_ptr<MeshStream> open_mesh_stream(const std::filesystem::path& given, const ReadConfig& config) {
  const std::filesystem::path path = mesh_path(given);
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return nullptr;
  ByteReader head(path);
  if (head.size() == 0) return nullptr;
  const MeshFormat format = mesh_format(path, head, config);
  const Up up = up_of(format, config);
  switch (format) {
    case MeshFormat::ply: {
      const PlyHeader header = read_ply_header(head);
      if (config.attributes && (header.has_textured_faces() || !header.textures.empty())) return nullptr;
      const std::optional<PlyFixedLayout> layout = fixed_layout(header);
      return layout ? if_complete<PlyStream>(path, up, header, *layout, config) : nullptr;
    }
    case MeshFormat::stl: {
      const std::string_view bytes = head.window(stl_header_bytes);
      if (bytes.size() < stl_header_bytes || !is_binary_stl(bytes, head.size())) return nullptr;
      return if_complete<StlStream>(path, up, declared_stl_facets(bytes));
    }
    default:
      return nullptr;
  }
}

}  // namespace lodestone
