#include "core/formats/common/companion_files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <system_error>

#include "core/base/error.h"
#include "core/files/text_scanner.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::array<std::int8_t, 256> base64_values = [] {
  std::array<std::int8_t, 256> values{};
  values.fill(-1);
  for (std::size_t i = 0; i < base64_digits.size(); ++i)
    values[static_cast<unsigned char>(base64_digits[i])] = static_cast<std::int8_t>(i);
  return values;
}();

std::optional<std::vector<char>> decode_base64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::vector<char> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::int8_t value = base64_values[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 0xFF));
  }
  if (count >= 6) return std::nullopt;  // a single digit is not a byte
  return bytes;
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::string with_slashes(std::string_view name) {
  std::string slashes(name);
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  return slashes;
}

fs::path place_of(const CompanionFolder& folder, std::string_view name) {
  constexpr std::string_view local = "file:///";
  return folder.path / (name.starts_with(local) ? name.substr(local.size() - 1) : name);
}

// Compares the places that symbolic links lead to.
bool is_within(const fs::path& path, const std::optional<fs::path>& limit) {
  if (!limit) return true;
  std::error_code error;
  const fs::path folder = fs::weakly_canonical(fs::absolute(limit->empty() ? "." : *limit, error), error);
  if (error) return false;
  const fs::path way = fs::weakly_canonical(fs::absolute(path, error), error).lexically_relative(folder);
  return !error && !way.empty() && *way.begin() != "..";
}

}  // namespace

std::optional<fs::path> CompanionFiles::find_exactly(std::string_view name) const {
  if (!folder_ || name.empty() || name.find('\0') != std::string_view::npos) return std::nullopt;
  fs::path path = place_of(*folder_, name);
  if (!is_file(path) || !is_within(path, folder_->limit)) return std::nullopt;
  return path;
}

std::optional<fs::path> CompanionFiles::find(std::string_view name) const {
  if (std::optional<fs::path> path = find_exactly(name)) return path;
  const std::string slashes = with_slashes(name);
  if (std::optional<fs::path> path = find_exactly(slashes)) return path;
  return find_exactly(fs::path(slashes).filename().string());
}

bool CompanionFiles::leads_outside(std::string_view name) const {
  return folder_ && !is_within(place_of(*folder_, with_slashes(name)), folder_->limit);
}

CompanionFiles::Absence CompanionFiles::absence(std::string_view name) const {
  if (leads_outside(name))
    return {"lies outside of the model's folder", "put it into that folder, or give --allow-outside"};
  if (find(name)) return {"cannot be read", "check its permissions"};
  return {"cannot be found", "put it beside the model"};
}

std::optional<std::vector<char>> CompanionFiles::read(std::string_view name) const {
  const std::optional<fs::path> path = find(name);
  if (!path) return std::nullopt;
  try {
    ByteReader input(*path);
    return read_all(input);
  } catch (const FileError&) {
    return std::nullopt;
  }
}

std::string percent_decoded(std::string_view uri) {
  std::string result;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned code = 0;
    if (uri[i] == '%' && i + 2 < uri.size()) {
      const char* digits = uri.data() + i + 1;
      if (std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
        result += static_cast<char>(code);
        i += 2;
        continue;
      }
    }
    result += uri[i];
  }
  return result;
}

bool is_data_uri(std::string_view uri) { return uri.starts_with("data:"); }

std::optional<std::vector<char>> decode_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos || !uri.substr(0, comma).ends_with(";base64"))
    return std::nullopt;
  return decode_base64(uri.substr(comma + 1));
}

std::string image_media_type(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return "image/png";
  if (bytes.starts_with("\xff\xd8\xff")) return "image/jpeg";
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "image/webp";
  if (bytes.starts_with("\xabKTX 20\xbb\r\n\x1a\n")) return "image/ktx2";
  return {};
}

namespace {

constexpr const char* no_image = "is not a PNG, JPEG, WebP or KTX2 image";

}  // namespace

std::uint32_t TextureSet::add_file(const std::string& name, const std::string& place, const TextureSampler& sampler) {
  const std::optional<std::filesystem::path> path = files_.find(name);
  const auto [known, is_new] = known_.try_emplace({path ? path->string() : name, sampler}, no_texture);
  if (!is_new) return known->second;
  if (!path) return refuse(name, place, files_.absence(name).what, files_.absence(name).remedy);
  try {
    ByteReader input(*path);
    if (image_media_type(input.window(16)).empty()) return refuse(name, place, no_image);
    known->second = add_bytes(name, place, read_all(input), sampler);
  } catch (const FileError&) {
    return refuse(name, place, "cannot be read");
  }
  return known->second;
}

std::uint32_t TextureSet::add_bytes(const std::string& name, const std::string& place, std::vector<char> bytes,
                                    const TextureSampler& sampler) {
  std::string type = image_media_type({bytes.data(), bytes.size()});
  if (type.empty()) return refuse(name, place, no_image);
  if (type == "image/ktx2")
    mesh_->warnings.push_back(describe(file_, place,
                                       "texture " + quote(name) + " is KTX2, which is kept in files, but not decoded",
                                       "give it as PNG, JPEG or WebP to have it drawn and reduced for coarser levels"));
  mesh_->textures.push_back(
      {name, std::move(type), sampler.u, sampler.v, std::move(bytes), sampler.mag_filter, sampler.min_filter});
  return static_cast<std::uint32_t>(mesh_->textures.size() - 1);
}

std::uint32_t TextureSet::refuse(const std::string& name, const std::string& place, const std::string& why,
                                 const std::string& remedy) {
  mesh_->warnings.push_back(describe(file_, place, "texture " + quote(name) + " " + why + " and is left out", remedy));
  return no_texture;
}

}  // namespace lodestone
