#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "core/base/error.h"
#include "render/scene/scene_file.h"
#include "tests/test_data.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

class SceneFile : public FolderTest {
 protected:
  std::string write(const std::string& text) {
    const std::string file = (folder_ / "scene.toml").string();
    std::ofstream(file) << text;
    return file;
  }
  // The message of the refusal.
  std::string refusal(const std::string& text) {
    try {
      (void)read_scene(write(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
};

const std::string every_key = R"(
background = [0.1, 0.2, 0.3]
[[model]]
file = "scans/statue.ply"
fill_voids = true
position = [1, 2.5, -3]
rotation = [90, 0, 45]
scale = 2
colour = [1, 0.5, 0]
opacity = 0.5
shading = "flat"
vertex_colours = false
textures = false
normal_maps = false
[[model]]
name = "ball"
generate = "sphere"
triangles = 5000
seed = 7
extent = 1.5
anchor = "base"
[lighting]
ambient = 0.4
head = 0.5
directional = { towards = [0, 0, 2], strength = 0.7, shadows = true }
[fog]
colour = [0.5, 0.6, 0.7]
density = 0.25
[ambient_occlusion]
strength = 0.75
radius = 0.1
[effects]
run = ["fog", "wireframe"]
level_tint = 0.5
wireframe = 0.25
overdraw = true
[detail]
pixel_error = 2
blend = "cosine"
[camera]
frames = 9
key = [{ position = [0, -5, 1], target = [0, 0, 0], up = [0, 1, 0], fov_degrees = 60 },
       { position = [0, -3, 1], target = [0, 0, 0] }]
)";

TEST_F(SceneFile, EveryKey) {
  const Scene scene = read_scene(write(every_key));
  ASSERT_EQ(scene.models.size(), 2u);
  const SceneModel &statue = scene.models[0], &ball = scene.models[1];
  EXPECT_EQ(statue.name, "statue");
  EXPECT_EQ(statue.file, (folder_ / "scans/statue.ply").string());
  EXPECT_TRUE(statue.fill_voids);
  EXPECT_EQ(statue.position, (Vec3d{1, 2.5, -3}));
  EXPECT_EQ(statue.rotation, (Vec3d{90, 0, 45}));
  EXPECT_EQ(statue.scale, 2);
  EXPECT_EQ(statue.anchor, Anchor::origin);
  EXPECT_EQ(statue.colour, (Vec3f{1, 0.5f, 0}));
  EXPECT_EQ(
      statue.appearance,
      (Appearance{.opacity = 0.5f, .smooth = false, .vertex_colours = false, .textures = false, .normal_maps = false}));
  EXPECT_EQ(ball.name, "ball");
  ASSERT_TRUE(ball.generate);
  EXPECT_EQ(ball.generate->triangles, 5000u);
  EXPECT_EQ(ball.generate->seed, 7u);
  EXPECT_EQ(ball.extent, 1.5);
  EXPECT_EQ(ball.anchor, Anchor::base);
  EXPECT_FALSE(ball.colour);
  FrameSettings settings;
  settings.background = {0.1f, 0.2f, 0.3f};
  settings.lighting = {0.4f, 0.5f, {0.7f, true}};
  settings.fog = {{0.5f, 0.6f, 0.7f}, 0.25f};
  settings.ambient_occlusion = {0.75f, 0.1f};
  settings.level_tint = 0.5f, settings.wireframe = 0.25f, settings.overdraw = true;
  EXPECT_EQ(scene.settings, settings);
  EXPECT_EQ(scene.towards_light, (Vec3d{0, 0, 2}));
  EXPECT_EQ(scene.effects, (EffectRequest{EffectRequest::Kind::listed, {Effect::fog, Effect::wireframe}, {}}));
  EXPECT_EQ(scene.radii.pixel_error, 2);
  EXPECT_EQ(scene.blend, Blend::cosine);
  EXPECT_EQ(scene.camera.frames, 9);
  EXPECT_TRUE(scene.camera.path.empty());
  ASSERT_EQ(scene.camera.keys.size(), 2u);
  EXPECT_EQ(scene.camera.keys[0].up, (Vec3d{0, 1, 0}));
  EXPECT_NEAR(scene.camera.keys[0].vertical_fov, std::numbers::pi / 3, 1e-12);
  EXPECT_EQ(scene.camera.keys[1].up, (Vec3d{0, 0, 1}));
}

TEST_F(SceneFile, DefaultsAreThoseOfAModelAlone) {
  const Scene scene = read_scene(write("[[model]]\nfile = \"a.lode\"\n[[model]]\nfile = \"a.lode\"\n"));
  EXPECT_EQ(scene.settings, FrameSettings{});
  EXPECT_EQ(scene.effects, EffectRequest{});
  EXPECT_EQ(scene.models[0].appearance, Appearance{});
  EXPECT_EQ(scene.camera.path, "orbit");
  EXPECT_NE(scene.models[0].name, scene.models[1].name);  // told apart
}

TEST_F(SceneFile, WhatIsWrongIsNamedWithItsLine) {
  const std::string model = "[[model]]\nfile = \"a.lode\"\n";  // two lines
  const struct {
    std::string text, line, what;
  } faults[] = {
      {"", "", "has no models"},
      {"[[model]\n", "line 1", "not valid TOML"},
      {model + "colr = [1, 1, 1]\n", "line 3", "unknown key 'colr' in model 1"},
      {model + "color = [1, 1, 1]\n", "line 3", "did you mean colour?"},
      {"[[model]]\nfiel = \"a.lode\"\n", "line 2",
       "unknown key 'fiel' in model 1; known are file, generate; did you mean file?"},
      {model + "[effects]\nrun = \"wirefram\"\n", "line 4", "did you mean wireframe?"},
      {model + "[camera]\nkey = [{ positon = [1, 0, 0], target = [0, 0, 0] }]\n", "line 4", "did you mean position?"},
      {"fogg = 1\n" + model, "line 1", "unknown key 'fogg'"},
      {model + "[fog]\nthickness = 1\n", "line 4", "unknown key 'thickness' in fog"},
      {model + "scale = 0\n", "line 3", "scale must be a number above 0"},
      {model + "scale = \"big\"\n", "line 3", "scale must be a number"},
      {model + "scale = nan\n", "line 3", "scale must be a number"},
      {model + "scale = 1\nextent = 2\n", "line 4", "exclude each other"},
      {model + "position = [1, 2]\n", "line 3", "position must be three numbers"},
      {model + "position = [1, 2, inf]\n", "line 3", "position must be a number"},
      {model + "rotation = 90\n", "line 3", "rotation must be three numbers"},
      {model + "colour = [1, 2, 0]\n", "line 3", "colour must be a number from 0 to 1"},
      {model + "opacity = 1.5\n", "line 3", "opacity must be a number from 0 to 1"},
      {model + "shading = \"gouraud\"\n", "line 3", "shading must be one of smooth, flat"},
      {model + "textures = 1\n", "line 3", "textures must be true or false"},
      {model + "anchor = \"top\"\n", "line 3", "anchor must be one of origin, centre, base"},
      {model + "generate = \"sphere\"\n", "line 1", "or generate is needed"},
      {"[[model]]\nname = \"x\"\n", "line 1", "or generate is needed"},
      {"[[model]]\nfile = \"\"\n", "line 2", "file must be a text"},
      {model + "triangles = 100\n", "line 1", "need generate"},
      {"[[model]]\ngenerate = \"cube\"\n", "line 1", "unknown shape"},
      {"[[model]]\ngenerate = \"box\"\ntriangles = 5\n", "line 3", "triangles must be a whole number from 12"},
      {"[[model]]\ngenerate = \"box\"\ntriangles = 50.5\n", "line 3", "must be a whole number"},
      {model + "name = \"x\"\n" + model + "name = \"x\"\n", "line 4", "the name of another model"},
      {"model = 3\n", "line 1", "must be tables"},
      {model + "[lighting]\nambient = -1\n", "line 4", "ambient must be a number from 0 to 1"},
      {model + "[lighting]\ndirectional = { towards = [0, 0, 0] }\n", "line 4", "zero vector"},
      {model + "[lighting]\ndirectional = 1\n", "line 4", "must be a table"},
      {model + "[fog]\ndensity = -1\n", "line 4", "density must be a number of at least 0"},
      {model + "[effects]\nrun = \"bloom\"\n", "line 4", "unknown effect 'bloom'"},
      {model + "[effects]\nrun = [1]\n", "line 4", "unknown effect"},
      {model + "[detail]\nblend = \"quick\"\n", "line 4", "unknown blend"},
      {model + "[detail]\npixel_error = 0\n", "line 4", "pixel_error must be a number from"},
      {model + "[camera]\nframes = 0\n", "line 4", "frames must be a whole number from 1"},
      {model + "[camera]\nfly_to = \"b\"\n", "line 4", "is not the name of a model"},
      {model + "[camera]\nkey = [{ position = [1, 0, 0] }]\n", "line 4", "target is missing"},
      {model + "[camera]\nkey = [{ position = [1, 0, 0], target = [1, 0, 0] }]\n", "line 4",
       "the position of the camera"},
      {model + "[camera]\npath = \"orbit\"\nkey = [{ position = [1, 0, 0], target = [0, 0, 0] }]\n", "line 4",
       "exclude each other"},
  };
  for (const auto& [text, line, what] : faults) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find("scene.toml"), std::string::npos) << text << message;
    EXPECT_NE(message.find(line), std::string::npos) << text << message;
    EXPECT_NE(message.find(what), std::string::npos) << text << message;
  }
  EXPECT_THROW((void)read_scene((folder_ / "none.toml").string()), FileError);
}

// The scenes that come with the sources; their models are data, which need not be there.
TEST_F(SceneFile, ExamplesAreRead) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "experiments/scenes")) {
    EXPECT_NO_THROW((void)read_scene(entry.path().string())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 4u);
}

}  // namespace
}  // namespace lodestone
