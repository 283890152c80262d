#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>

#include "core/base/error.h"
#include "core/files/atomic_file.h"
#include "core/files/input_file.h"
#include "render/position_map/map_files.h"
#include "render/position_map/map_view.h"
#include "render/position_map/read_map.h"

namespace lodestone {
namespace {

// Receives the library's bytes, so that the file appears complete or not at all.
class MemoryOutput final : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("position map") {}
  void write(const char c[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (bytes.size() < at_ + count) bytes.resize(at_ + count);
    std::memcpy(bytes.data() + at_, c, count);
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }
  std::vector<char> bytes;

 private:
  std::size_t at_ = 0;
};

class MemoryInput final : public Imf::IStream {
 public:
  MemoryInput(std::span<const std::byte> bytes, const char* name) : Imf::IStream(name), bytes_(bytes) {}
  bool read(char c[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (at_ > bytes_.size() || bytes_.size() - at_ < count) throw std::runtime_error("the file is cut off");
    std::memcpy(c, bytes_.data() + at_, count);
    at_ += count;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

// The library makes room for as many bytes as an attribute of a header declares before it finds that the file ends. A
// header follows 8 bytes, is a name, a type, a size and as many bytes for each attribute, and ends with an empty name;
// files of several parts have more of them, and end with an empty one.
void check_attributes(std::span<const std::byte> bytes, const std::string& name) {
  const bool has_parts = bytes.size() > 5 && (bytes[5] & std::byte{0x10}) != std::byte{0};
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto skip = [&](std::size_t count) { rest.remove_prefix(std::min(rest.size(), count)); };
  const auto skip_text = [&] {
    const std::size_t length = rest.substr(0, rest.find('\0')).size();
    skip(length + 1);
    return length;
  };
  skip(8);
  for (bool ended = false; !rest.empty();) {
    if (skip_text() == 0) {
      if (!has_parts || ended) return;
      ended = true;
      continue;
    }
    ended = false;
    skip_text();
    std::uint32_t size = 0;
    std::memcpy(&size, rest.data(), std::min(sizeof(size), rest.size()));
    skip(sizeof(size));
    if (size > rest.size()) throw InputError(describe(name, "", "the file is cut off"));
    skip(size);
  }
}

// One channel, a value per pixel.
struct Plane {
  const char* name;
  std::vector<float> values;
};

std::vector<Plane> planes_of(const PositionMap& map) {
  std::vector<Plane> planes;
  const auto add = [&](const char* name, const auto& value) {
    Plane plane{name, std::vector<float>(map.view.pixels())};
    for (std::size_t i = 0; i < plane.values.size(); ++i)
      plane.values[i] = map.sees(i) ? value(i) : std::numeric_limits<float>::quiet_NaN();
    planes.push_back(std::move(plane));
  };
  add("X", [&](std::size_t i) { return map.position[i].x; });
  add("Y", [&](std::size_t i) { return map.position[i].y; });
  add("Z", [&](std::size_t i) { return map.position[i].z; });
  add("depth", [&](std::size_t i) { return map.depth[i]; });
  if (!map.normal.empty()) {
    add("NX", [&](std::size_t i) { return map.normal[i].x; });
    add("NY", [&](std::size_t i) { return map.normal[i].y; });
    add("NZ", [&](std::size_t i) { return map.normal[i].z; });
  }
  if (!map.uv.empty()) {
    add("U", [&](std::size_t i) { return map.uv[i].x; });
    add("V", [&](std::size_t i) { return map.uv[i].y; });
  }
  if (!map.colour.empty()) {
    add("R", [&](std::size_t i) { return static_cast<float>(map.colour[i].r) / 255; });
    add("G", [&](std::size_t i) { return static_cast<float>(map.colour[i].g) / 255; });
    add("B", [&](std::size_t i) { return static_cast<float>(map.colour[i].b) / 255; });
    add("A", [&](std::size_t i) { return static_cast<float>(map.colour[i].a) / 255; });
  }
  return planes;
}

class ExrReader {
 public:
  ExrReader(Imf::InputFile& file, std::size_t bytes, const std::string& name)
      : file_(file), box_(file.header().dataWindow()) {
    const auto width = std::int64_t{box_.max.x} - box_.min.x + 1, height = std::int64_t{box_.max.y} - box_.min.y + 1;
    if (width < 1 || height < 1 || width > largest_map_side || height > largest_map_side)
      throw InputError(
          describe(name, "", "an image of " + std::to_string(width) + "x" + std::to_string(height) + " pixels"));
    // No compression makes more of a byte than deflate does, which is 1032: room for what cannot be there is not made.
    if (static_cast<std::uint64_t>(width * height) * 4 > std::uint64_t{1100} * bytes)
      throw InputError(describe(name, "", "the file is cut off"));
    width_ = static_cast<int>(width), height_ = static_cast<int>(height);
  }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] bool has(const char* channel) const {
    return file_.header().channels().findChannel(channel) != nullptr;
  }

  // Values of a channel; empty without it.
  template <class T>
  [[nodiscard]] std::vector<T> read(const char* channel) {
    if (!has(channel)) return {};
    std::vector<T> values(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    Imf::FrameBuffer buffer;
    buffer.insert(channel, Imf::Slice::Make(std::is_same_v<T, float> ? Imf::FLOAT : Imf::UINT, values.data(), box_,
                                            sizeof(T), sizeof(T) * static_cast<std::size_t>(width_)));
    file_.setFrameBuffer(buffer);
    file_.readPixels(box_.min.y, box_.max.y);
    return values;
  }

 private:
  Imf::InputFile& file_;
  Imath::Box2i box_;
  int width_ = 0, height_ = 0;
};

void read_channels(ExrReader& reader, PositionMap& map, const std::string& name) {
  if (!reader.has("X") || !reader.has("Y") || !reader.has("Z"))
    throw InputError(describe(name, "", "has no channels X, Y and Z"));
  map.view.width = reader.width(), map.view.height = reader.height();
  const std::size_t n = map.view.pixels();
  const auto vectors = [&](const char* x, const char* y, const char* z, PixelArray<Vec3f>& to) {
    const auto vx = reader.read<float>(x), vy = reader.read<float>(y), vz = reader.read<float>(z);
    to.resize(n);
    for (std::size_t i = 0; i < n; ++i) to[i] = {vx[i], vy[i], vz[i]};
  };
  vectors("X", "Y", "Z", map.position);
  map.triangle = PixelArray(reader.read<std::uint32_t>("triangle"));
  map.depth = PixelArray(reader.read<float>("depth"));
  if (reader.has("NX") && reader.has("NY") && reader.has("NZ")) vectors("NX", "NY", "NZ", map.normal);
  if (reader.has("U") && reader.has("V")) {
    const auto u = reader.read<float>("U"), v = reader.read<float>("V");
    map.uv.resize(n);
    for (std::size_t i = 0; i < n; ++i) map.uv[i] = {u[i], v[i]};
  }
  if (reader.has("R") && reader.has("G") && reader.has("B")) {
    const auto r = reader.read<float>("R"), g = reader.read<float>("G"), b = reader.read<float>("B"),
               a = reader.read<float>("A");
    const auto byte = [](float v) { return static_cast<std::uint8_t>(v > 0 ? std::min(v, 1.0f) * 255 + 0.5f : 0); };
    map.colour.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      map.colour[i] = {byte(r[i]), byte(g[i]), byte(b[i]), a.empty() ? std::uint8_t{255} : byte(a[i])};
  }
}

}  // namespace

void write_exr_map(const std::filesystem::path& path, const PositionMap& map) {
  Imf::Header header(map.view.width, map.view.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  const auto columns = static_cast<std::size_t>(map.view.width);
  std::vector<Plane> planes = planes_of(map);
  const auto slice = [&](Imf::PixelType type, void* data) {
    return Imf::Slice(type, static_cast<char*>(data), 4, 4 * columns);
  };
  for (Plane& plane : planes) {
    header.channels().insert(plane.name, Imf::Channel(Imf::FLOAT));
    buffer.insert(plane.name, slice(Imf::FLOAT, plane.values.data()));
  }
  std::vector<std::uint32_t> triangles = map.triangle.to_vector();
  header.channels().insert("triangle", Imf::Channel(Imf::UINT));
  buffer.insert("triangle", slice(Imf::UINT, triangles.data()));
  MemoryOutput memory;
  {
    Imf::OutputFile file(memory, header, 0);
    file.setFrameBuffer(buffer);
    file.writePixels(map.view.height);
  }
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(memory.bytes)));
  file.commit();
}

PositionMap read_exr_map(const std::filesystem::path& path, const MapView& view, const Transform& transform) {
  return parse_exr_map(MappedFile(path).bytes(), path.string(), view, transform);
}

PositionMap parse_exr_map(std::span<const std::byte> bytes, const std::string& name, const MapView& view,
                          const Transform& transform) {
  PositionMap map;
  map.view = view;
  map.transform = transform;
  try {
    check_attributes(bytes, name);
    MemoryInput memory(bytes, name.c_str());
    Imf::InputFile file(memory, 0);
    ExrReader reader(file, bytes.size(), name);
    read_channels(reader, map, name);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw InputError(describe(name, "", std::string("is not a valid OpenEXR image: ") + error.what()));
  }
  complete_map(map, name);
  return map;
}

}  // namespace lodestone
