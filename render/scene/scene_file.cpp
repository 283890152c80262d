#include "render/scene/scene_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <numbers>
#include <utility>

#include "core/base/known_names.h"
#include "render/scene/toml_table.h"

namespace lodestone {
namespace {

constexpr double any = 1e30;        // bound of numbers without a range
constexpr double positive = 1e-30;  // the smallest value above zero

// One of a few names.
template <class T, std::size_t N>
void choice(TomlTable& table, const char* key, T& to, const std::array<std::pair<const char*, T>, N>& choices) {
  const toml::node* node = table.find(key);
  if (!node) return;
  const std::string text = node->value_or(std::string());
  std::vector<std::string> known;
  std::string list;
  for (const auto& [name, value] : choices) {
    if (text == name) {
      to = value;
      return;
    }
    known.emplace_back(name);
    list += (list.empty() ? "" : ", ") + known.back();
  }
  table.fail(*node, key, "must be one of " + list + did_you_mean(text, known));
}

void read_source(TomlTable& table, const toml::node& at, SceneModel& model) {
  std::string shape_name;
  table.text("file", model.file);
  table.text("generate", shape_name);
  std::int64_t triangles = 100'000, seed = 1;
  table.integer("triangles", triangles, 12, 2'000'000'000);
  table.integer("seed", seed, 0, std::numeric_limits<std::int64_t>::max());
  if (model.file.empty() == shape_name.empty())
    table.fail_missing(at, {"file", "generate"}, "or generate is needed, one of them, to define the model");
  if (shape_name.empty()) {
    if (table.has("triangles") || table.has("seed")) table.fail(at, "triangles", "and seed need generate");
    model.file = beside(table.file(), model.file);
    model.name = std::filesystem::path(model.file).stem().string();
    return;
  }
  model.name = shape_name;
  model.generate.emplace();
  try {
    model.generate->shape = shape_named(shape_name);
  } catch (const InputError& error) {
    table.fail(at, "generate", std::string("is wrong: ") + error.what());
  }
  model.generate->triangles = static_cast<std::uint64_t>(triangles);
  model.generate->seed = static_cast<std::uint64_t>(seed);
}

void read_model(TomlTable& table, const toml::node& at, Scene& scene) {
  SceneModel model;
  read_source(table, at, model);
  table.text("name", model.name);
  if (std::ranges::find(scene.models, model.name, &SceneModel::name) != scene.models.end()) {
    if (table.has("name")) table.fail(at, "name", "'" + model.name + "' is already the name of another model");
    model.name += "-" + std::to_string(scene.models.size() + 1);
  }
  table.flag("fill_voids", model.fill_voids);
  table.vector("position", model.position, -any, any);
  table.vector("rotation", model.rotation, -any, any);
  table.number("scale", model.scale, positive, any);
  double extent = 0;
  table.number("extent", extent, positive, any);
  if (extent > 0) model.extent = extent;
  if (extent > 0 && table.has("scale")) table.fail(*table.find("extent"), "extent", "and scale exclude each other");
  choice(table, "anchor", model.anchor,
         std::array{std::pair{"origin", Anchor::origin}, std::pair{"centre", Anchor::centre},
                    std::pair{"base", Anchor::base}});
  if (table.has("colour")) table.colour("colour", model.colour.emplace());
  table.number("opacity", model.appearance.opacity, 0, 1);
  choice(table, "shading", model.appearance.smooth, std::array{std::pair{"smooth", true}, std::pair{"flat", false}});
  table.flag("vertex_colours", model.appearance.vertex_colours);
  table.flag("textures", model.appearance.textures);
  table.flag("normal_maps", model.appearance.normal_maps);
  scene.models.push_back(std::move(model));
}

void read_lighting(TomlTable& table, Scene& scene) {
  Lighting& lighting = scene.settings.lighting;
  table.number("ambient", lighting.ambient, 0, 1);
  table.number("head", lighting.head, 0, 100);
  table.sub_table("directional", [&](TomlTable& light) {
    lighting.directional.strength = 1;
    light.number("strength", lighting.directional.strength, 0, 100);
    light.flag("shadows", lighting.directional.shadows);
    light.vector("towards", scene.towards_light, -any, any);
    if (length(scene.towards_light) == 0)
      light.fail(*light.find("towards"), "towards", "must not be the zero vector: it is the way to the light");
  });
}

void read_camera(TomlTable& table, Scene& scene) {
  SceneCamera& camera = scene.camera;
  std::int64_t frames = camera.frames;
  table.text("path", camera.path);
  table.text("fly_to", camera.fly_to);
  table.integer("frames", frames, 1, 1'000'000);
  camera.frames = static_cast<int>(frames);
  table.tables("key", [&](TomlTable& key, const toml::node& at) {
    Camera c;
    for (const char* needed : {"position", "target"})
      if (!key.has(needed)) key.fail_missing(at, {needed}, "is missing");
    key.vector("position", c.position, -any, any);
    key.vector("target", c.target, -any, any);
    key.vector("up", c.up, -any, any);
    double fov = c.vertical_fov * 180 / std::numbers::pi;
    key.number("fov_degrees", fov, 0.001, 179.9);
    c.vertical_fov = fov * std::numbers::pi / 180;
    if (c.position == c.target) key.fail(at, "target", "is the position of the camera");
    camera.keys.push_back(c);
  });
  const toml::node* path = table.find("path");
  if (!camera.keys.empty()) {
    if (path) table.fail(*path, "path", "and keys exclude each other");
    camera.path.clear();
  } else if (!is_model_path(camera.path)) {
    camera.path = beside(table.file(), camera.path);
  }
  if (!camera.fly_to.empty() && std::ranges::find(scene.models, camera.fly_to, &SceneModel::name) == scene.models.end())
    table.fail(*table.find("fly_to"), "fly_to", "is not the name of a model of the scene");
}

void read_effects(TomlTable& table, Scene& scene) {
  FrameSettings& settings = scene.settings;
  if (const toml::node* node = table.find("run")) {
    std::string names = node->value_or(std::string());
    if (const toml::array* array = node->as_array()) {
      for (const toml::node& name : *array)
        names.append(names.empty() ? "" : ",").append(name.value_or(std::string("?")));
      if (array->empty()) names = "none";
    }
    try {
      scene.effects = parse_effects(names);
    } catch (const InputError& error) {
      table.fail(*node, "run", std::string("is wrong: ") + error.what());
    }
  }
  table.number("level_tint", settings.level_tint, 0, 1);
  table.number("wireframe", settings.wireframe, 0, 1);
  table.flag("overdraw", settings.overdraw);
}

void read_detail(TomlTable& table, Scene& scene) {
  table.number("pixel_error", scene.radii.pixel_error, positive, 1e6);
  std::string blend_name;
  table.text("blend", blend_name);
  try {
    if (!blend_name.empty()) scene.blend = blend_named(blend_name);
  } catch (const InputError& error) {
    table.fail(*table.find("blend"), "blend", std::string("is wrong: ") + error.what());
  }
}

}  // namespace

bool is_scene_file(const std::string& file) { return std::filesystem::path(file).extension() == ".toml"; }

Scene read_scene(const std::string& file) {
  const toml::table root = parse_toml(file);
  TomlTable table(root, file, "");
  Scene scene;
  scene.up = UpAxis::z;
  table.tables("model", [&](TomlTable& model, const toml::node& at) { read_model(model, at, scene); });
  if (scene.models.empty()) throw InputError(describe(file, {}, "has no models", "add a [[model]] with a file"));
  table.colour("background", scene.settings.background);
  table.sub_table("lighting", [&](TomlTable& t) { read_lighting(t, scene); });
  table.sub_table("fog", [&](TomlTable& t) {
    scene.settings.fog.density = by_scene_size;
    t.colour("colour", scene.settings.fog.colour);
    t.number("density", scene.settings.fog.density, 0, any);
  });
  table.sub_table("ambient_occlusion", [&](TomlTable& t) {
    scene.settings.ambient_occlusion = {1, by_scene_size};
    t.number("strength", scene.settings.ambient_occlusion.strength, 0, 1);
    t.number("radius", scene.settings.ambient_occlusion.radius, 0, any);
  });
  table.sub_table("effects", [&](TomlTable& t) { read_effects(t, scene); });
  table.sub_table("detail", [&](TomlTable& t) { read_detail(t, scene); });
  table.sub_table("camera", [&](TomlTable& t) { read_camera(t, scene); });
  table.refuse_others();
  return scene;
}

}  // namespace lodestone
