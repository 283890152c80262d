// Open sheets, thin plates, holes and ribbons keep their Euler number where their parts are wider than a few pixels.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "experiments/metrics/geometry/mesh_quality.h"
#include "render/reconstruct/reconstruct.h"
#include "tests/render/reconstruct/obvious_map.h"

namespace lodestone::test {
namespace {

struct Sheet {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
};

// n x n squares of (u, v) in the unit square, those that `keep` accepts; `around`: the end of u is its start.
struct SheetConfig {
  int n = 60;
  bool around = false;
  std::function<bool(int, int)> keep = [](int, int) { return true; };
};
Sheet sheet_of(const SheetConfig& config, const std::function<Vec3d(double, double)>& at) {
  Sheet sheet;
  std::map<std::pair<int, int>, std::uint32_t> number;
  const auto vertex = [&](int i, int j) {
    if (config.around) i %= config.n;
    const auto [found, fresh] = number.try_emplace({i, j}, static_cast<std::uint32_t>(sheet.positions.size()));
    if (fresh) sheet.positions.push_back(at(static_cast<double>(i) / config.n, static_cast<double>(j) / config.n));
    return found->second;
  };
  for (int j = 0; j < config.n; ++j)
    for (int i = 0; i < config.n; ++i) {
      if (!config.keep(i, j)) continue;
      const std::uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      sheet.triangles.push_back({{a, b, c}}), sheet.triangles.push_back({{a, c, d}});
    }
  return sheet;
}

// 4 x 4 holes.
bool is_beside_holes(int i, int j) { return i % 15 < 4 || i % 15 >= 11 || j % 15 < 4 || j % 15 >= 11; }

// The closed plate below a flat sheet.
Sheet plate_of(const Sheet& top, double thickness) {
  Sheet plate = top;
  const auto n = static_cast<std::uint32_t>(top.positions.size());
  for (const Vec3d& p : top.positions) plate.positions.push_back({p.x, p.y, p.z - thickness});
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : top.triangles) {
    plate.triangles.push_back({{t.v[2] + n, t.v[1] + n, t.v[0] + n}});
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t.v[k], t.v[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    const auto [a, b] = edge;
    if (edges.contains({b, a})) continue;
    plate.triangles.push_back({{b, a, a + n}}), plate.triangles.push_back({{b, a + n, b + n}});
  }
  return plate;
}

void expect_euler_kept(const Sheet& sheet, std::int64_t euler, double resolution = 48) {
  const auto serial = make_serial_scheduler();
  ASSERT_EQ(measure_quality(sheet.positions, sheet.triangles).euler, euler);
  ReconstructConfig config;
  config.resolution = resolution;
  const Reconstruction made = reconstruct(clean(sheet.positions, sheet.triangles), config, *serial);
  const MeshQuality quality = measure_quality(made.mesh.positions, made.mesh.triangles);
  EXPECT_TRUE(quality.manifold());
  EXPECT_EQ(quality.components, 1u);
  EXPECT_EQ(quality.euler, euler);
}

Vec3d flat(double u, double v) { return {u, v, 0}; }
Vec3d wave(double u, double v) { return {u, v, 0.05 * std::sin(6 * u)}; }
Vec3d ring(double u, double v) {
  const double angle = 2 * std::numbers::pi * u;
  return {0.4 * std::cos(angle), 0.4 * std::sin(angle), v};
}

TEST(OpenInput, SheetsKeepTheirHoles) {
  expect_euler_kept(sheet_of({}, wave), 1);
  expect_euler_kept(sheet_of({.keep = is_beside_holes}, wave), -15);
}

TEST(OpenInput, ThinPlatesStayClosed) {
  expect_euler_kept(plate_of(sheet_of({}, flat), 0.02), 2);
  expect_euler_kept(plate_of(sheet_of({}, flat), 0.004), 2);
  expect_euler_kept(plate_of(sheet_of({.keep = is_beside_holes}, flat), 0.02), -30);
  expect_euler_kept(plate_of(sheet_of({.keep = is_beside_holes}, flat), 0.004), -30);
}

using Shape = std::function<Vec3d(double, double)>;

// About each axis in turn, by these angles.
Shape turned(const Shape& shape, Vec3d angles) {
  return [=](double u, double v) {
    Vec3d p = shape(u, v);
    const auto turn = [](double& a, double& b, double angle) {
      const double c = std::cos(angle), s = std::sin(angle), x = a;
      a = c * x - s * b, b = s * x + c * b;
    };
    turn(p.x, p.y, angles.z), turn(p.y, p.z, angles.x), turn(p.z, p.x, angles.y);
    return p;
  };
}

constexpr double width = 0.02, full_turn = 2 * std::numbers::pi;
Vec3d narrow_band(double u, double v) { return ring(u, width * v); }
Vec3d narrow_disk(double u, double v) {
  return {(0.5 - width * v) * std::cos(full_turn * u), (0.5 - width * v) * std::sin(full_turn * u), 0};
}
Vec3d straight(double u, double v) { return {0.8 * u, 0.6 * u + width * v, 0.3 * u * u}; }
Vec3d twisted(double u, double v) {
  const double angle = 2 * full_turn * u;
  return {u, width * (v - 0.5) * std::cos(angle), width * (v - 0.5) * std::sin(angle)};
}
Vec3d upright_helix(double u, double v) {
  const double angle = 4 * full_turn * u;
  return {0.3 * std::cos(angle), 0.3 * std::sin(angle), (1 - width) * u + width * v};
}
Vec3d flat_helix(double u, double v) {
  const double angle = 4 * full_turn * u, radius = 0.3 - width * v;
  return {radius * std::cos(angle), radius * std::sin(angle), u};
}

// As narrow as one pixel and more, turning away from every view somewhere.
void expect_ribbons_kept(double resolution, Vec3d angles) {
  for (const Shape shape : {narrow_band, narrow_disk})
    expect_euler_kept(sheet_of({.n = 100, .around = true}, turned(shape, angles)), 0, resolution);
  for (const Shape shape : {straight, twisted, upright_helix, flat_helix})
    expect_euler_kept(sheet_of({.n = 100}, turned(shape, angles)), 1, resolution);
}
TEST(OpenInput, NarrowRibbonsStayInOnePiece) {
  for (const double resolution : {64, 128}) expect_ribbons_kept(resolution, {});
}
TEST(OpenInput, NarrowRibbonsStayInOnePieceTurned) {
  for (const double resolution : {64, 128, 256}) expect_ribbons_kept(resolution, {0.9, 0.3, 0.5});
}

TEST(OpenInput, RibbonsAndTubesStayOpen) {
  const auto ribbon = [](double u, double v) { return ring(u, 0.1 * v); };
  expect_euler_kept(sheet_of({.around = true}, ribbon), 0);
  expect_euler_kept(sheet_of({.around = true, .keep = is_beside_holes}, ring), -16);
}

}  // namespace
}  // namespace lodestone::test
