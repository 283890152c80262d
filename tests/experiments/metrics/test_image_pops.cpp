// Pops in the image: walls before cameras, whose depth and motion are known in closed form; rays instead of matrices as
// the slow twin.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <random>

#include "core/base/error.h"
#include "experiments/metrics/drawn/screen.h"
#include "experiments/metrics/pops/image_pops.h"
#include "render/camera/view.h"

namespace lodestone {
namespace {

constexpr ImageSize size{64, 48};
constexpr double fov = 0.8;

// A rectangle parallel to the x-y plane.
struct Wall {
  double z = 0, x0 = -HUGE_VAL, x1 = HUGE_VAL;
};

struct Eye3 {
  Vec3d position, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
};

// Through the centre of a pixel, of depth 1 per unit.
Vec3d ray(const Eye3& eye, double x, double y) {
  const double tan_half = std::tan(fov / 2), u = (2 * x / size.width - 1) * tan_half * size.width / size.height,
               v = (1 - 2 * y / size.height) * tan_half;
  return eye.forward + u * eye.right + v * eye.up;
}

// Depth along the view; infinite for the background.
double depth_at(const std::vector<Wall>& walls, const Eye3& eye, Vec3d way) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls) {
    const double t = (wall.z - eye.position.z) / way.z, x = eye.position.x + t * way.x;
    if (t > 0 && x >= wall.x0 && x <= wall.x1) nearest = std::min(nearest, t);
  }
  return nearest;
}

// The place where a point (or a direction) is seen, in pixels.
struct Seen {
  double x = 0, y = 0, w = 0;
};
Seen seen_at(const Eye3& eye, Vec3d from_eye) {
  const double w = dot(from_eye, eye.forward), tan_half = std::tan(fov / 2);
  const double u = dot(from_eye, eye.right) / w / tan_half * size.height / size.width,
               v = dot(from_eye, eye.up) / w / tan_half;
  return {(1 + u) * size.width / 2, (1 - v) * size.height / 2, w};
}

struct Shot {
  Eye3 eye;
  Image full{size, {}, {}};
  ViewProjection projection;
  ErrorMap error{size, {}};
  [[nodiscard]] ErrorFrame frame() const { return {{&error}, &full, projection}; }
};

using ErrorAt = std::function<double(int, int)>;

Shot shoot(const std::vector<Wall>& walls, const Eye3& eye, const ErrorAt& error) {
  Shot shot;
  shot.eye = eye;
  const PlacedBounds bounds{{}, {{-3, -3, -3}, {3, 3, 1}}};
  Camera camera;
  camera.position = eye.position;
  camera.target = eye.position + eye.forward;
  camera.up = eye.up;
  camera.vertical_fov = fov;
  shot.projection = View(camera, std::span(&bounds, 1), size).projection({});
  const Screen screen(shot.projection, size);
  shot.full.rgba.assign(static_cast<std::size_t>(4 * size.width * size.height), 0);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Vec3d way = ray(eye, x + 0.5, y + 0.5);
      const double t = depth_at(walls, eye, way);
      float depth = 1;
      if (std::isfinite(t)) {
        const auto clip = screen.to_clip(eye.position + t * way);
        depth = static_cast<float>(0.5 + 0.5 * clip[2] / clip[3]);
      }
      shot.full.depth.push_back(depth);
      shot.error.value.push_back(static_cast<float>(error(x, y)));
    }
  return shot;
}

// Traces rays: the point that a pixel sees, its place before, and if the pixels there saw the same.
std::vector<double> naive_pops(const std::vector<Wall>& walls, const Shot& before, const Shot& now, double tolerance) {
  std::vector<double> pops;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Vec3d way = ray(now.eye, x + 0.5, y + 0.5);
      const double t = depth_at(walls, now.eye, way);
      const bool sky = std::isinf(t);
      const Seen past = seen_at(before.eye, sky ? way : now.eye.position + t * way - before.eye.position);
      pops.push_back(no_predecessor);
      if (!(past.w > 0)) continue;
      double sum = 0, weights = 0;
      for (int py = 0; py < size.height; ++py)
        for (int px = 0; px < size.width; ++px) {
          const double weight =
              std::max(0.0, 1 - std::abs(past.x - px - 0.5)) * std::max(0.0, 1 - std::abs(past.y - py - 0.5));
          if (weight == 0) continue;
          const double d = depth_at(walls, before.eye, ray(before.eye, px + 0.5, py + 0.5));
          if (sky != std::isinf(d) || (!sky && std::abs(d - past.w) > tolerance * past.w)) continue;
          sum += weight * before.error.value[static_cast<std::size_t>(py * size.width + px)];
          weights += weight;
        }
      if (weights > 1e-3) pops.back() = now.error.value[static_cast<std::size_t>(y * size.width + x)] - sum / weights;
    }
  return pops;
}

std::vector<float> measured(const Shot& before, const Shot& now, const ImagePopConfig& config = {}) {
  return change_maps(before.frame(), now.frame(), *make_serial_scheduler(), config).front();
}

ImagePops pops_of(const Shot& before, const Shot& now, const ImagePopConfig& config = {}) {
  return summarise_pops(measured(before, now, config), size, config.threshold);
}

double wave(double x, double y) { return 0.5 + 0.3 * std::sin(0.4 * x) * std::cos(0.3 * y); }

// World size of a pixel on a wall at z = 0 from z = 2.
double pixel() { return 2 * 2 * std::tan(fov / 2) / size.height; }

TEST(ImagePops, ErrorsThatGoWithTheSurfaceAreNone) {
  const std::vector<Wall> wall{{}};
  for (const int shift : {0, 1, 5, -7}) {
    const Shot before = shoot(wall, {{0, 0, 2}}, wave);
    const Shot now = shoot(wall, {{shift * pixel(), 0, 2}}, [&](int x, int y) { return wave(x + shift, y); });
    const ImagePops pops = pops_of(before, now);
    EXPECT_LT(pops.max, 1e-4) << shift;
    EXPECT_EQ(pops.changed, 0u);
    EXPECT_EQ(pops.largest_changed, 0u);
    EXPECT_EQ(pops.without_predecessor, static_cast<std::uint64_t>(std::abs(shift) * size.height));
    EXPECT_EQ(pops.pixels + pops.without_predecessor, static_cast<std::uint64_t>(size.width * size.height));
  }
}

// The same errors, but fixed to the picture instead of the surface: each pixel changes.
TEST(ImagePops, ErrorsThatStayInThePictureAre) {
  const std::vector<Wall> wall{{}};
  const Shot before = shoot(wall, {{0, 0, 2}}, wave), now = shoot(wall, {{5 * pixel(), 0, 2}}, wave);
  const ImagePops pops = pops_of(before, now);
  EXPECT_GT(pops.p50, 0.05);
  EXPECT_GT(pops.changed_share, 0.5);
}

TEST(ImagePops, CountsWhatChanges) {
  const std::vector<Wall> wall{{}};
  const auto block = [](int x, int y) { return x >= 10 && x < 15 && y >= 20 && y < 24; };
  const auto single = [](int x, int y) { return (x == 40 && y == 4) || (x == 50 && y == 40); };
  const Shot before = shoot(wall, {{0, 0, 2}}, [](int, int) { return 0.25; });
  const Shot now = shoot(wall, {{0, 0, 2}}, [&](int x, int y) {
    return block(x, y) ? 0.75 : single(x, y) ? 0.0 : 0.25 + 0.01;  // below the threshold
  });
  const ImagePops pops = pops_of(before, now);
  EXPECT_EQ(pops.changed, 22u);
  EXPECT_EQ(pops.largest_changed, 20u);
  EXPECT_NEAR(pops.max, 0.5, 1e-5);
  EXPECT_NEAR(pops.p50, 0.01, 1e-5);
  EXPECT_NEAR(pops.p99, 0.01, 1e-5);
  EXPECT_NEAR(pops.changed_share, 22.0 / (size.width * size.height), 1e-9);
  EXPECT_NEAR(pops.mean, (20 * 0.5 + 2 * 0.25 + (size.width * size.height - 22) * 0.01) / (size.width * size.height),
              1e-5);
  EXPECT_EQ(pops_of(before, now, {.threshold = 0.3}).changed, 20u);
}

// Cameras that move, turn and come nearer, walls before walls and before the sky.
TEST(ImagePops, EqualTheirSlowTwin) {
  const std::vector<Wall> walls{{-1, -2, 0.7}, {0.3, -0.4, 0.2}};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t hidden = 0, followed = 0;
  for (int i = 0; i < 12; ++i) {
    const double turn = 0.08 * unit(random);
    const Eye3 a{{0.2 * unit(random), 0.2 * unit(random), 2.2}};
    const Eye3 b{a.position + Vec3d{0.15 * unit(random), 0.1 * unit(random), 0.2 * unit(random)},
                 {std::cos(turn), 0, std::sin(turn)},
                 {0, 1, 0},
                 {std::sin(turn), 0, -std::cos(turn)}};
    const Shot before = shoot(walls, a, wave), now = shoot(walls, b, [](int x, int y) { return wave(y, x); });
    const std::vector<float> fast = measured(before, now);
    const std::vector<double> slow = naive_pops(walls, before, now, ImagePopConfig{}.depth_tolerance);
    for (std::size_t k = 0; k < slow.size(); ++k) {
      if (slow[k] == no_predecessor)
        ASSERT_EQ(fast[k], no_predecessor) << k;
      else
        ASSERT_NEAR(fast[k], slow[k], 1e-3) << k;
      (fast[k] == no_predecessor ? hidden : followed) += 1;
    }
  }
  EXPECT_GT(hidden, 500u);
  EXPECT_GT(followed, 20000u);
}

// Noise that goes with the surface by a part of a pixel: interpolation blurs it, its range holds it. A change is seen
// by both.
TEST(ImagePops, ANeighbourhoodForgivesNoise) {
  const std::vector<Wall> wall{{}};
  std::mt19937 random(1);
  std::vector<double> noise(static_cast<std::size_t>(size.width * size.height));
  for (double& v : noise) v = 0.2 + 0.1 * static_cast<double>(random() % 1000) / 1000;
  const auto at = [&](int x, int y) {
    return noise[static_cast<std::size_t>(y * size.width + std::min(x, size.width - 1))];
  };
  const Shot before = shoot(wall, {{0, 0, 2}}, at);
  const Shot now =
      shoot(wall, {{0.5 * pixel(), 0, 2}}, [&](int x, int y) { return x == 30 && y > 10 && y < 14 ? 0.7 : at(x, y); });
  const ImagePops exact = pops_of(before, now);
  EXPECT_GT(exact.changed, 300u);
  const ImagePops near = pops_of(before, now, {.neighbourhood = 1});
  EXPECT_EQ(near.changed, 3u);
  EXPECT_EQ(near.largest_changed, 3u);
  EXPECT_EQ(near.p99, 0);
  EXPECT_NEAR(near.max, 0.4, 0.02);
  // In place a neighbourhood can only make less of a change.
  const std::vector<float> a = measured(before, now), b = measured(before, now, {.neighbourhood = 1}),
                           c = measured(before, now, {.neighbourhood = 2});
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(b[i] == no_predecessor, c[i] == no_predecessor);
    EXPECT_LE(std::abs(c[i]), std::abs(b[i]));
  }
}

// The part that the near wall hid before is not compared with the near wall.
TEST(ImagePops, WhatWasHiddenHasNoPredecessor) {
  const std::vector<Wall> walls{{-1, -9, 9}, {0.3, -0.4, 0.0}};
  const Eye3 a{{0, 0, 2}}, b{{0.2, 0, 2}};
  const auto error_of = [&](const Eye3& eye) {
    return [&walls, eye](int x, int y) { return depth_at(walls, eye, ray(eye, x + 0.5, y + 0.5)) < 2 ? 0.9 : 0.1; };
  };
  const Shot before = shoot(walls, a, error_of(a)), now = shoot(walls, b, error_of(b));
  const ImagePops pops = pops_of(before, now);
  EXPECT_LT(pops.max, 1e-5);
  EXPECT_GT(pops.without_predecessor, 48u);
}

TEST(ImagePops, TheSkyTurnsWithTheCamera) {
  const double turn = 0.1;
  const Eye3 a{{0, 0, 2}},
      b{{0.7, 0, 2}, {std::cos(turn), 0, std::sin(turn)}, {0, 1, 0}, {std::sin(turn), 0, -std::cos(turn)}};
  // A function of the direction alone.
  const auto sky = [](const Eye3& eye) {
    return [eye](int x, int y) {
      const Vec3d way = ray(eye, x + 0.5, y + 0.5);
      return 0.5 + 0.3 * way.x / length(way) + 0.1 * way.y / length(way);
    };
  };
  const Shot before = shoot({}, a, sky(a)), now = shoot({}, b, sky(b));
  const ImagePops pops = pops_of(before, now);
  EXPECT_LT(pops.p50, 1e-4);
  EXPECT_LT(pops.max, 0.003);  // half a pixel's worth, where neighbours are outside of the picture; unturned: 0.03
  EXPECT_GT(pops.without_predecessor, 48u);
  EXPECT_LT(pops.without_predecessor, 48u * 12);
}

// Flood fill, pixel by pixel.
std::uint64_t naive_area(const std::vector<float>& values, ImageSize of, double threshold) {
  std::vector<char> seen(values.size(), 0);
  std::uint64_t largest = 0;
  for (std::size_t start = 0; start < values.size(); ++start) {
    std::vector<std::size_t> open{start};
    std::uint64_t area = 0;
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      if (seen[i] || !(values[i] > threshold)) continue;
      seen[i] = 1;
      ++area;
      const int x = static_cast<int>(i) % of.width, y = static_cast<int>(i) / of.width;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (x + dx >= 0 && x + dx < of.width && y + dy >= 0 && y + dy < of.height)
            open.push_back(static_cast<std::size_t>((y + dy) * of.width + x + dx));
    }
    largest = std::max(largest, area);
  }
  return largest;
}

TEST(ImagePops, LargestAreaEqualsAFloodFill) {
  std::mt19937 random(1);
  for (const int percent : {0, 10, 30, 38, 45, 60, 100})
    for (const ImageSize of : {ImageSize{50, 40}, ImageSize{1, 30}, ImageSize{30, 1}}) {
      std::vector<float> values;
      for (int i = 0; i < of.width * of.height; ++i)
        values.push_back(static_cast<int>(random() % 100) < percent ? 0.8f : 0.1f);
      EXPECT_EQ(largest_connected_area(values, of, 0.5), naive_area(values, of, 0.5)) << percent;
    }
}

TEST(ImagePops, AreTheSameForAnyNumberOfWorkers) {
  const std::vector<Wall> walls{{-1, -2, 0.7}, {0.3, -0.4, 0.2}};
  const Shot before = shoot(walls, {{0, 0, 2}}, wave), now = shoot(walls, {{0.13, 0.05, 1.9}}, wave);
  const std::vector<float> serial = measured(before, now);
  for (const int threads : {2, 5})
    EXPECT_EQ(change_maps(before.frame(), now.frame(), *make_tbb_scheduler(threads)).front(), serial);
}

TEST(ImagePops, OfSeveralErrorsAreThoseOfEach) {
  const std::vector<Wall> walls{{-1, -2, 0.7}, {0.3, -0.4, 0.2}};
  const Shot before = shoot(walls, {{0, 0, 2}}, wave), now = shoot(walls, {{0.13, 0.05, 1.9}}, wave);
  Shot others_before = before, others_now = now;
  for (Shot* shot : {&others_before, &others_now})
    for (float& e : shot->error.value) e = 0.3f * (1 - e) * e;
  ErrorFrame both_before = before.frame(), both_now = now.frame();
  both_before.errors.push_back(&others_before.error), both_now.errors.push_back(&others_now.error);
  for (const int neighbourhood : {0, 2}) {
    const ImagePopConfig config{.neighbourhood = neighbourhood};
    const auto both = change_maps(both_before, both_now, *make_serial_scheduler(), config);
    ASSERT_EQ(both.size(), 2u);
    EXPECT_EQ(both[0], measured(before, now, config));
    EXPECT_EQ(both[1], measured(others_before, others_now, config));
  }
  both_now.errors.pop_back();
  EXPECT_THROW((void)change_maps(both_before, both_now, *make_serial_scheduler()), InputError);
  both_before.errors.clear(), both_now.errors.clear();
  EXPECT_THROW((void)change_maps(both_before, both_now, *make_serial_scheduler()), InputError);
}

TEST(ImagePops, RefuseWhatTheyCannotCompare) {
  const std::vector<Wall> wall{{}};
  const Shot good = shoot(wall, {{0, 0, 2}}, wave);
  const auto refused = [&](const Shot& before, const Shot& now, const ImagePopConfig& config = {}) {
    EXPECT_THROW((void)pops_of(before, now, config), InputError);
  };
  Shot flat = good, small = good, singular = good;
  flat.full.depth.clear();
  small.error = {{8, 8}, std::vector<float>(64)};
  singular.projection.m.fill(0);
  refused(flat, good);
  refused(good, flat);
  refused(small, good);
  refused(good, small);
  refused(singular, good);
  refused(good, singular);
  for (const double tolerance : {0.0, 1.0, -1.0, std::nan("")}) refused(good, good, {.depth_tolerance = tolerance});
  refused(good, good, {.threshold = -1});
  for (const int reach : {-1, 9}) refused(good, good, {.neighbourhood = reach});
}

}  // namespace
}  // namespace lodestone
