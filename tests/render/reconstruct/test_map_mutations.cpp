// Damaged files of position maps: the result is a map that can be reconstructed, or an InputError; nothing else. The
// same mutations at every run; tests/fuzz looks for others.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "core/base/error.h"
#include "render/position_map/map_files.h"
#include "render/position_map/read_map.h"
#include "render/reconstruct/from_maps.h"
#include "tests/render/reconstruct/obvious_map.h"
#include "tests/test_folder.h"

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

class MapMutations : public FolderTest {
 protected:
  void SetUp() override {
    IndexedMesh mesh = sphere_mesh(2);
    for (const Vec3f& p : mesh.positions) {
      mesh.wedges.uv.push_back({p.x, p.y});
      mesh.wedges.colour.push_back({200, 2, 3, 255});
    }
    const auto serial = make_serial_scheduler();
    view_ = orthographic_view(box_of(mesh), {0.1, -0.4, 0.7}, 1.0 / 16);
    map_ = rasterize_map(mesh, view_, {.uv = true, .colour = true}, *serial);
  }

  [[nodiscard]] std::string bytes_of(const std::string& name) const { return content(folder_ / name); }

  // Some bytes changed, taken out, repeated, or the end cut off.
  static std::string mutated(std::string bytes, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % std::max<std::size_t>(n, 1); };
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
      const std::size_t at = below(2) == 0 ? below(std::min<std::size_t>(bytes.size(), 400)) : below(bytes.size());
      switch (below(6)) {
        case 0:
          bytes.resize(at);
          break;
        case 1:
          bytes.erase(at, 1 + below(8));
          break;
        case 2:
          bytes.insert(at, bytes.substr(at, 1 + below(16)));
          break;
        case 3:
          bytes.replace(at, std::min<std::size_t>(4, bytes.size() - at), "\xff\xff\xff\x7f", 4);
          break;
        default:
          if (!bytes.empty()) bytes[at] = static_cast<char>(random());
      }
    }
    return bytes;
  }

  // Sound, and good for reconstruction.
  static void expect_usable(const PositionMap& map) {
    const std::size_t n = map.view.pixels();
    ASSERT_EQ(map.position.size(), n);
    ASSERT_EQ(map.triangle.size(), n);
    ASSERT_EQ(map.depth.size(), n);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_TRUE(is_finite(map.position[i]));
      ASSERT_TRUE(std::isfinite(map.depth[i]));
      ASSERT_TRUE(map.normal.empty() || is_finite(map.normal[i]));
    }
    if (n > 10'000) return;
    MapSet set;
    set.maps.push_back(map);
    const auto serial = make_serial_scheduler();
    ReconstructReport report;
    DrawnMaps drawn = drawn_maps(std::move(set), report);
    const RawMesh mesh = mesh_from_maps(drawn, nullptr, {}, report, *serial);
    for (const Triangle& t : mesh.triangles)
      for (const std::uint32_t v : t.v) ASSERT_LT(v, mesh.positions.size());
  }

  template <class Parse>
  void mutate(const std::string& bytes, int rounds, const Parse& parse) {
    std::mt19937 random(20);
    int read = 0;
    for (int round = 0; round < rounds; ++round) {
      const std::string damaged = mutated(bytes, random);
      try {
        expect_usable(parse(std::as_bytes(std::span(damaged))));
        ++read;
      } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("damaged"), std::string::npos) << error.what();
      }
      if (HasFatalFailure()) FAIL() << "round " << round;
    }
    EXPECT_GT(read, rounds / 100);  // not all are refused at the door
    EXPECT_LT(read, rounds);
  }

  MapView view_;
  PositionMap map_;
};

TEST_F(MapMutations, OfOpenExr) {
  write_exr_map(folder_ / "map.exr", map_);
  const std::string bytes = bytes_of("map.exr");
  EXPECT_EQ(parse_exr_map(std::as_bytes(std::span(bytes)), "whole", view_, map_.transform).triangle, map_.triangle);
  mutate(bytes, 1500, [&](auto damaged) { return parse_exr_map(damaged, "damaged", view_, map_.transform); });
}

TEST_F(MapMutations, OfPortableFloatMaps) {
  write_pfm_map(folder_ / "map.pfm", map_);
  const std::string bytes = bytes_of("map.pfm");
  EXPECT_EQ(parse_pfm_map(std::as_bytes(std::span(bytes)), "whole", view_, map_.transform).position, map_.position);
  mutate(bytes, 1500, [&](auto damaged) { return parse_pfm_map(damaged, "damaged", view_, map_.transform); });
}

TEST_F(MapMutations, OfTheListOfViews) {
  write_map_set(folder_, std::vector<PositionMap>{map_}, {.closed = true, .oriented = true}, MapFormat::pfm);
  const std::string bytes = bytes_of("views.json");
  std::mt19937 random(21);
  int read = 0;
  for (int round = 0; round < 1000; ++round) {
    test_folder_.write("views.json", mutated(bytes, random));
    try {
      for (const PositionMap& map : read_map_set(folder_).maps) expect_usable(map);
      ++read;
    } catch (const Error&) {  // a name that is changed names a file that is not there
    }
    if (HasFatalFailure()) FAIL() << "round " << round;
  }
  EXPECT_GT(read, 10);
}

// A header may not make room for what the file cannot hold.
TEST_F(MapMutations, AHugeImageInASmallFileIsRefused) {
  MapView large = view_;
  large.width = large.height = 512;
  PositionMap map;
  map.view = large;
  map.position.resize(large.pixels()), map.depth.resize(large.pixels());
  map.triangle.assign(large.pixels(), no_triangle);
  write_exr_map(folder_ / "map.exr", map);
  std::string bytes = bytes_of("map.exr");
  EXPECT_FALSE(parse_exr_map(std::as_bytes(std::span(bytes)), "whole", large, map.transform).sees(0));
  bytes.resize(500);
  EXPECT_THROW((void)parse_exr_map(std::as_bytes(std::span(bytes)), "damaged", large, map.transform), InputError);
}

}  // namespace
}  // namespace lodestone::test
