// Position maps as files: written maps are read back; other files are refused by name.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/base/error.h"
#include "render/position_map/map_files.h"
#include "tests/expect_error.h"
#include "tests/render/reconstruct/obvious_map.h"
#include "tests/test_folder.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

class MapFiles : public FolderTest {
 protected:
  void SetUp() override {
    IndexedMesh mesh = sphere_mesh(3);
    mesh.transform.up = {UpAxis::minus_x, false};
    for (const Vec3f& p : mesh.positions) {
      mesh.wedges.uv.push_back({p.x, p.y});
      mesh.wedges.colour.push_back({1, 2, static_cast<std::uint8_t>(200 * p.z), 255});
    }
    const auto serial = make_serial_scheduler();
    for (const MapView& view : {orthographic_view(box_of(mesh), {0.1, -0.4, 0.7}, 1.0 / 50),
                                perspective_view(box_of(mesh), {2, 2, 2}, 1.0 / 40)})
      maps_.push_back(rasterize_map(mesh, view, {.uv = true, .colour = true}, *serial));
  }

  void write(const std::string& name, const std::string& bytes) const { test_folder_.write(name, bytes); }
  [[nodiscard]] std::string read(const std::string& name) const { return content(folder_ / name); }
  // Expects an InputError that names the file.
  template <class Read>
  void refused(const std::string& name, const Read& read) const {
    expect_error_of<InputError>([&] { return read(folder_ / name); }, {name}, name);
  }

  std::vector<PositionMap> maps_;
};

TEST_F(MapFiles, ExrKeepsEverything) {
  write_map_set(folder_, maps_, {.closed = true, .oriented = true}, MapFormat::exr);
  const MapSet set = read_map_set(folder_);
  EXPECT_TRUE(set.closed && set.oriented);
  ASSERT_EQ(set.maps.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(set.maps[k], maps_[k]);
  EXPECT_TRUE(is_map_set(folder_) && is_map_set(folder_ / "views.json"));
  EXPECT_FALSE(is_map_set(folder_ / "view000.exr"));
}

TEST_F(MapFiles, PfmKeepsPositions) {
  write_map_set(folder_, maps_, {}, MapFormat::pfm);
  const MapSet set = read_map_set(folder_ / "views.json");
  ASSERT_EQ(set.maps.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(set.maps[k].position, maps_[k].position);
    for (std::size_t i = 0; i < maps_[k].depth.size(); ++i) {
      EXPECT_EQ(set.maps[k].sees(i), maps_[k].sees(i));
      EXPECT_NEAR(set.maps[k].depth[i], maps_[k].depth[i], 1e-6);
    }
  }
}

TEST_F(MapFiles, PfmOfTheOtherByteOrderIsRead) {
  write_pfm_map(folder_ / "a.pfm", maps_[0]);
  std::string bytes = read("a.pfm");
  const std::size_t scale = bytes.find("-1.0\n");
  ASSERT_NE(scale, std::string::npos);
  std::string swapped = bytes.substr(0, scale) + "1.0\n";
  for (std::size_t at = scale + 5; at < bytes.size(); at += 4)
    swapped += std::string(bytes.rbegin() + static_cast<std::ptrdiff_t>(bytes.size() - at - 4),
                           bytes.rbegin() + static_cast<std::ptrdiff_t>(bytes.size() - at));
  write("b.pfm", swapped);
  EXPECT_EQ(read_pfm_map(folder_ / "b.pfm", maps_[0].view, {}).position, maps_[0].position);
}

TEST_F(MapFiles, WhatIsNoMapIsRefused) {
  const auto exr = [&](const fs::path& p) { return read_exr_map(p, maps_[0].view, {}); };
  const auto pfm = [&](const fs::path& p) { return read_pfm_map(p, maps_[0].view, {}); };
  const auto list = [](const fs::path& p) { return read_map_set(p); };
  write_exr_map(folder_ / "good.exr", maps_[0]);
  write_pfm_map(folder_ / "good.pfm", maps_[0]);
  const std::string image = read("good.exr"), floats = read("good.pfm");
  write("cut.exr", image.substr(0, image.size() / 2)), refused("cut.exr", exr);
  write("text.exr", "not an image"), refused("text.exr", exr);
  write("empty.exr", ""), refused("empty.exr", exr);
  write("cut.pfm", floats.substr(0, floats.size() - 1)), refused("cut.pfm", pfm);
  write("grey.pfm", "Pf\n2 2\n-1.0\n0123456789abcdef"), refused("grey.pfm", pfm);
  write("huge.pfm", "PF\n1000000 1000000\n-1.0\n"), refused("huge.pfm", pfm);
  write("scale.pfm", "PF\n1 1\n0\n0123456789ab"), refused("scale.pfm", pfm);
  write("word.pfm", "PF\nx 1\n-1\n"), refused("word.pfm", pfm);
  write("bad.json", "{"), refused("bad.json", list);
  write("none.json", "{\"views\": []}"), refused("none.json", list);
  write("eye.json", "{\"views\": [{\"file\": \"good.exr\"}]}"), refused("eye.json", list);
  write("up.json", R"({"transform": {"origin": [0, 0, 0], "scale": 1, "up": "w"}, "views": []})"),
      refused("up.json", list);
  EXPECT_THROW((void)exr(folder_ / "missing.exr"), FileError);
  EXPECT_THROW((void)pfm(folder_ / "missing.pfm"), FileError);
  EXPECT_THROW((void)list(folder_ / "missing.json"), FileError);
  EXPECT_THROW(write_exr_map(folder_ / "no" / "such.exr", maps_[0]), FileError);
}

TEST_F(MapFiles, AWrongCameraIsRefused) {
  write_exr_map(folder_ / "good.exr", maps_[0]);
  MapView other = maps_[0].view;
  other.eye = other.eye + 5 * other.pixel * other.right;
  refused("good.exr", [&](const fs::path& p) { return read_exr_map(p, other, {}); });
}

}  // namespace
}  // namespace lodestone::test
