#include <bit>
#include <cstring>

#include "core/base/error.h"
#include "core/files/byte_reader.h"
#include "core/files/checksum.h"
#include "core/math/round_up.h"
#include "core/progressive/lpm/lpm.h"
#include "core/progressive/lpm/lpm_format.h"
#include "core/progressive/mesh/activation.h"

namespace lodestone {
namespace {

using namespace progressive;

constexpr const char* damaged = "the file is damaged";

std::uint32_t word_at(std::span<const char> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + k])) << (8 * k);
  return value;
}

// Cuts the file into its parts, each checked before it is used.
class Frames {
 public:
  Frames(std::span<const char> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  [[nodiscard]] std::span<const char> header() {
    if (bytes_.size() < 16 || std::memcmp(bytes_.data(), lpm_magic, 8) != 0)
      throw InputError(describe(name_, "", "not a progressive mesh (.lpm)"));
    at_ = 16;
    const std::uint32_t length = word_at(bytes_, 8);
    if (length > bytes_.size() - at_) fail("the file ends within its header");
    return take(length, word_at(bytes_, 12));
  }
  // True if there is another complete frame.
  [[nodiscard]] bool has_next() const {
    return bytes_.size() - at_ >= 12 && bytes_.size() - at_ - 12 >= word_at(bytes_, at_);
  }
  struct Frame {
    std::span<const char> bytes;
    std::uint32_t vertices;
  };
  [[nodiscard]] Frame next() {
    if (!has_next()) fail("the file ends early");
    const std::uint32_t length = word_at(bytes_, at_), crc = word_at(bytes_, at_ + 4),
                        vertices = word_at(bytes_, at_ + 8);
    at_ += 12;
    return {take(length, crc), vertices};
  }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(describe(name_, "byte " + std::to_string(at_), what, damaged));
  }

 private:
  std::span<const char> take(std::size_t length, std::uint32_t crc) {
    const auto part = bytes_.subspan(at_, length);
    if (crc32(std::as_bytes(part)) != crc) fail("the checksum is wrong");
    at_ += length;
    return part;
  }

  std::span<const char> bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
};

class LpmDecoder {
 public:
  LpmDecoder(std::span<const char> bytes, const std::string& name, bool prefix)
      : name_(name), prefix_(prefix), frames_(bytes, name) {}

  ProgressiveMesh read() {
    const auto text = frames_.header();
    const Json json = parse_json(text, name_);
    header_ = read_header(JsonView(json, name_));
    read_thumbnails();
    SplitCodec<RangeDecoder> codec(header_.settings, mesh_, values_);
    try {
      read_base(codec);
      while (mesh_.stars.size() < header_.groups && !(prefix_ && !frames_.has_next())) read_splits(codec);
    } catch (const InputError& e) {
      if (std::string(e.what()).starts_with(name_)) throw;
      frames_.fail(e.what());
    }
    if (!prefix_ && mesh_.wedge_count != header_.vertices)
      frames_.fail("the number of vertices differs from the header");
    read_textures();
    return assemble();
  }

 private:
  void read_base(SplitCodec<RangeDecoder>& codec) {
    const Frames::Frame frame = frames_.next();
    RangeDecoder coder(std::as_bytes(frame.bytes));
    // A star takes bits, so that damaged counts cannot ask for more memory than the frame has.
    if (header_.base_groups > 8 * frame.bytes.size()) frames_.fail("the base has more vertices than bits");
    codec.code_base(coder, {}, {}, header_.base_groups);
    base_vertices_ = mesh_.wedge_count;
    if (frame.vertices != mesh_.wedge_count) frames_.fail("the size of the base differs from the header");
  }

  void read_splits(SplitCodec<RangeDecoder>& codec) {
    const Frames::Frame frame = frames_.next();
    RangeDecoder coder(std::as_bytes(frame.bytes));
    const auto now = static_cast<std::uint32_t>(mesh_.stars.size());
    const std::uint32_t count = std::min(splits_in_frame(now), header_.groups - now);
    for (std::uint32_t k = 0; k < count; ++k) {
      codec.code(coder, {}, {});
      if (mesh_.wedge_count > header_.vertices) frames_.fail("more vertices than the header declares");
    }
    if (frame.vertices != mesh_.wedge_count) frames_.fail("inconsistent vertex splits");
  }

  // They take the places of the images until these come.
  void read_thumbnails() {
    for (std::size_t k = 0; k < header_.textures.size(); ++k) {
      if (header_.thumbnails[k].empty()) continue;
      Texture& t = header_.textures[k];
      std::swap(t.media_type, header_.thumbnails[k]);
      const Frames::Frame frame = frames_.next();
      t.bytes.assign(frame.bytes.begin(), frame.bytes.end());
    }
  }

  void read_textures() {
    for (std::size_t k = 0; k < header_.textures.size(); ++k) {
      if (prefix_ && !frames_.has_next()) return;
      const Frames::Frame frame = frames_.next();
      if (frame.bytes.empty()) continue;  // the thumbnail is the image
      Texture& t = header_.textures[k];
      if (!header_.thumbnails[k].empty()) t.media_type = header_.thumbnails[k];
      t.bytes.assign(frame.bytes.begin(), frame.bytes.end());
    }
    if (!frames_.at_end() && !prefix_) frames_.fail("more data than the header declares");
  }

  ProgressiveMesh assemble() {
    ProgressiveMesh out;
    out.transform = header_.transform;
    out.base_vertices = base_vertices_;
    out.parents.assign(base_vertices_, 0);
    out.parents.insert(out.parents.end(), mesh_.parents.begin(), mesh_.parents.end());
    const float step = 1.0f / static_cast<float>(1u << header_.settings.position_bits);
    for (std::size_t g = 0; g < mesh_.stars.size(); ++g) {
      const auto& p = values_.positions[g];
      const Vec3f position{static_cast<float>(p[0]) * step, static_cast<float>(p[1]) * step,
                           static_cast<float>(p[2]) * step};
      const float error = std::bit_cast<float>(static_cast<std::uint32_t>(values_.errors[g]) << 16);
      out.positions.insert(out.positions.end(), mesh_.stars[g].wedges, position);
      out.errors.insert(out.errors.end(), mesh_.stars[g].wedges, error);
    }
    out.finest_error = header_.finest_error;
    if (mesh_.stars.size() < header_.groups && !out.errors.empty())
      out.finest_error = sum_up(out.finest_error, out.errors.back());
    const auto place = [&](std::int32_t q, std::size_t i) {
      return static_cast<float>(header_.uv_low[i] + q * header_.uv_step[i]);
    };
    for (const auto& uv : values_.uv) out.wedges.uv.push_back({place(uv[0], 0), place(uv[1], 1)});
    out.wedges.colour = std::move(values_.colours);
    out.wedges.material = std::move(values_.materials);
    out.wedges.materials = std::move(header_.materials);
    out.object_normals = std::move(header_.object_normals);
    out.geometry_images = std::move(header_.geometry_images);
    out.octahedral = std::move(header_.octahedral);
    out.wedges.textures = std::move(header_.textures);
    out.triangles = mesh_.triangles();
    for (const std::uint32_t m : out.wedges.material)
      if (m != no_material && m >= out.wedges.materials.size())
        frames_.fail("a vertex has a material that does not exist");
    check_progressive(out, name_);
    sort_by_activation(out);
    return out;
  }

  const std::string& name_;
  bool prefix_;
  Frames frames_;
  LpmHeader header_;
  SplitMesh mesh_;
  LatticeValues values_;
  std::uint32_t base_vertices_ = 0;
};

}  // namespace

ProgressiveMesh read_lpm(ByteReader& input, bool prefix) {
  const std::vector<char> bytes = read_all(input);
  return LpmDecoder(bytes, input.name(), prefix).read();
}

}  // namespace lodestone
