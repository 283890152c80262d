#include "core/formats/gltf/gltf_document.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/error.h"
#include "core/files/scalar.h"
#include "core/files/text_scanner.h"
#include "core/formats/gltf/gltf_meshopt.h"
#include "core/formats/gltf/gltf_surface.h"

namespace lodestone {
namespace {

constexpr const char* truncated = "the file is truncated or damaged";
constexpr std::uint32_t json_chunk = 0x4E4F534Au, binary_chunk = 0x004E4942u;  // "JSON", "BIN\0"

// Extensions that may be required although they are not read: they change how surfaces and lights look, no triangle.
bool is_known_extension(std::string_view name) {
  constexpr std::array<std::string_view, 8> known{
      "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization", "KHR_texture_transform",
      "EXT_texture_webp",           "KHR_texture_basisu",      "KHR_lights_punctual",   "EXT_mesh_gpu_instancing"};
  return std::find(known.begin(), known.end(), name) != known.end() || name.starts_with("KHR_materials_");
}

}  // namespace

GltfDocument::GltfDocument(ByteReader& input) : file_(input.name()), files_(input.folder()), bytes_(read_all(input)) {
  size_ = bytes_.size();
  if (std::string_view(bytes_.data(), bytes_.size()).starts_with("glTF")) {
    read_binary(bytes_);
  } else {
    json_ = parse_json(bytes_, file_);
    bytes_ = {};
  }
  check_asset();
}

void GltfDocument::read_binary(std::span<const char> bytes) {
  const auto fail = [&](std::size_t at, const std::string& what) {
    throw InputError(describe(file_, "byte " + std::to_string(at), what, truncated));
  };
  if (bytes.size() < 12) fail(bytes.size(), "the file ends in its header");
  const auto version = load<std::uint32_t>(bytes.data() + 4);
  if (version != 2)
    throw UnsupportedError(
        describe(file_, "byte 4", "binary glTF of version " + std::to_string(version), "convert it to glTF 2.0"));
  const auto length = load<std::uint32_t>(bytes.data() + 8);
  if (length < 12 || length > bytes.size())
    fail(8, "declares " + std::to_string(length) + " bytes, the file has " + std::to_string(bytes.size()));
  std::size_t at = 12;
  bool has_json = false;
  while (length - at >= 8) {
    const auto size = load<std::uint32_t>(bytes.data() + at);
    const auto type = load<std::uint32_t>(bytes.data() + at + 4);
    if (size > length - at - 8)
      fail(at,
           "a chunk of " + std::to_string(size) + " bytes, but only " + std::to_string(length - at - 8) + " follow");
    const std::span<const char> chunk = bytes.subspan(at + 8, size);
    if (!has_json) {
      if (type != json_chunk) fail(at + 4, "the first chunk is not JSON");
      json_ = parse_json(chunk, file_);
      has_json = true;
    } else if (type == binary_chunk && binary_.empty()) {
      binary_ = chunk;
    }
    at += 8 + size;
  }
  if (!has_json) fail(at, "there is no JSON chunk");
}

void GltfDocument::check_asset() const {
  const std::string version = root().at("asset").at("version").string();
  if (!version.starts_with("2."))
    throw UnsupportedError(describe(file_, "asset.version", "glTF " + quote(version), "convert it to glTF 2.0"));
  const std::optional<JsonView> required = root().find("extensionsRequired");
  for (std::size_t i = 0; required && i < required->size(); ++i) {
    const std::string& name = required->at(i).string();
    if (!is_known_extension(name))
      throw UnsupportedError(describe(file_, required->at(i).place(), "the extension " + quote(name) + " is required",
                                      "this program does not know it; export the model without it"));
  }
}

JsonView GltfDocument::item(const char* array, const JsonView& reference) const {
  const std::uint64_t index = reference.integer();
  const std::optional<JsonView> items = root().find(array);
  const std::size_t count = items ? items->size() : 0;
  if (index >= count)
    reference.fail("index " + std::to_string(index) + " is out of range, the file has " + std::to_string(count) + " " +
                   array);
  return items->at(static_cast<std::size_t>(index));
}

GltfDocument::Bytes GltfDocument::load_buffer(const JsonView& description, std::size_t index) {
  const std::optional<JsonView> uri = description.find("uri");
  if (!uri) {
    if (index == 0 && !binary_.empty())
      return std::make_shared<const std::vector<char>>(binary_.begin(), binary_.end());
    description.fail("the buffer has neither a 'uri' nor a binary chunk", truncated);
  }
  if (is_data_uri(uri->string())) {
    if (std::optional<std::vector<char>> bytes = decode_data_uri(uri->string()))
      return std::make_shared<const std::vector<char>>(std::move(*bytes));
    uri->fail("invalid data URI", "encode the data as base64");
  }
  const std::string name = percent_decoded(uri->string());
  if (const std::optional<std::filesystem::path> path = files_.find(name)) {
    Bytes& known = beside_[std::filesystem::weakly_canonical(*path)];
    if (known) return known;
    if (std::optional<std::vector<char>> bytes = files_.read(name)) {
      size_ += bytes->size();
      return known = std::make_shared<const std::vector<char>>(std::move(*bytes));
    }
  }
  const auto [what, remedy] = files_.absence(name);
  throw FileError(describe(file_, uri->place(), "the buffer " + quote(name) + " " + what, remedy));
}

std::span<const char> GltfDocument::buffer(const JsonView& reference) {
  const JsonView description = item("buffers", reference);
  const auto index = static_cast<std::size_t>(reference.integer());
  const std::uint64_t length = description.at("byteLength").integer();
  std::span<const char> bytes = binary_;
  // The binary chunk is not copied.
  if (index != 0 || binary_.empty() || description.find("uri")) {
    const auto [loaded, is_new] = buffers_.try_emplace(index);
    if (is_new) loaded->second = load_buffer(description, index);
    bytes = *loaded->second;
  }
  if (length > bytes.size())
    description.fail(
        "declares " + std::to_string(length) + " bytes, but only " + std::to_string(bytes.size()) + " exist",
        truncated);
  return bytes.first(static_cast<std::size_t>(length));
}

// {"buffer", "byteOffset", "byteLength"}: a buffer view, or its compressed form.
std::span<const char> GltfDocument::part_of_buffer(const JsonView& range) {
  const std::span<const char> whole = buffer(range.at("buffer"));
  const std::uint64_t offset = range.integer_or("byteOffset", 0), length = range.at("byteLength").integer();
  if (offset > whole.size() || length > whole.size() - offset)
    range.fail("reaches from byte " + std::to_string(offset) + " to " + std::to_string(offset + length) +
                   " of a buffer of " + std::to_string(whole.size()) + " bytes",
               truncated);
  return whole.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

Affine3d affine_of(const JsonView& matrix) {
  const std::array<double, 16> m = matrix.numbers<16>();
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) matrix.fail("the last row of the matrix is not (0, 0, 0, 1)");
  return {{Vec3d{m[0], m[1], m[2]}, Vec3d{m[4], m[5], m[6]}, Vec3d{m[8], m[9], m[10]}}, {m[12], m[13], m[14]}};
}

GltfView GltfDocument::view(const JsonView& reference) {
  const JsonView description = item("bufferViews", reference);
  const std::optional<JsonView> packed = extension(description, "EXT_meshopt_compression");
  if (!packed) return {part_of_buffer(description), static_cast<std::size_t>(description.integer_or("byteStride", 0))};
  const auto [decompressed, is_new] = decompressed_.try_emplace(static_cast<std::size_t>(reference.integer()));
  if (is_new) {
    decompressed->second = decompress_meshopt(*packed, part_of_buffer(*packed));
    decompressed_bytes_ += decompressed->second.size();
    if (decompressed_bytes_ > (std::uint64_t{1} << 20) + meshopt_densest * size_)
      packed->fail("the views of the file declare more than its bytes can hold", truncated);
  }
  return {decompressed->second, static_cast<std::size_t>(packed->at("byteStride").integer())};
}

}  // namespace lodestone
