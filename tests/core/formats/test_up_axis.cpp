// The up axis of a model: of formats, guessed, given, kept, and what formats with one of their own are turned by.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/formats/gltf/gltf.h"
#include "core/formats/mesh_file.h"
#include "core/math/affine.h"
#include "core/mesh/up_axis.h"
#include "tests/core/formats/gltf_test_util.h"
#include "tests/test_folder.h"

namespace lodestone {
namespace {

using nlohmann::json;

constexpr std::array all_axes{UpAxis::z, UpAxis::y, UpAxis::x, UpAxis::minus_z, UpAxis::minus_y, UpAxis::minus_x};

Vec3d turned_by(const std::array<double, 4>& q, Vec3d v) {
  const Vec3d axis{q[0], q[1], q[2]}, side = 2.0 * cross(axis, v);
  return v + q[3] * side + cross(axis, side);
}

TEST(UpAxisTurn, TakesOneAxisToAnother) {
  for (const UpAxis a : all_axes)
    for (const UpAxis b : all_axes) {
      const Vec3d from = direction_of(a, {}), to = direction_of(b, {});
      const Affine3d turn = turn_between(from, to);
      EXPECT_EQ(turn.vector(from), to) << name_of(a) << name_of(b);  // exactly
      EXPECT_EQ(turn.determinant(), 1);
      EXPECT_LE(length(turned_by(turn_quaternion(from, to), from) - to), 1e-15);
      EXPECT_LE(length(turned_by(turn_quaternion(from, to), {1, 2, 3}) - turn.vector({1, 2, 3})), 1e-14);
    }
  EXPECT_EQ(turn_between({0, 0, 1}, {0, 1, 0}).vector({1, 2, 3}), (Vec3d{1, 3, -2}));  // as glTF is made of z up
}

TEST(UpAxisNames, AreThoseOfTheOption) {
  for (const UpAxis axis : all_axes) EXPECT_EQ(up_axis(std::string(name_of(axis))), axis);
  for (const char* wrong : {"", "Y", "+z", "earth", "up"}) EXPECT_THROW((void)up_axis(wrong), InputError) << wrong;
  EXPECT_LE(length(direction_of(UpAxis::earth, {0, 3, 4}) - Vec3d{0, 0.6, 0.8}), 1e-15);
}

TEST(UpAxisNames, AreNotedWhereGuessed) {
  EXPECT_EQ(guess_note({UpAxis::minus_x, true}), "up is -x, guessed by the format; --up AXIS gives another");
  EXPECT_EQ(guess_note({UpAxis::minus_x, false}), "");
}

class UpAxisOfFiles : public testing::Test {
 protected:
  Up up(const std::string& name, const std::string& text, const ReadConfig& config = {}) {
    return read_mesh(folder_.write(name, text), config).up;
  }
  TestFolder folder_;
};

const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

TEST_F(UpAxisOfFiles, IsThatOfTheFormatOrAGuess) {
  EXPECT_EQ(up("a.glb", triangle_file().glb()), (Up{UpAxis::y, false}));
  EXPECT_EQ(up("a.obj", obj), (Up{UpAxis::y, true}));
  EXPECT_EQ(up("a.off", off), (Up{UpAxis::z, true}));
  EXPECT_EQ(up("a.asc", "ncols 2\nnrows 2\ncellsize 1\n0 0 0 0\n"), (Up{UpAxis::z, false}));
  ReadConfig given;
  given.up = UpAxis::minus_x;
  for (const auto& [name, text] : {std::pair{"b.glb", triangle_file().glb()}, {"b.obj", obj}, {"b.off", off}})
    EXPECT_EQ(up(name, text, given), (Up{UpAxis::minus_x, false})) << name;
}

TEST_F(UpAxisOfFiles, OfTilesIsZUnlessTheyLieOnTheEarth) {
  folder_.write("a.glb", triangle_file().glb());
  const auto tiles = [&](const json& transform) {
    json root{{"geometricError", 1}, {"content", {{"uri", "a.glb"}}}};
    if (!transform.is_null()) root["transform"] = transform;
    return up("tileset.json", json{{"asset", {{"version", "1.1"}}}, {"geometricError", 2}, {"root", root}}.dump());
  };
  EXPECT_EQ(tiles(nullptr), (Up{UpAxis::z, false}));
  EXPECT_EQ(tiles({1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 5, 6, 7, 1}), (Up{UpAxis::z, false}));  // turned to it
  EXPECT_EQ(tiles({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3.68e6, 3.68e6, 3.68e6, 1}), (Up{UpAxis::earth, false}));
}

// Read again, the model stands as it stood; y up, as glTF has it.
TEST_F(UpAxisOfFiles, TurnsWhatIsWrittenAsGltf) {
  const RawMesh flat = read_mesh(folder_.write("a.off", off));
  for (const UpAxis axis : all_axes) {
    RawMesh mesh = flat;
    mesh.up = {axis, true};
    write_mesh(folder_ / "b.glb", mesh);
    const RawMesh again = read_mesh(folder_ / "b.glb");
    EXPECT_EQ(again.up, (Up{UpAxis::y, false}));
    const Affine3d turn = turn_between(direction_of(axis, {}), {0, 1, 0});
    for (std::size_t v = 0; v < 3; ++v)
      EXPECT_LE(length(again.positions[v] - turn.vector(flat.positions[v])), 1e-7) << name_of(axis);
  }
}

}  // namespace
}  // namespace lodestone
