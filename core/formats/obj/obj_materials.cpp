#include "core/formats/obj/obj_materials.h"

#include <sstream>
#include <utility>

#include "core/base/error.h"
#include "core/files/text_scanner.h"

namespace lodestone {

void ObjMaterials::add_libraries(const std::string& names, const std::string& place) {
  if (files_.find(names)) return add_library(names, place);
  std::istringstream words(names);
  for (std::string name; words >> name;) add_library(name, place);
}

void ObjMaterials::add_library(const std::string& name, const std::string& place) {
  const std::optional<std::filesystem::path> path = files_.find(name);
  if (!path) {
    mesh_->warnings.push_back(
        describe(file_, place, "material library " + quote(name) + " cannot be found; its materials are white"));
    return;
  }
  try {
    ByteReader input(*path);
    for (MtlMaterial& material : read_mtl(input)) {
      std::string key = material.name;
      known_.try_emplace(std::move(key), Entry{std::move(material), input.name()});
    }
  } catch (const Error& error) {
    mesh_->warnings.push_back(std::string(error.what()) + "; the materials of this library are white");
  }
}

std::uint32_t ObjMaterials::use(const std::string& name, const std::string& place) {
  const auto [used, is_new] = used_.try_emplace(name, static_cast<std::uint32_t>(mesh_->materials.size()));
  if (!is_new) return used->second;
  Material material{.name = name};
  if (const auto found = known_.find(name); found != known_.end()) {
    const MtlMaterial& source = found->second.material;
    const std::string& library = found->second.library;
    const auto texture = [&](const std::optional<MtlTexture>& statement) {
      if (!statement) return no_texture;
      return textures_.add_file(statement->file, place + ": " + library + ": " + statement->place, statement->wraps);
    };
    material.base_colour = source.colour;
    if (source.texture) set_colour_texture(material, texture(source.texture));
    material.normal_map = texture(source.normal_map);
  }
  mesh_->materials.push_back(std::move(material));
  return used->second;
}

}  // namespace lodestone
