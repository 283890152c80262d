// Cameras as matrices and planes, and camera paths.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <random>

#include "core/base/error.h"
#include "core/hierarchy/model/distance_metric.h"
#include "render/camera/camera.h"
#include "tests/expect_error.h"
#include "tests/render/moved_torus.h"

namespace lodestone {
namespace {

using test::moved_torus;
using test::torus;

struct Clip {
  double x, y, z, w;
};

Clip project(const ViewProjection& vp, Vec3f p) {
  const auto row = [&](std::size_t r) {
    return double{vp.m[4 * r]} * p.x + double{vp.m[4 * r + 1]} * p.y + double{vp.m[4 * r + 2]} * p.z + vp.m[4 * r + 3];
  };
  return {row(0), row(1), row(2), row(3)};
}

std::string temporary(const std::string& name) { return ::testing::TempDir() + "lodestone_camera_" + name; }

std::string written(const std::string& name, const std::string& text) {
  const std::string file = temporary(name);
  std::ofstream(file) << text;
  return file;
}

TEST(Camera, TargetIsInTheMiddleAndUpIsUp) {
  const Hierarchy h = moved_torus();
  Camera camera{h.transform.to_model({0.3f, -1.0f, 0.8f}), h.transform.to_model({0.5f, 0.5f, 0.1f})};
  const ViewProjection vp = view_projection(camera, h, {640, 360});
  const Clip middle = project(vp, {0.5f, 0.5f, 0.1f});
  EXPECT_NEAR(middle.x / middle.w, 0, 1e-4);
  EXPECT_NEAR(middle.y / middle.w, 0, 1e-4);
  const Clip above = project(vp, {0.5f, 0.5f, 0.2f}), right = project(vp, {0.6f, 0.5f, 0.1f});
  EXPECT_GT(above.y / above.w, 0.01);
  EXPECT_NEAR(above.x / above.w, 0, 1e-4);
  EXPECT_GT(right.x / right.w, 0.01);
}

TEST(Camera, FieldOfViewAndAspect) {
  const Hierarchy& h = torus();
  Camera camera{h.transform.to_model({0.5f, -1.5f, 0.1f}), h.transform.to_model({0.5f, 0.5f, 0.1f})};
  camera.vertical_fov = std::numbers::pi / 2;
  const ViewProjection vp = view_projection(camera, h, {200, 100});
  const Clip edge = project(vp, {0.5f, 0.0f, 0.1f + 1.5f});  // 1.5 away and 1.5 up: 45 degrees
  EXPECT_NEAR(edge.y / edge.w, 1, 1e-5);
  const Clip side = project(vp, {0.5f + 3.0f, 0.0f, 0.1f});
  EXPECT_NEAR(side.x / side.w, 1, 1e-5);
}

TEST(Camera, NothingOfTheBoundsIsCutByFarNorInViewByNear) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> along(-3, 4), in(0, 1);
  const Hierarchy& h = torus();
  const Box3f box = h.cells[0].bounds;
  for (int i = 0; i < 500; ++i) {
    Camera camera{h.transform.to_model({along(random), along(random), along(random)}),
                  h.transform.to_model({in(random), in(random), in(random)})};
    camera.vertical_fov = std::uniform_real_distribution<double>(0.1, 2.5)(random);
    const ViewProjection vp = view_projection(camera, h, {300, 200});
    const bool outside = distance(DistanceMetric::euclidean, viewpoint(camera, h.transform), box) > 1e-3f;
    for (int k = 0; k < 20; ++k) {
      const auto within = [&](float lo, float hi) { return std::clamp(lo + in(random) * (hi - lo), lo, hi); };
      const Vec3f p = k < 8
                          ? Vec3f{k & 1 ? box.lo.x : box.hi.x, k & 2 ? box.lo.y : box.hi.y, k & 4 ? box.lo.z : box.hi.z}
                          : Vec3f{within(box.lo.x, box.hi.x), within(box.lo.y, box.hi.y), within(box.lo.z, box.hi.z)};
      const Clip c = project(vp, p);
      EXPECT_LT(c.z, c.w);
      const bool in_view = c.w > 0 && std::abs(c.x) <= c.w && std::abs(c.y) <= c.w;
      EXPECT_TRUE(!in_view || !outside || c.z > -c.w) << i;
    }
  }
}

TEST(Camera, FrustumAgreesWithTheClipCoordinates) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> along(-1, 2);
  const Hierarchy& h = torus();
  int inside = 0;
  for (int i = 0; i < 200; ++i) {
    const Camera camera{h.transform.to_model({along(random), along(random), along(random)}),
                        h.transform.to_model({0.5f, 0.5f, 0.1f})};
    const ViewProjection vp = view_projection(camera, h, {320, 200});
    const Frustum frustum = frustum_of(vp);
    for (int k = 0; k < 50; ++k) {
      const Vec3f p{along(random), along(random), along(random)};
      const Clip c = project(vp, p);
      const std::array<double, 6> depth{c.w + c.x, c.w - c.x, c.w + c.y, c.w - c.y, c.w + c.z, c.w - c.z};
      const bool in_clip = std::ranges::all_of(depth, [](double d) { return d >= 0; });
      const bool in_planes =
          std::ranges::all_of(frustum, [&](const Plane& plane) { return dot(plane.n, p) + plane.d >= 0; });
      inside += in_clip;
      EXPECT_TRUE(!in_clip || in_planes) << "culling must be conservative";
      const bool far_out = std::ranges::any_of(depth, [](double d) { return d < -1e-3; });
      EXPECT_FALSE(far_out && in_planes);
    }
  }
  EXPECT_GT(inside, 300);
}

TEST(Camera, DepthOfAPlaneIsThatOfItsPoints) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> along(-1, 1);
  const Hierarchy& h = torus();
  constexpr ImageSize size{320, 200};
  int seen = 0;
  for (int i = 0; i < 200; ++i) {
    const Camera camera{h.transform.to_model({2 * along(random), 2 * along(random), 1.5f}),
                        h.transform.to_model({0.5f, 0.5f, 0.1f})};
    const ViewProjection vp = view_projection(camera, h, size);
    const Vec3f n{along(random), along(random), along(random)}, in{0.5f + 0.3f * along(random), 0.5f, 0.2f};
    const auto depth = depth_of_plane(vp, {n, -dot(n, in)}, size);
    ASSERT_TRUE(depth);
    for (int k = 0; k < 20; ++k) {
      const Vec3f p = in + 0.3f * cross(n, {along(random), along(random), along(random)});
      const Clip c = project(vp, p);
      if (!(c.w > 0) || std::abs(c.x) > c.w || std::abs(c.y) > c.w) continue;
      ++seen;
      const double x = (c.x / c.w + 1) / 2 * size.width, y = (1 - c.y / c.w) / 2 * size.height;
      EXPECT_NEAR((*depth)[0] * x + (*depth)[1] * y + (*depth)[2], 0.5 + 0.5 * c.z / c.w, 1e-5);
    }
    EXPECT_FALSE(depth_of_plane(vp, {{0, 0, 0}, 1}, size)) << "no plane";
  }
  EXPECT_GT(seen, 1000);
}

TEST(Camera, UpAlongTheViewIsReplaced) {
  const Hierarchy& h = torus();
  for (const Vec3d up : {Vec3d{0, 0, 1}, Vec3d{0, 0, -7}, Vec3d{0, 0, 0}, Vec3d{1e-14, 0, 1}}) {
    const Camera camera{h.transform.to_model({0.5f, 0.5f, 3}), h.transform.to_model({0.5f, 0.5f, 0}), up};
    for (const float m : view_projection(camera, h, {64, 64}).m) EXPECT_TRUE(std::isfinite(m));
  }
}

TEST(Camera, DegenerateOnesAreRefused) {
  const Hierarchy& h = torus();
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const Camera good{{3, 3, 3}, {0, 0, 0}};
  EXPECT_NO_THROW((void)view_projection(good, h, {64, 64}));
  const auto refused = [&](auto change) {
    Camera camera = good;
    change(camera);
    EXPECT_THROW((void)view_projection(camera, h, {64, 64}), InputError);
  };
  refused([](Camera& c) { c.target = c.position; });
  for (const double bad : {nan, infinity}) {
    refused([&](Camera& c) { c.position.y = bad; });
    refused([&](Camera& c) { c.target.x = bad; });
    refused([&](Camera& c) { c.up.z = bad; });
  }
  for (const double bad : {0.0, -1.0, 3.1416, nan}) refused([&](Camera& c) { c.vertical_fov = bad; });
  refused([](Camera& c) { c.position.x = 1e300; });
  EXPECT_THROW((void)viewpoint({{1e300, 0, 0}, {0, 0, 0}}, h.transform), InputError);
  EXPECT_THROW((void)viewpoint({{nan, 0, 0}, {0, 0, 0}}, h.transform), InputError);
  EXPECT_THROW((void)view_projection(good, h, {0, 64}), InputError);
}

TEST(CameraPath, RoundTrip) {
  const std::vector<Camera> path = fly_in_path(moved_torus(), 7);
  const std::string file = temporary("round.json");
  write_camera_path(file, path);
  const std::vector<Camera> again = read_camera_path(file, 7);
  ASSERT_EQ(again.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(again[i].position, path[i].position);
    EXPECT_EQ(again[i].target, path[i].target);
    EXPECT_EQ(again[i].up, path[i].up);
    EXPECT_NEAR(again[i].vertical_fov, path[i].vertical_fov, 1e-15);
  }
}

TEST(CameraPath, KeysAreResampledAtEqualSteps) {
  const std::string file = written("keys.json", R"({"frames": [
    {"position": [0, 0, 0], "target": [0, 0, 9]},
    {"position": [2, 0, 0], "target": [0, 0, 9], "up": [1, 0, 0], "fov_degrees": 60},
    {"position": [2, 8, 0], "target": [0, 0, 9], "up": [1, 0, 0], "fov_degrees": 90}]})");
  const std::vector<Camera> path = read_camera_path(file, 5), keys = read_camera_keys(file);
  ASSERT_EQ(path.size(), 5u);
  EXPECT_EQ(path[0].position, (Vec3d{0, 0, 0}));
  EXPECT_EQ(path[1].position, camera_at(keys, 0.5).position);
  EXPECT_EQ(path[2].position, (Vec3d{2, 0, 0}));
  EXPECT_EQ(path[3].position, camera_at(keys, 1.5).position);
  EXPECT_EQ(path[4].position, (Vec3d{2, 8, 0}));
  EXPECT_EQ(path[0].up, (Vec3d{0, 0, 1}));
  EXPECT_EQ(path[0].vertical_fov, Camera{}.vertical_fov);
  EXPECT_NEAR(path[3].vertical_fov, 75 * std::numbers::pi / 180, 0.05);
  EXPECT_NEAR(path[4].vertical_fov, 90 * std::numbers::pi / 180, 1e-12);
  EXPECT_EQ(read_camera_path(file, 1)[0], path[0]);
}

std::vector<Camera> keys_at(const std::vector<Vec3d>& positions) {
  std::vector<Camera> keys;
  for (const Vec3d p : positions) keys.push_back({p, {0, 0, 9}});
  return keys;
}

TEST(CameraPath, IsSmoothThroughItsKeys) {
  const std::vector<Camera> keys = keys_at({{0, 0, 0}, {2, 0, 0}, {3, 4, 0}, {-1, 5, 2}, {-1, 0, 1}});
  constexpr double step = 1e-5;
  for (std::size_t k = 1; k + 1 < keys.size(); ++k) {
    const auto at = [&](double t) { return camera_at(keys, static_cast<double>(k) + t).position; };
    EXPECT_EQ(at(0), keys[k].position);
    const Vec3d before = (1 / step) * (at(0) - at(-step)), after = (1 / step) * (at(step) - at(0));
    EXPECT_LT(length(after - before), 1e-3) << k;  // between straight lines it is 2 and more
    EXPECT_GT(length(after), 0.5) << k;
  }
}

TEST(CameraPath, NeverGoesBeyondKeysWhereItTurnsBackOrStands) {
  const std::vector<Camera> there_and_back = keys_at({{0, 0, 0}, {5, 0, 0}, {4, 0, 0}, {9, 0, 0}});
  const std::vector<Camera> standing = keys_at({{0, 0, 0}, {5, 0, 0}, {5, 0, 0}, {5, 0, 0}, {9, 3, 0}});
  for (int i = 0; i <= 300; ++i) {
    const double place = i / 100.0, x = camera_at(there_and_back, place).position.x;
    const auto k = std::min<std::size_t>(static_cast<std::size_t>(place), 2);
    const auto [low, high] = std::minmax(there_and_back[k].position.x, there_and_back[k + 1].position.x);
    EXPECT_TRUE(x >= low - 1e-12 && x <= high + 1e-12) << place;
    // The same bits: a renderer draws nothing again.
    if (place >= 1) {
      EXPECT_EQ(camera_at(standing, place), standing[1]) << place;
    }
  }
}

TEST(CameraPath, KeysWithoutAnUpHaveThatOfTheModel) {
  const std::string file = written("up.json", R"({"frames": [
    {"position": [0, 0, 5], "target": [0, 0, 0]}, {"position": [0, 0, 5], "target": [0, 0, 0], "up": [1, 0, 0]}]})");
  const std::vector<Camera> keys = read_camera_keys(file, {0, 1, 0});
  EXPECT_EQ(keys[0].up, (Vec3d{0, 1, 0}));
  EXPECT_EQ(keys[1].up, (Vec3d{1, 0, 0}));
}

TEST(CameraPath, BadFilesAreRefusedWithTheirPlace) {
  const auto refused = [](const std::string& name, const std::string& text, const std::string& place) {
    const std::string file = written(name, text);
    expect_error_of<InputError>([&] { return read_camera_path(file, 3); }, {file, place}, name);
  };
  EXPECT_THROW((void)read_camera_path(temporary("missing.json"), 3), FileError);
  refused("empty.json", "", "byte");
  refused("cut.json", R"({"frames": [{"position": [0, 0)", "byte");
  refused("list.json", "[1, 2]", "frames");
  refused("none.json", R"({"frames": []})", "empty");
  refused("number.json", R"({"frames": [3]})", "frame 0");
  refused("target.json", R"({"frames": [{"position": [0, 0, 0]}]})", "target");
  refused("two.json", R"({"frames": [{"position": [0, 0], "target": [1, 1, 1]}]})", "frame 0, position");
  refused("text.json", R"({"frames": [{"position": [0, 0, "x"], "target": [1, 1, 1]}]})", "frame 0, position");
  refused("same.json", R"({"frames": [{"position": [1, 1, 1], "target": [1, 1, 1]}]})", "frame 0");
  refused("fov.json", R"({"frames": [{"position": [0, 0, 0], "target": [1, 1, 1], "fov_degrees": 180}]})", "frame 0");
  refused("huge.json", R"({"frames": [{"position": [0, 0, 1e999], "target": [1, 1, 1]}]})", "");
  refused("far.json", R"({"frames": [{"position": [0, 0, -1e300], "target": [1, 1, 1]}]})",
          "frame 0, position: has a coordinate beyond 1e100");
  refused("key.json", R"({"frames": [{"position": [0, 0, 0], "target": [1, 1, 1], "fov": 30}]})",
          "frame 0: unknown key \"fov\"; known are position, target, up, fov_degrees; did you mean fov_degrees?");
  refused("misspelt.json", R"({"frames": [{"positon": [0, 0, 0], "target": [1, 1, 1]}]})", "did you mean position?");
  refused("top.json", R"({"frames": [{"position": [0, 0, 0], "target": [1, 1, 1]}], "frame_rate": 30})",
          "unknown key \"frame_rate\"");
  refused("through.json", R"({"frames": [{"position": [0, 0, 0], "target": [1, 0, 0]},
                                         {"position": [2, 0, 0], "target": [1, 0, 0]}]})",
          "between frames 0 and 1");
  const std::string good = written("good.json", R"({"frames": [{"position": [0, 0, 0], "target": [1, 1, 1]}]})");
  for (const int frames : {0, -1}) EXPECT_THROW((void)read_camera_path(good, frames), InputError);
}

TEST(CameraPath, UnwritableTargetIsAFileError) {
  EXPECT_THROW(write_camera_path("/nonexistent/path.json", {}), FileError);
}

}  // namespace
}  // namespace lodestone
