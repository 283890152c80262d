#include "core/formats/common/mesh_companions.h"

#include <algorithm>
#include <string_view>
#include <system_error>

namespace lodestone {
namespace {

namespace fs = std::filesystem;

std::string plain_name(std::string name) {
  const auto ends_names = [](unsigned char c) {
    return c <= ' ' || c == 127 || std::string_view("#\"'\\").find(static_cast<char>(c)) != std::string_view::npos;
  };
  std::replace_if(name.begin(), name.end(), ends_names, '_');
  if (name.starts_with('-')) name.front() = '_';  // no option of a statement
  return name;
}

}  // namespace

MeshCompanions::MeshCompanions(const fs::path& mesh)
    : folder_(mesh.parent_path()), stem_(plain_name(mesh.stem().string())) {
  std::error_code ignored;
  const fs::file_status status = fs::status(mesh, ignored);
  possible_ = !fs::exists(status) || fs::is_regular_file(status);
}

std::string MeshCompanions::add(const std::string& suffix, std::span<const std::byte> bytes) {
  std::string name = stem_ + suffix;
  files_.push_back(std::make_unique<AtomicFile>(folder_ / name));
  files_.back()->write(bytes);
  files_.back()->flush();
  return name;
}

std::string MeshCompanions::add_texture(const Texture& texture, std::size_t number) {
  std::string suffix = "_";
  suffix += std::to_string(number);
  return add(suffix + image_extension(texture.media_type), std::as_bytes(std::span(texture.bytes)));
}

void MeshCompanions::commit() {
  for (const auto& file : files_) file->commit();
}

std::string image_extension(const std::string& media_type) {
  if (media_type == "image/png") return ".png";
  if (media_type == "image/webp") return ".webp";
  return media_type == "image/ktx2" ? ".ktx2" : ".jpg";
}

}  // namespace lodestone
